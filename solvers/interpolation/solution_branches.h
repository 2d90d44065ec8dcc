// SPDX-License-Identifier: BSD-3-Clause
// The branches of a tool space with levels, and which of them the body is on.
//
// A branch holds at most one configuration a check-point, and any two neighbours in it are one
// smooth way apart: what is moved from one is found at the other, and back again as far as that was
// tried. A branch ends where the body jumps, and holds nothing unstable. Where branches join, as
// round a cusp, branches share configurations. Without levels, and in a sparse grid, there is one,
// of all configurations.
//
// The body follows its branch; where that has no cell at its displacement, the body is on the
// branch that the transitions from the last corners have reached, else on that of least energy.
#pragma once

#include <cstdint>
#include <vector>

#include "base/memory_ranges.h"
#include "state_space/touch_space.h"

namespace palpate {

/// An object is immutable and holds all that it needs: the tool space may go.
class SolutionBranches {
 public:
  explicit SolutionBranches(const TouchToolSpace& tool_space);

  /// There is at least one branch; the first is that of rest.
  [[nodiscard]] int size() const { return static_cast<int>(configurations_.size()); }
  /// Places in the tool space's list, ascending.
  [[nodiscard]] const std::vector<std::int32_t>& configurations(int branch) const {
    return configurations_[static_cast<std::size_t>(branch)];
  }

  /// The branch that the body is on when it is moved straight from one displacement to another, m.
  /// @param branch Where it begins.
  /// @note Realtime-safe.
  [[nodiscard]] int move(int branch, const Vec3& from, const Vec3& to) const noexcept;

  /// Memory that move() needs.
  void add_memory(MemoryRanges& ranges) const {
    palpate::add_memory(cells_, ranges);
    palpate::add_memory(next_, ranges);
  }

 private:
  [[nodiscard]] int follow(int branch, const Vec3& t) const noexcept;
  /// The branch that the body is on in a cell; where none spans it, the one that it was on.
  [[nodiscard]] int next(int branch, const CheckPoint& cell) const noexcept;

  double spacing_ = 0;
  std::int32_t reach_ = 0;
  Vec3 origin_;
  std::vector<std::vector<std::int32_t>> configurations_;
  /// The first corners of the cells that a branch spans, ascending; empty where there is one
  /// branch. The others of the grid, which may be very many, take no memory.
  std::vector<CheckPoint> cells_;
  /// Of each of them and each branch the branch that the body is on there [cells × size], those of
  /// a cell one after the other.
  std::vector<std::int16_t> next_;
};

/// Makes a tool space of these configurations alone, with the intermediate states on the way to
/// them, and without the modes.
/// @param configurations Places in the tool space's list, ascending.
[[nodiscard]] TouchToolSpace restricted(const TouchToolSpace& tool_space,
                                        const std::vector<std::int32_t>& configurations);

}  // namespace palpate
