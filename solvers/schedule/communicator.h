// SPDX-License-Identifier: BSD-3-Clause
// The ranks of a run, and the few collective operations that an exploration needs.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "base/memory_error.h"
#include "schedule/network.h"

namespace palpate {

/// What a rank has failed with. It has a fixed size, so that it can be told where there is no
/// memory left.
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

  /// Gives every rank the failure of the lowest rank that has one; where none has, leaves all as
  /// they are. Allocates nothing. See agree(), which is what to call.
  /// @note Collective. It may meet an all_gather(), gather(), exchange() or split() of the others,
  /// which then throw the failure.
  virtual void share(Failure& failure) = 0;
  /// How many failures have been shared. The same on every rank.
  [[nodiscard]] virtual int num_shared_failures() const = 0;

  /// Address of the MPI_Comm; null: there is none.
  [[nodiscard]] virtual const void* mpi_comm() const { return nullptr; }

  /// How many cores fall to this rank where all ranks on its machine compute, at least 1: threads
  /// for as many are not too many. Ranks that are bound to cores of their own have all of these.
  /// @note Collective
  [[nodiscard]] virtual int num_cores();

  /// For messages that are not collective: run() of scheduler.h.
  [[nodiscard]] virtual Network& network() = 0;

 protected:
  Communicator() = default;
};

/// One rank.
[[nodiscard]] std::unique_ptr<Communicator> make_serial_communicator();

/// The threads of a rank: as many as are asked for, the same on every rank, or for 0 those for
/// which there are cores (threads/thread_team.h).
/// @note Collective
[[nodiscard]] int num_threads(Communicator& communicator, int asked);

/// True on every rank when it is true on one.
/// @note Collective
[[nodiscard]] bool any(Communicator& communicator, bool mine);

/// Runs `body` on every rank, and when it throws on one or more, throws the error of the lowest of
/// them, InputError, MemoryError or BackendError, on every rank: so that no rank waits for one that
/// gave up. The body may have collective operations in it, agree() and run() among them: where a
/// rank throws before it comes to one that others have come to, these throw there. (So it must not
/// catch what they throw.) That needs the same communicator inside and outside.
/// @note Collective
void agree(Communicator& communicator, const std::function<void()>& body);

}  // namespace palpate
