// SPDX-License-Identifier: BSD-3-Clause
// The ranks of a run, and the few collective operations that an exploration needs.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "schedule/network.h"

namespace palpate {

class Communicator {
 public:
  virtual ~Communicator() = default;
  Communicator(const Communicator&) = delete;
  Communicator& operator=(const Communicator&) = delete;

  [[nodiscard]] virtual int rank() const = 0;
  [[nodiscard]] virtual int size() const = 0;

  /// Gives every rank what each rank gave, by rank.
  /// @note Collective
  /// @throws BackendError more than 16 GiB in all.
  [[nodiscard]] virtual std::vector<Bytes> all_gather(const Bytes& mine) = 0;

  /// Gives it to rank 0, and nothing to the others.
  /// @note Collective
  /// @throws BackendError more than 16 GiB in all.
  [[nodiscard]] virtual std::vector<Bytes> gather(const Bytes& mine) = 0;

  /// Gives each rank what every rank had for it.
  /// @param to What this rank has for each rank [size()].
  /// @returns What each rank had for this one, by rank.
  /// @note Collective
  /// @throws BackendError more than 16 GiB from or to one rank.
  [[nodiscard]] virtual std::vector<Bytes> exchange(const std::vector<Bytes>& to) = 0;

  /// The ranks that give the same colour, in their order here.
  /// @note Collective, and so is the end of the object among its ranks.
  [[nodiscard]] virtual std::unique_ptr<Communicator> split(int colour) = 0;

  /// Address of the MPI_Comm; null: there is none.
  [[nodiscard]] virtual const void* mpi_comm() const { return nullptr; }

  /// For messages that are not collective: run() of scheduler.h.
  [[nodiscard]] virtual Network& network() = 0;

 protected:
  Communicator() = default;
};

/// One rank.
[[nodiscard]] std::unique_ptr<Communicator> make_serial_communicator();

/// True on every rank when it is true on one.
/// @note Collective
[[nodiscard]] bool any(Communicator& communicator, bool mine);

/// Runs `body` on every rank, and when it throws on one or more, throws the error of the lowest of
/// them, InputError or BackendError, on every rank: so that no rank waits for one that gave up.
/// @note Collective
void agree(Communicator& communicator, const std::function<void()>& body);

}  // namespace palpate
