// SPDX-License-Identifier: BSD-3-Clause
#include "interpolation/branch_test.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace palpate {

double edge_residual(const ConfigurationSummary& a, const ConfigurationSummary& b, const Vec3& d) {
  return std::abs(b.energy - a.energy - 0.5 * d.dot(a.force + b.force) -
                  d.dot((a.stiffness - b.stiffness) * d) / 12);
}

namespace {

/// The share of all forces that are larger than a large one.
constexpr double kLarger = 0.05;

}  // namespace

double large_force(std::vector<double> forces) {
  if (forces.empty()) return 0;
  const auto larger = static_cast<std::ptrdiff_t>(kLarger * static_cast<double>(forces.size()));
  const auto large = forces.end() - 1 - larger;
  std::nth_element(forces.begin(), large, forces.end());
  return *large;
}

EdgeFit::EdgeFit(const std::vector<ConfigurationSummary>& configurations) {
  std::vector<double> forces;
  for (const ConfigurationSummary& c : configurations) {
    const bool touches = (c.flags & flags::touches_nothing) == 0;
    if (c.level == 0 && c.leads_on() && touches) forces.push_back(c.force.norm());
  }
  large_force_ = palpate::large_force(std::move(forces));
}

double EdgeFit::energy_misfit(const ConfigurationSummary& a, const ConfigurationSummary& b) const {
  const Vec3 d = b.t - a.t;
  return edge_residual(a, b, d) / (large_force_ * d.norm());
}

double EdgeFit::force_misfit(const ConfigurationSummary& a, const ConfigurationSummary& b) const {
  const Vec3 d = b.t - a.t;
  const Vec3 residual = b.force - a.force - 0.5 * (a.stiffness + b.stiffness) * d;
  return residual.norm() / large_force_;
}

namespace {

/// The largest share of an edge's residual that one refinement leaves where Π is smooth: 1/32 if
/// the cells are small enough.
constexpr double kShrinks = 0.125;
/// The same bound where contact begins: Π grows with the fourth power of the depth there, and cells
/// are seldom smaller than the contact layer.
constexpr double kShrinksInContact = 0.25;

/// The number of layers of leaves, around a leaf that lies across branches, whose mixed derivatives
/// are differences across that leaf.
constexpr int kLayers = 2;

}  // namespace

double BranchTest::residual(CheckPoint first, int axis, std::int32_t side, Edges edges) const {
  const std::int32_t low = grid_.tree().find(first);
  first[axis] += side;
  const std::int32_t high = grid_.tree().find(first);
  if (low < 0 || high < 0 || !grid_.usable(low) || !grid_.usable(high)) return 0;
  if (edges == Edges::without_onset && grid_.is_free(low) != grid_.is_free(high)) return 0;
  const ConfigurationSummary& a = configurations_[grid_.configuration(low)];
  const ConfigurationSummary& b = configurations_[grid_.configuration(high)];
  return edge_residual(a, b, side * grid_.spacing() * Vec3::Unit(axis));
}

/// The largest residual along the lines through a cell's corners and, with `halves`, also along
/// those through the other points of its halves.
double BranchTest::largest(const Cell& cell, bool halves, Edges edges) const {
  const std::int32_t step = halves ? cell.side / 2 : cell.side;
  double largest = 0;
  for (int axis = 0; axis < 3; ++axis) {
    for (std::int32_t a = 0; a <= cell.side; a += step) {
      for (std::int32_t b = 0; b <= cell.side; b += step) {
        CheckPoint first = cell.first;
        first[(axis + 1) % 3] += a;
        first[(axis + 2) % 3] += b;
        largest = std::max(largest, residual(first, axis, cell.side, edges));
      }
    }
  }
  return largest;
}

bool BranchTest::has_jump(const Cell& cell) const {
  if (4 * cell.side > grid_.tree().coarsest()) return false;
  const Cell parent = parent_of(cell, grid_.reach());
  const Cell its_parent = parent_of(parent, grid_.reach());
  const double shrinks = grid_.is_sparse() ? kShrinksInContact : kShrinks;
  return largest(cell, false, Edges::without_onset) > shrinks * largest(parent, true, Edges::all) &&
         largest(parent, true, Edges::without_onset) >
             shrinks * largest(its_parent, true, Edges::all);
}

double BranchTest::largest_jump() const {
  double jump = 0;
  for (const CellTree::Leaf& leaf : grid_.tree().leaves()) {
    if (has_jump(leaf.cell)) jump = std::max(jump, largest(leaf.cell, false, Edges::without_onset));
  }
  return jump;
}

std::vector<char> BranchTest::leaves_across(std::vector<char> has_jump) const {
  const auto& leaves = grid_.tree().leaves();
  std::vector<char> across = std::move(has_jump);
  for (int layer = 0; layer < kLayers; ++layer) {
    std::vector<char> reached(static_cast<std::size_t>(grid_.num_nodes()), 0);
    for (std::size_t l = 0; l < leaves.size(); ++l) {
      for (std::int32_t node : leaves[l].corners) reached[node] |= across[l];
    }
    for (std::size_t l = 0; l < leaves.size(); ++l) {
      for (std::int32_t node : leaves[l].corners) across[l] |= reached[node];
    }
  }
  return across;
}

}  // namespace palpate
