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

/// The force that a twentieth of some exceed, N: the largest of all may be that of a few places
/// where the body cannot give way. 0: there is none.
[[nodiscard]] double large_force(std::vector<double> forces);

/// Whether the energy and the forces at the ends of an edge in a rigid tool's space fit each other,
/// so that both ends may be on one smooth branch. Misfits are shares of a large force of level 0.
/// The misfit of the force from which on an edge lies across branches, so that a search for levels
/// tries it. At the ridges of a liver with cells of 0.4 radii, half of the transitions along edges
/// with this, or with a misfit of the energy of 0.05, find a new level, and three quarters of all
/// edges that lead to one are among them; the others are found from there. Edges of half these
/// misfits are three times as many.
inline constexpr double kForceMisfitAcross = 0.3;

class EdgeFit {
 public:
  explicit EdgeFit(const std::vector<ConfigurationSummary>& configurations);

  /// The residual of the energy over the length of the edge.
  [[nodiscard]] double energy_misfit(const ConfigurationSummary& a,
                                     const ConfigurationSummary& b) const;
  /// The residual of the force. An edge within which the body changes from one side to the other
  /// may fit in energy.
  [[nodiscard]] double force_misfit(const ConfigurationSummary& a,
                                    const ConfigurationSummary& b) const;
  /// N.
  [[nodiscard]] double large_force() const { return large_force_; }
  /// Cells of 0.8 radii of a sphere have errors of 1 % in the mean, and of 4 % at most.
  [[nodiscard]] bool fits(const ConfigurationSummary& a, const ConfigurationSummary& b) const {
    return !(energy_misfit(a, b) > 0.02) && !(force_misfit(a, b) > 0.2);
  }

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
