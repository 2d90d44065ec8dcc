// SPDX-License-Identifier: BSD-3-Clause
// Whether one smooth branch runs through a leaf. This follows from the residual of the energy Π
// along the edges. Under refinement it falls to 1/32 where Π is smooth and to a half where the
// force jumps, and it stays the same where Π jumps from one branch to another.
#pragma once

#include <vector>

#include "interpolation/check_point_grid.h"

namespace palpate {

/// |Π₁ − Π₀ − ½ (h₀ + h₁)·d − 1/12 d·(k₀ − k₁) d|, J, along the edge d from the displacement of one
/// configuration to that of the other, m.
[[nodiscard]] double edge_residual(const ConfigurationSummary& a, const ConfigurationSummary& b,
                                   const Vec3& d);

/// Whether the energy and the forces at the ends of an edge in a rigid tool's space fit each other,
/// so that both ends may be on one smooth branch. The bounds are shares of a large force.
class EdgeFit {
 public:
  /// @param configurations Those of level 0 say what a large force is: one that a twentieth of all
  ///   exceed. The largest of all may be that of a few places where the body cannot give way.
  explicit EdgeFit(const std::vector<ConfigurationSummary>& configurations);

  [[nodiscard]] bool fits(const ConfigurationSummary& a, const ConfigurationSummary& b) const {
    return fits_in_energy(a, b) && fits_in_force(a, b);
  }
  [[nodiscard]] bool fits_in_energy(const ConfigurationSummary& a,
                                    const ConfigurationSummary& b) const;
  /// An edge within which the body changes from one side to the other may fit in energy.
  [[nodiscard]] bool fits_in_force(const ConfigurationSummary& a,
                                   const ConfigurationSummary& b) const;

 private:
  double large_force_ = 0;
};

/// The arguments must outlive the object.
class BranchTest {
 public:
  BranchTest(const CheckPointGrid& grid, const std::vector<ConfigurationSummary>& configurations)
      : grid_(grid), configurations_(configurations) {}

  /// The largest residual along the edges of a cell, J. An edge with an unusable end does not
  /// count.
  [[nodiscard]] double largest_residual(const Cell& cell) const {
    return largest(cell, false, Edges::all);
  }

  /// The largest residual along the edges of leaves for which has_jump() holds, J.
  [[nodiscard]] double largest_jump() const;

  /// Whether two refinements in a row have each left more than an eighth of the residual, or in a
  /// sparse grid more than a quarter. Edges between a free node and one that is not free do not
  /// count: contact begins there with the fourth power of the depth, and no branch ends. The answer
  /// depends on the root cell of the leaf alone.
  [[nodiscard]] bool has_jump(const Cell& leaf) const;

  /// For each leaf, 1 if it lies across branches: if it has a jump, or is so near to such a leaf
  /// that its mixed derivatives are differences across it.
  /// @param has_jump For each leaf, 1 if has_jump() says so.
  [[nodiscard]] std::vector<char> leaves_across(std::vector<char> has_jump) const;

 private:
  enum class Edges { all, without_onset };
  [[nodiscard]] double residual(CheckPoint first, int axis, std::int32_t side, Edges edges) const;
  [[nodiscard]] double largest(const Cell& cell, bool halves, Edges edges) const;

  const CheckPointGrid& grid_;
  const std::vector<ConfigurationSummary>& configurations_;
};

}  // namespace palpate
