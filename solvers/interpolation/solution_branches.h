// SPDX-License-Identifier: BSD-3-Clause
// The solution branches of a tool space with levels, and the branch that the body is on.
//
// A branch has at most one configuration for each check-point, and any two neighbours in it are
// connected by a smooth transition: a body that is moved from one is found at the other, and comes
// back as far as that was tried. A branch ends where the body jumps, and has no unstable
// configuration. Where branches join, as around a cusp, they share configurations. A tool space
// without levels has one branch of all configurations. For the space of a rigid tool see
// shell_branches.h.
//
// The body follows its branch. Where the branch has no cell, the body goes to the branch that the
// transitions from the last corners have reached, or else to that of least energy.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/memory_ranges.h"
#include "interpolation/shell_branches.h"
#include "state_space/touch_space.h"

namespace palpate {

/// The branch that a body is on.
struct OnBranch {
  std::int32_t number = 0;
  /// In the space of a rigid tool, the branch that the body has left where it ends, as long as it
  /// is moved among cells with configurations of that: it may be on that one still; −1: none.
  std::int32_t left = -1;
  /// Whether nobody has tried how that one goes on (BranchEnd::untried). Then the body may be on it
  /// until the tool touches nothing, or all that it has is on the present one too.
  bool is_untried = false;
};

/// Immutable. It copies all that it needs, so that the tool space need not outlive it.
class SolutionBranches {
 public:
  explicit SolutionBranches(const TouchToolSpace& tool_space);

  /// The number of branches, at least one; the first is that of rest.
  [[nodiscard]] int size() const { return static_cast<int>(configurations_.size()); }
  /// Whether there is one branch alone, which ends nowhere in its cells.
  [[nodiscard]] bool is_one_whole() const { return next_.empty(); }
  /// The configurations of a branch: indices into the tool space's list, ascending.
  [[nodiscard]] const std::vector<std::int32_t>& configurations(int branch) const {
    return configurations_[static_cast<std::size_t>(branch)];
  }

  /// The branch that the body is on after it was moved straight from one displacement to another,
  /// m.
  /// @param branch The branch at the start.
  /// @note Realtime-safe.
  [[nodiscard]] int move(int branch, const Vec3& from, const Vec3& to) const noexcept;

  /// Does the same, and says where the body has left a branch that ends.
  /// @note Realtime-safe.
  [[nodiscard]] OnBranch move(const OnBranch& branch, const Vec3& from,
                              const Vec3& to) const noexcept;
  /// Whether, in the space of a rigid tool, a branch ends within the cell that has a place.
  /// @note Realtime-safe.
  [[nodiscard]] bool ends_at(int branch, const Vec3& t) const noexcept;

  /// Memory that move() needs.
  void add_memory(MemoryRanges& ranges) const {
    palpate::add_memory(cells_, ranges);
    palpate::add_memory(next_, ranges);
    palpate::add_memory(ends_, ranges);
    palpate::add_memory(parts_, ranges);
    if (leaves_) leaves_->add_memory(ranges);
  }

 private:
  [[nodiscard]] int follow(int branch, const Vec3& t) const noexcept;
  [[nodiscard]] OnBranch follow_in_leaves(OnBranch branch, const Vec3& t) const noexcept;
  /// In the space of a rigid tool, the leaf that has a place; −1: there is none.
  [[nodiscard]] std::int32_t leaf_at(const Vec3& t) const noexcept;
  /// Whether a body that has left a branch for another one may be on the former in a leaf: it has
  /// something there, or nobody has tried how it goes on, and it is not the same as the other one
  /// at all corners.
  [[nodiscard]] bool may_be_on_left(std::int32_t leaf, const OnBranch& branch) const noexcept;
  [[nodiscard]] std::size_t place_of(std::int32_t leaf, std::int32_t branch) const noexcept {
    return static_cast<std::size_t>(leaf) * configurations_.size() +
           static_cast<std::size_t>(branch);
  }
  /// The branch that the body is on in a cell; if none spans the cell, the branch that it was on.
  [[nodiscard]] int next(int branch, const CheckPoint& cell) const noexcept;

  double spacing_ = 0;
  std::int32_t reach_ = 0;
  Vec3 origin_;
  std::vector<std::vector<std::int32_t>> configurations_;
  /// The first corners of the cells that a branch spans, ascending; empty if there is one branch.
  /// The other cells of the grid, which may be very many, take no memory.
  std::vector<CheckPoint> cells_;
  /// In the space of a rigid tool whose branches end somewhere, the cells of all check-points.
  std::optional<CellTree> leaves_;
  /// For each of these cells and each branch that the body came on, the branch that it goes on with
  /// [cells × size], those of a cell next to each other.
  std::vector<std::int16_t> next_;
  /// For the same, whether the branch ends there.
  std::vector<BranchEnd> ends_;
  std::vector<LeafOfBranch> parts_;
};

/// The part of a tool space that is on one of its branches. A rigid tool's further branches know of
/// no place where it touches nothing but those of their configurations: the body may have been
/// pressed there.
[[nodiscard]] TouchToolSpace on_branch(const TouchToolSpace& tool_space,
                                       const SolutionBranches& branches, int branch);

/// Makes a tool space of some configurations alone, with the intermediate states on the way to
/// them, and their coefficients of the modes.
/// @param configurations Indices into the tool space's list, ascending.
[[nodiscard]] TouchToolSpace restricted(const TouchToolSpace& tool_space,
                                        const std::vector<std::int32_t>& configurations);

}  // namespace palpate
