// SPDX-License-Identifier: BSD-3-Clause
// Loops over the parts of a body, of which several may run at once.
//
// What a loop gives does not depend on how many threads run it, to the bit: parts follow from the
// size of the body alone, a part writes nothing that another one reads or writes, and what the
// parts have found is summed in their order. A body that is small is one part, and its loops are
// as if they were not there.
//
// Threads come from a team (threads/thread_team.h): whoever solves does it in with_team(). Outside
// of that, parts run one after the other.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <type_traits>
#include <utility>

#include "base/types.h"

namespace palpate {

/// Threads that run the parts of loops.
class Team {
 public:
  /// Runs a part of a loop.
  using RunPart = void (*)(void* loop, Index part);
  /// Does the work.
  using DoWork = void (*)(void* work);

  virtual ~Team() = default;
  Team(const Team&) = delete;
  Team& operator=(const Team&) = delete;

  /// Runs the work in this thread, of whose loops the others take parts.
  virtual void serve(DoWork do_work, void* work) = 0;
  /// Within serve(): runs each part once, in any order, and comes back when all have ended. An
  /// exception of a part is thrown on, one of them where there are several; parts that have not
  /// begun are left out.
  virtual void run(Index num_parts, RunPart run_part, void* loop) = 0;

 protected:
  Team() = default;
};

/// Runs the work with a team, or with none. @param team Null: parts run one after the other.
void run_with(Team* team, Team::DoWork do_work, void* work);

/// Calls f() with a team for the loops in it. @returns What f returns.
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

/// With the team of this thread.
void run_parts(Index num_parts, Team::RunPart run_part, void* loop);

/// Calls f(part) for each part, 0 … num_parts − 1.
template <class F>
void for_each_part(Index num_parts, F&& f) {
  using Loop = std::remove_reference_t<F>;
  if (num_parts == 1) return f(Index{0});
  run_parts(
      num_parts, [](void* loop, Index part) { (*static_cast<Loop*>(loop))(part); },
      const_cast<void*>(static_cast<const void*>(std::addressof(f))));
}

/// The parts of a sequence: ranges of nearly the same length, as many as a power of two, so that
/// they are the halves of halves of a sequence that is ordered so (mesh/bisection_order.h).
class Ranges {
 public:
  /// Four for each of 64 threads, so that they end at about the same time.
  static constexpr Index kMostParts = 256;

  /// @param least Items of a part, but for a sequence that has not as many: less than that is not
  ///   worth a thread.
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

/// The least nodes of a part: with fewer, what parts have to do with one another takes more than a
/// tenth of a pass. A body of up to ten thousand unknowns, for which there is a factor, is one
/// part.
inline constexpr Index kNodesOfPart = 4096;
/// The least numbers of a part where little is done with each.
inline constexpr Index kNumbersOfPart = 1 << 16;

}  // namespace palpate
