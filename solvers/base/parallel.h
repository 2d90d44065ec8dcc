// SPDX-License-Identifier: BSD-3-Clause
// Loops over the parts of a body, several of which may run in parallel.
//
// The result of a loop is the same to the bit for any number of threads: the parts depend on the
// size of the body alone, no part writes what another one reads or writes, and the results of the
// parts are summed in their order. A small body is one part, and a loop over it costs nothing
// extra.
//
// Threads come from a team (threads/thread_team.h), which a solver sets for its work with
// with_team(). Without a team the parts run one after the other.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <type_traits>
#include <utility>

#include "base/types.h"

namespace palpate {

/// Threads that execute the parts of loops.
class Team {
 public:
  /// A function that executes a part of a loop.
  using RunPart = void (*)(void* loop, Index part);
  /// A function that executes the work.
  using DoWork = void (*)(void* work);

  virtual ~Team() = default;
  Team(const Team&) = delete;
  Team& operator=(const Team&) = delete;

  /// Executes the work in this thread; the other threads execute parts of its loops.
  virtual void serve(DoWork do_work, void* work) = 0;
  /// Within serve(): executes each part once, in any order, and returns when all have ended. If
  /// parts throw, one of the exceptions is rethrown, and parts that have not started are skipped.
  virtual void run(Index num_parts, RunPart run_part, void* loop) = 0;

 protected:
  Team() = default;
};

/// Executes the work with a team.
/// @param team Null means that parts run one after the other.
void run_with(Team* team, Team::DoWork do_work, void* work);

/// Calls f() with a team for the loops in it.
/// @returns The result of f.
template <class F>
auto with_team(Team* team, F&& f) {
  if constexpr (std::is_void_v<decltype(f())>) {
    using Call = std::remove_reference_t<F>;
    run_with(
        team, [](void* work) { (*static_cast<Call*>(work))(); },
        const_cast<void*>(static_cast<const void*>(std::addressof(f))));
  } else {
    std::optional<decltype(f())> result;
    with_team(team, [&] { result.emplace(f()); });
    return std::move(*result);
  }
}

/// Executes the parts with the team of this thread.
void run_parts(Index num_parts, Team::RunPart run_part, void* loop);

/// Calls f(part) for each part, 0 … num_parts − 1.
template <class F>
void for_each_part(Index num_parts, F&& f) {
  using Function = std::remove_reference_t<F>;
  if (num_parts == 1) return f(Index{0});
  run_parts(
      num_parts, [](void* loop, Index part) { (*static_cast<Function*>(loop))(part); },
      const_cast<void*>(static_cast<const void*>(std::addressof(f))));
}

/// The parts of a sequence: ranges of nearly the same length. Their number is a power of two, so
/// that they coincide with the recursive halves of a sequence ordered by mesh/bisection_order.h.
class Ranges {
 public:
  /// Four for each of 64 threads, so that the threads end at about the same time.
  static constexpr Index kMostParts = 256;

  /// @param least The smallest number of items in a part, unless the sequence is shorter; fewer are
  ///   not worth a thread.
  Ranges(Index count, Index least) : count_(count) {
    while (num_parts_ < kMostParts && count / (2 * num_parts_) >= least) num_parts_ *= 2;
  }

  [[nodiscard]] Index num_parts() const { return num_parts_; }
  /// The first item of a part; for part num_parts() the number of items.
  [[nodiscard]] Index first(Index part) const {
    return static_cast<Index>(static_cast<std::int64_t>(count_) * part / num_parts_);
  }

 private:
  Index count_;
  Index num_parts_ = 1;
};

/// Calls f(first, last) for each range of a sequence, the last item not included.
template <class F>
void for_each_range(const Ranges& ranges, F&& f) {
  for_each_part(ranges.num_parts(),
                [&](Index part) { f(ranges.first(part), ranges.first(part + 1)); });
}

/// The smallest number of nodes in a part: with fewer, the exchange between parts takes more than a
/// tenth of a pass. A body of up to ten thousand unknowns, which is solved with a factor, is one
/// part.
inline constexpr Index kNodesOfPart = 4096;
/// The smallest number of values in a part if little is computed with each.
inline constexpr Index kNumbersOfPart = 1 << 16;

}  // namespace palpate
