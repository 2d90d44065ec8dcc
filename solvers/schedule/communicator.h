// SPDX-License-Identifier: BSD-3-Clause
// The ranks of a run, and the few collective operations that an exploration needs.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "base/memory_error.h"
#include "schedule/network.h"

namespace palpate {

/// The error of a rank. It has a fixed size, so that it can be sent when no memory is left.
struct Failure {
  enum class Kind : char { none, input, backend, memory };

  Kind kind = Kind::none;
  /// Longer messages are cut.
  char text[2000] = {};
};

class Communicator {
 public:
  virtual ~Communicator() = default;
  Communicator(const Communicator&) = delete;
  Communicator& operator=(const Communicator&) = delete;

  [[nodiscard]] virtual int rank() const = 0;
  [[nodiscard]] virtual int size() const = 0;

  /// Gathers a message of each rank on all ranks, ordered by rank.
  /// @note Collective
  /// @throws BackendError more than 16 GiB in all.
  [[nodiscard]] virtual std::vector<Bytes> all_gather(const Bytes& mine) = 0;

  /// Gathers a message of each rank on rank 0, ordered by rank; the other ranks get nothing.
  /// @note Collective
  /// @throws BackendError more than 16 GiB in all.
  [[nodiscard]] virtual std::vector<Bytes> gather(const Bytes& mine) = 0;

  /// Sends a message from each rank to each rank.
  /// @param to The message of this rank for each rank [size()].
  /// @returns The message of each rank for this one, ordered by rank.
  /// @note Collective
  /// @throws BackendError more than 16 GiB from or to one rank.
  [[nodiscard]] virtual std::vector<Bytes> exchange(const std::vector<Bytes>& to) = 0;

  /// The ranks that give the same colour, in the order that they have here.
  /// @note Collective. The destructor of the result is collective among its ranks.
  [[nodiscard]] virtual std::unique_ptr<Communicator> split(int colour) = 0;

  /// Gives every rank the failure of the lowest rank that has one; if none has, nothing changes. It
  /// allocates no memory. Call agree() instead.
  /// @note Collective. It may meet an all_gather(), gather(), exchange() or split() of other ranks,
  ///   which then throw the failure.
  virtual void share(Failure& failure) = 0;
  /// The number of failures that were shared; the same on every rank.
  [[nodiscard]] virtual int num_shared_failures() const = 0;

  /// Address of the MPI_Comm; null: there is no MPI.
  [[nodiscard]] virtual const void* mpi_comm() const { return nullptr; }

  /// The number of cores that this rank may use while all ranks on its machine compute, at least 1.
  /// Ranks that are bound to cores of their own may use all of these.
  /// @note Collective
  [[nodiscard]] virtual int num_cores();

  /// The network for messages that are not collective, see run() of scheduler.h.
  [[nodiscard]] virtual Network& network() = 0;

 protected:
  Communicator() = default;
};

/// The communicator of a single rank.
[[nodiscard]] std::unique_ptr<Communicator> make_serial_communicator();

/// The number of threads of a rank: the number that is asked for, the same on every rank, or for 0
/// the number for which there are cores (threads/thread_team.h).
/// @note Collective
[[nodiscard]] int num_threads(Communicator& communicator, int asked);

/// Whether the argument is true on any rank.
/// @note Collective
[[nodiscard]] bool any(Communicator& communicator, bool mine);

/// Runs `body` on every rank. If it throws on one or more, the error of the lowest of them is
/// thrown on every rank, as InputError, MemoryError or BackendError, so that no rank waits for one
/// that gave up. The body may contain collective operations, agree() and run() among them: if a
/// rank throws before it reaches an operation that others have reached, the operation throws on
/// these. So the body must not catch what collective operations throw, and it must use this
/// communicator for them.
/// @note Collective
void agree(Communicator& communicator, const std::function<void()>& body);

}  // namespace palpate
