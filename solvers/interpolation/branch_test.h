// SPDX-License-Identifier: BSD-3-Clause
// Whether one smooth branch runs through a leaf. What is left of Π along its edges tells: it falls
// to 1/32 under refinement where Π is smooth, to a half where the force jumps, and stays where Π
// jumps from one branch to another.
#pragma once

#include <vector>

#include "interpolation/check_point_grid.h"

namespace palpate {

/// |Π₁ − Π₀ − ½ (h₀ + h₁)·d − 1/12 d·(k₀ − k₁) d|, J, along the edge d from the displacement of one
/// configuration to that of the other, m.
[[nodiscard]] double edge_residual(const ConfigurationSummary& a, const ConfigurationSummary& b,
                                   const Vec3& d);

/// It refers to its arguments, which have to outlive it.
class BranchTest {
 public:
  BranchTest(const CheckPointGrid& grid, const std::vector<ConfigurationSummary>& configurations)
      : grid_(grid), configurations_(configurations) {}

  /// The largest along the edges of a cell, J; those of which an end is not usable do not count.
  [[nodiscard]] double largest_residual(const Cell& cell) const {
    return largest(cell, false, Edges::all);
  }

  /// The largest along the edges of the leaves that lie across branches themselves, J.
  [[nodiscard]] double largest_jump() const;

  /// For each leaf 1 where it lies across branches: twice in a row refinement has left more than an
  /// eighth of the residual, in a sparse grid a quarter; and where it is so near to one that its
  /// mixed derivatives reach across. Edges between a free node and one that is not free do not
  /// count: the energy begins there as the fourth power of the depth, and no branch ends.
  [[nodiscard]] std::vector<char> leaves_across() const;

 private:
  enum class Edges { all, without_onset };
  [[nodiscard]] double residual(CheckPoint first, int axis, std::int32_t side, Edges edges) const;
  [[nodiscard]] double largest(const Cell& cell, bool halves, Edges edges) const;
  [[nodiscard]] bool is_across(const Cell& cell) const;

  const CheckPointGrid& grid_;
  const std::vector<ConfigurationSummary>& configurations_;
};

}  // namespace palpate
