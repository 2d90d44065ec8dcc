// SPDX-License-Identifier: BSD-3-Clause
#include "interpolation/error_estimate.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "base/error.h"
#include "base/quantity.h"
#include "interpolation/branch_test.h"
#include "interpolation/check_point_grid.h"
#include "interpolation/clearance.h"
#include "interpolation/extrapolated_node.h"
#include "interpolation/hermite_cell.h"
#include "interpolation/hermite_data.h"

namespace palpate {
namespace {

constexpr double kOfMixed = 2;
constexpr double kOfParent = 0.25;
constexpr double kOfEdges = 0.5;
constexpr double kOfHanging = 1.2;
constexpr double kOfDiagonals = 0.4;
constexpr double kOfThirdAlongEdges = 0.11;
constexpr double kOfThirdAlongDiagonals = 0.05;

/// Points along an axis at which forces are compared.
constexpr int kSamples = 5;

/// The numbers of nodes in the differences that are compared.
constexpr int kNodes = kHermiteStencil;
constexpr int kFewerNodes = 3;

/// Extrapolated nodes do not decide about refinement.
HermiteDataOptions options_with(int most, bool is_sparse = false) {
  HermiteDataOptions options;
  options.most = most;
  options.fewer_in_short_rows = is_sparse;
  options.extrapolated_nodes = false;
  return options;
}

class Estimator {
 public:
  Estimator(const Grid& grid, const std::vector<ConfigurationSummary>& configurations,
            const Clearance& clearance)
      : configurations_(configurations),
        clearance_(clearance),
        grid_(grid, configurations, clearance),
        branch_test_(grid_, configurations),
        data_(hermite_data(grid_, configurations, options_with(kNodes))),
        difference_(hermite_data(grid_, configurations, options_with(kFewerNodes, grid.sparse))),
        hanging_(grid_.tree().leaves().size(), 0.0) {
    for (std::size_t n = 0; n < data_.size(); ++n) {
      for (std::size_t i = 0; i < std::size(data_[n].of); ++i) {
        difference_[n].of[i] -= data_[n].of[i];
      }
    }
    for (const CheckPointGrid::HangingNode& hanging : grid_.hanging_on_complete()) {
      const Vec3 force = force_of(data_, grid_.leaf(hanging.leaf), hanging.s);
      double& error = hanging_[hanging.leaf];
      error = std::max(error, (force - at(hanging.node).force).norm());
    }
  }

  [[nodiscard]] const CheckPointGrid& grid() const { return grid_; }

  [[nodiscard]] CellEstimate estimate(std::int32_t leaf) const {
    CellEstimate estimate;
    estimate.cell = grid_.leaf(leaf).cell;
    estimate.error = std::numeric_limits<double>::infinity();
    estimate.marked = !grid_.is_complete(leaf) || grid_.is_marked(leaf);
    const bool is_root = estimate.cell.side == grid_.tree().coarsest();
    const bool few_in_a_row =
        !grid_.is_sparse() && 2 * grid_.reach() < (kNodes - 1) * estimate.cell.side;
    if (!grid_.is_complete(leaf) || (is_root && few_in_a_row)) return estimate;
    estimate.error = std::max({kOfMixed * of_mixed(leaf), kOfParent * of_parent(leaf),
                               kOfEdges * of_edges(leaf), kOfHanging * hanging_[leaf]});
    if (grid_.is_sparse()) estimate.error = std::max(estimate.error, of_pairs(leaf));
    estimate.error = std::max(estimate.error, attraction(leaf, estimate.error));
    return estimate;
  }

  /// The estimate of each leaf.
  [[nodiscard]] std::vector<CellEstimate> estimates() const {
    std::vector<CellEstimate> estimates;
    const auto count = static_cast<std::int32_t>(grid_.tree().leaves().size());
    for (std::int32_t leaf = 0; leaf < count; ++leaf) estimates.push_back(estimate(leaf));
    return estimates;
  }

  [[nodiscard]] bool may_be_split(const CellEstimate& estimate, std::int32_t leaf,
                                  std::int32_t smallest) const {
    const std::int32_t side = estimate.cell.side;
    if (side < 2 * smallest || side < 2 || grid_.is_proved_free(leaf)) return false;
    const bool across = grid_.is_complete(leaf) && grid_.is_across(leaf);
    if (estimate.marked &&
        side <= grid_.tree().coarsest() / (across ? kMarkedEdge : kMarkedCorner)) {
      return false;
    }
    bool within_limit = false;
    bool good = false;
    for (std::int32_t node : grid_.leaf(leaf).corners) {
      if (!has_configuration(node)) return false;
      const bool usable = grid_.usable(node);
      within_limit = within_limit || (usable && (at(node).flags & flags::beyond_force_limit) == 0);
      good = good || (usable && !grid_.is_marking(node));
    }
    return within_limit && good;
  }

 private:
  [[nodiscard]] const ConfigurationSummary& at(std::int32_t node) const {
    return configurations_[grid_.configuration(node)];
  }

  [[nodiscard]] bool has_configuration(std::int32_t node) const {
    if (grid_.usable(node)) return true;
    ConfigurationSummary key;
    key.check_point = grid_.tree().point(node);
    const auto found = std::lower_bound(configurations_.begin(), configurations_.end(), key);
    return found != configurations_.end() && found->check_point == key.check_point;
  }

  /// The force that the data give in a leaf, N.
  [[nodiscard]] Vec3 force_of(const std::vector<HermiteNode>& data, const CellTree::Leaf& leaf,
                              const Vec3& s) const {
    HermiteJet jet;
    kernel_(data.data(), leaf, s, jet);
    return Vec3(jet[1], jet[2], jet[3]) / (leaf.cell.side * grid_.spacing());
  }

  /// The largest force of the difference data at the samples, N.
  [[nodiscard]] double of_mixed(std::int32_t leaf) const {
    double error2 = 0;
    for (int x = 0; x < kSamples; ++x) {
      for (int y = 0; y < kSamples; ++y) {
        for (int z = 0; z < kSamples; ++z) {
          const Vec3 s = Vec3(x, y, z) / (kSamples - 1);
          error2 = std::max(error2, force_of(difference_, grid_.leaf(leaf), s).squaredNorm());
        }
      }
    }
    return std::sqrt(error2);
  }

  /// The largest force at those samples where the tool touches nothing, N, if it exceeds a bound;
  /// else 0.
  [[nodiscard]] double attraction(std::int32_t leaf, double bound) const {
    if (!clearance_ || grid_.is_zero(leaf)) return 0;
    const CellTree::Leaf& of_leaf = grid_.leaf(leaf);
    const double side = of_leaf.cell.side * grid_.spacing();
    const Vec3 first = grid_.place(of_leaf.corners[0]);
    ClearanceProbe probe(clearance_, first + Vec3::Constant(0.5 * side));
    if (probe.value() <= -0.5 * std::sqrt(3.0) * side) return 0;
    double largest = bound;
    for (int x = 0; x < kSamples; ++x) {
      for (int y = 0; y < kSamples; ++y) {
        for (int z = 0; z < kSamples; ++z) {
          const Vec3 s = Vec3(x, y, z) / (kSamples - 1);
          const double force = force_of(data_, of_leaf, s).norm();
          if (force > largest && probe.is_free(first + side * s)) largest = force;
        }
      }
    }
    return largest > bound ? largest : 0;
  }

  [[nodiscard]] double of_parent(std::int32_t leaf) const {
    const CellTree::Leaf& child = grid_.leaf(leaf);
    if (child.cell.side == grid_.tree().coarsest()) return 0;
    CellTree::Leaf parent;
    parent.cell = parent_of(child.cell, grid_.reach());
    for (int corner = 0; corner < 8; ++corner) {
      parent.corners[corner] = grid_.tree().find(corner_of(parent.cell, corner));
      if (!grid_.usable(parent.corners[corner])) return 0;
    }
    double error = 0;
    for (std::int32_t node : child.corners) {
      const CheckPoint p = grid_.tree().point(node);
      Vec3 s;
      for (int k = 0; k < 3; ++k) {
        s[k] = static_cast<double>(p[k] - parent.cell.first[k]) / parent.cell.side;
      }
      error = std::max(error, (force_of(data_, parent, s) - at(node).force).norm());
    }
    return error;
  }

  [[nodiscard]] double of_edges(std::int32_t leaf) const {
    const Cell& cell = grid_.leaf(leaf).cell;
    return branch_test_.largest_residual(cell) / (cell.side * grid_.spacing());
  }

  /// The largest residual between two corners, N: of the energy along diagonals, and of the force
  /// where third derivatives are known.
  [[nodiscard]] double of_pairs(std::int32_t leaf) const {
    const CellTree::Leaf& of_leaf = grid_.leaf(leaf);
    double largest = 0;
    for (int high = 1; high < 8; ++high) {
      for (int low = 0; low < high; ++low) {
        const ConfigurationSummary& a = at(of_leaf.corners[low]);
        const ConfigurationSummary& b = at(of_leaf.corners[high]);
        const Vec3 d = grid_.place(of_leaf.corners[high]) - grid_.place(of_leaf.corners[low]);
        const int differ = low ^ high;
        const bool is_edge = (differ & (differ - 1)) == 0;
        if (!is_edge) largest = std::max(largest, kOfDiagonals * edge_residual(a, b, d) / d.norm());
        if (!a.has_third_derivative() || !b.has_third_derivative()) continue;
        const Mat3 of_third = times(a.third_derivative - b.third_derivative, d);
        const Vec3 left =
            b.force - a.force - 0.5 * (a.stiffness + b.stiffness) * d - of_third * d / 12;
        const double factor = is_edge ? kOfThirdAlongEdges : kOfThirdAlongDiagonals;
        largest = std::max(largest, factor * left.norm());
      }
    }
    return largest;
  }

  const std::vector<ConfigurationSummary>& configurations_;
  const Clearance& clearance_;
  CheckPointGrid grid_;
  BranchTest branch_test_;
  HermiteKernel kernel_ = best_hermite_kernel();
  std::vector<HermiteNode> data_;
  /// The data with differences of fewer nodes, minus data_.
  std::vector<HermiteNode> difference_;
  /// The largest error at the nodes that hang on each leaf, N.
  std::vector<double> hanging_;
};

void sort_by_cell(std::vector<CellEstimate>& estimates) {
  std::sort(estimates.begin(), estimates.end(),
            [](const CellEstimate& a, const CellEstimate& b) { return a.cell < b.cell; });
}

}  // namespace

std::vector<CellEstimate> estimate_errors(const Grid& grid,
                                          const std::vector<ConfigurationSummary>& configurations,
                                          const Clearance& clearance) {
  std::vector<CellEstimate> estimates = Estimator(grid, configurations, clearance).estimates();
  sort_by_cell(estimates);
  return estimates;
}

std::vector<double> estimate_errors_in(const Grid& grid,
                                       const std::vector<ConfigurationSummary>& configurations,
                                       const std::vector<Cell>& cells) {
  const Clearance none;
  const Estimator estimator(grid, configurations, none);
  std::map<Cell, std::int32_t> leaves;
  for (const CellTree::Leaf& leaf : estimator.grid().tree().leaves()) {
    leaves.emplace(leaf.cell, static_cast<std::int32_t>(leaves.size()));
  }
  std::vector<double> errors;
  for (const Cell& cell : cells) {
    const auto leaf = leaves.find(cell);
    errors.push_back(leaf == leaves.end() ? std::numeric_limits<double>::infinity()
                                          : estimator.estimate(leaf->second).error);
  }
  return errors;
}

std::vector<double> estimate_errors_around(const Grid& grid,
                                           const std::vector<ConfigurationSummary>& configurations,
                                           const Clearance& clearance) {
  const Estimator estimator(grid, configurations, clearance);
  const CellTree& tree = estimator.grid().tree();
  const std::vector<CellEstimate> of_leaf = estimator.estimates();
  std::vector<double> errors;
  for (const ConfigurationSummary& c : configurations) {
    double largest = -1;
    tree.for_each_leaf_around(c.check_point, [&](std::int32_t leaf) {
      largest = std::max(largest, of_leaf[leaf].error);
    });
    const bool is_known = largest >= 0 && std::isfinite(largest);
    errors.push_back(is_known ? largest : std::numeric_limits<double>::quiet_NaN());
  }
  return errors;
}

CellRefinement plan_refinement(const Grid& grid,
                               const std::vector<ConfigurationSummary>& configurations,
                               double tolerance, std::int32_t smallest, const Clearance& clearance,
                               const std::function<bool(const CellEstimate&)>& is_left) {
  if (!(tolerance > 0)) {
    throw InputError("The tolerance of the force is " + quantity(tolerance, "N") +
                     "; it takes a positive one.");
  }
  const Estimator estimator(grid, configurations, clearance);
  const CellTree& tree = estimator.grid().tree();
  const auto num_leaves = static_cast<std::int32_t>(tree.leaves().size());
  std::vector<char> is_split(tree.leaves().size(), 0);
  CellRefinement refinement{estimator.estimates(), {}};
  for (std::int32_t leaf = 0; leaf < num_leaves; ++leaf) {
    const CellEstimate& estimate = refinement.estimates[leaf];
    is_split[leaf] = estimate.error > tolerance && !(is_left && is_left(estimate)) &&
                     estimator.may_be_split(estimate, leaf, smallest);
  }
  // Calls visit(other) for the larger leaves that touch a leaf: they contain one of its corners.
  const auto for_each_larger = [&](std::int32_t leaf, auto&& visit) {
    for (std::int32_t node : tree.leaves()[leaf].corners) {
      tree.for_each_leaf_around(tree.point(node), [&](std::int32_t other) {
        if (tree.leaves()[other].cell.side > tree.leaves()[leaf].cell.side) visit(other);
      });
    }
  };
  std::vector<std::int32_t> split;
  for (std::int32_t leaf = 0; leaf < num_leaves; ++leaf) {
    bool waits = !is_split[leaf];
    for_each_larger(leaf, [&](std::int32_t other) { waits = waits || is_split[other]; });
    if (!waits) split.push_back(leaf);
  }
  std::fill(is_split.begin(), is_split.end(), 0);
  for (std::int32_t leaf : split) is_split[leaf] = 1;
  for (std::size_t i = 0; i < split.size(); ++i) {
    for_each_larger(split[i], [&](std::int32_t other) {
      if (is_split[other] || !estimator.grid().is_complete(other) ||
          estimator.grid().is_proved_free(other)) {
        return;
      }
      is_split[other] = 1;
      split.push_back(other);
    });
  }
  for (std::int32_t leaf : split) refinement.to_split.push_back(tree.leaves()[leaf].cell);
  std::sort(refinement.to_split.begin(), refinement.to_split.end());
  sort_by_cell(refinement.estimates);
  return refinement;
}

std::map<CheckPoint, std::vector<CheckPoint>> corners_of_new_points(
    const std::vector<Cell>& cells, const std::function<bool(const CheckPoint&)>& is_known) {
  std::map<CheckPoint, std::vector<CheckPoint>> corners_of;
  for (const Cell& cell : cells) {
    for (const CheckPoint& point : points_of_split(cell)) {
      if (is_known(point)) continue;
      std::vector<CheckPoint>& corners = corners_of[point];
      for (int c = 0; c < 8; ++c) corners.push_back(corner_of(cell, c));
    }
  }
  for (auto& [point, corners] : corners_of) {
    std::sort(corners.begin(), corners.end());
    corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  }
  return corners_of;
}

std::vector<CheckPoint> points_of_split(const Cell& cell) {
  std::vector<CheckPoint> points;
  for (int which = 0; which < 27; ++which) {
    const bool is_corner = which / 9 != 1 && which / 3 % 3 != 1 && which % 3 != 1;
    if (!is_corner) points.push_back(point_of_halves(cell, which));
  }
  return points;
}

}  // namespace palpate
