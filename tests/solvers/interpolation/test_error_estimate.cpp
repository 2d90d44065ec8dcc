// SPDX-License-Identifier: BSD-3-Clause
#include "interpolation/error_estimate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>

#include "base/error.h"
#include "interpolation/interpolator.h"
#include "solvers/interpolation/analytic_space.h"

namespace palpate::test::test_error_estimate {
namespace {

using test::analytic_space;
using test::exponential;
using test::graded_space;
using test::kHalfWidth;

/// ½|x|² + 0.02 e^{7 (n·x − 0.4)}, x = t/half-width: a wall in one corner.
test::Sample wall(const Vec3& t) {
  const Vec3 n(0.8, 0.5, 0.33);
  const Vec3 x = t / kHalfWidth;
  const double e = 0.02 * std::exp(7 * (n.dot(x) - 0.4));
  return {0.5 * x.squaredNorm() + e, (x + 7 * e * n) / kHalfWidth,
          (Mat3::Identity() + 49 * e * n * n.transpose()) / (kHalfWidth * kHalfWidth)};
}

/// ½|x|², and 0.01 + 0.05 s more on the far side of a plane s = 0: another branch.
test::Sample two_branches(const Vec3& t) {
  const Vec3 n(0.9, 0.4, -0.2);
  const Vec3 x = t / kHalfWidth;
  const double s = n.dot(x) - 0.3;
  test::Sample sample{0.5 * x.squaredNorm(), x / kHalfWidth,
                      Mat3::Identity() / (kHalfWidth * kHalfWidth)};
  if (s > 0) {
    sample.energy += 0.01 + 0.05 * s;
    sample.force += 0.05 * n / kHalfWidth;
  }
  return sample;
}

double largest_force(const test::Energy& energy) {
  test::RandomPoints points;
  double largest = 0;
  for (int i = 0; i < 20000; ++i) largest = std::max(largest, energy(points()).force.norm());
  return largest;
}

bool is_balanced(const CellTree& tree) {
  for (std::int32_t node = 0; node < tree.num_nodes(); ++node) {
    std::int32_t least = 1 << 20;
    std::int32_t most = 0;
    tree.for_each_leaf_around(tree.point(node), [&](std::int32_t leaf) {
      least = std::min(least, tree.leaves()[leaf].cell.side);
      most = std::max(most, tree.leaves()[leaf].cell.side);
    });
    if (most > 2 * least) return false;
  }
  return true;
}

/// Splits until there is nothing to split.
TouchToolSpace refined(const test::Energy& energy, double tolerance, std::int32_t smallest = 1,
                       std::int32_t coarse = 3) {
  TouchToolSpace tool_space = analytic_space(energy, 64 * (coarse - 1) + 1, 64);
  for (int round = 0; round < 30; ++round) {
    const std::vector<Cell> cells =
        cells_to_split(tool_space.setup.grid, tool_space.configurations, tolerance, smallest);
    if (cells.empty()) return tool_space;
    EXPECT_TRUE(std::is_sorted(cells.begin(), cells.end()));
    for (const Cell& cell : cells) test::split(tool_space, energy, cell);
    EXPECT_TRUE(is_balanced(CellTree(tool_space.setup.grid, tool_space.configurations)));
  }
  ADD_FAILURE() << "it does not end";
  return tool_space;
}

TEST(ErrorEstimate, AroundAPointIsTheLargestOfItsCells) {
  const TouchToolSpace tool_space = graded_space(wall);
  const std::vector<CellEstimate> cells =
      estimate_errors(tool_space.setup.grid, tool_space.configurations);
  const std::vector<double> errors =
      estimate_errors_around(tool_space.setup.grid, tool_space.configurations);
  ASSERT_EQ(errors.size(), tool_space.configurations.size());
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const CheckPoint& p = tool_space.configurations[i].check_point;
    double largest = -1;
    for (const auto& [cell, error, marked] : cells) {
      bool holds = true;
      for (int k = 0; k < 3; ++k) {
        holds = holds && cell.first[k] <= p[k] && p[k] <= cell.first[k] + cell.side;
      }
      if (holds) largest = std::max(largest, error);
    }
    EXPECT_EQ(errors[i], largest) << i;
    EXPECT_GE(errors[i], 0);
  }
  TouchToolSpace small = analytic_space(wall, 3, 1);
  for (double error : estimate_errors_around(small.setup.grid, small.configurations)) {
    EXPECT_TRUE(std::isnan(error));
  }
}

TEST(ErrorEstimate, RefinementKeepsTheTolerance) {
  struct Case {
    test::Energy energy;
    double relative;
    std::size_t most;
  };
  for (const auto& [energy, relative, most] :
       {Case{exponential, 0.01, 130}, Case{exponential, 0.001, 400}, Case{wall, 0.05, 160},
        Case{wall, 0.01, 250}, Case{wall, 0.001, 700}}) {
    const double tolerance = relative * largest_force(energy);
    const TouchToolSpace tool_space = refined(energy, tolerance);
    RecordProperty("configurations", std::to_string(tool_space.configurations.size()));
    EXPECT_LT(tool_space.configurations.size(), most);
    const auto interpolator = make_interpolator(Method::energy_hermite, tool_space);
    test::RandomPoints points;
    double error = 0;
    for (int i = 0; i < 20000; ++i) {
      const Vec3 t = points();
      error = std::max(error, (interpolator->evaluate(t).force - energy(t).force).norm());
    }
    EXPECT_LT(error, tolerance);
    for (const CellEstimate& e :
         estimate_errors(tool_space.setup.grid, tool_space.configurations)) {
      EXPECT_LE(e.error, tolerance);
      EXPECT_FALSE(e.marked);
    }
  }
}

TEST(ErrorEstimate, RefinementKeepsTheToleranceWithThirdDerivatives) {
  for (double relative : {0.01, 0.001}) {
    const double tolerance = relative * largest_force(exponential);
    TouchToolSpace tool_space = analytic_space(exponential, 129, 64);
    const std::size_t without = refined(exponential, tolerance).configurations.size();
    for (std::vector<Cell> cells{{}}; !cells.empty();) {
      test::add_third_derivatives(tool_space, test::exponential_third);
      cells = cells_to_split(tool_space.setup.grid, tool_space.configurations, tolerance);
      for (const Cell& cell : cells) test::split(tool_space, exponential, cell);
    }
    RecordProperty("configurations", std::to_string(tool_space.configurations.size()));
    EXPECT_LE(tool_space.configurations.size(), without);
    const auto interpolator = make_interpolator(Method::energy_hermite, tool_space);
    test::RandomPoints points;
    for (int i = 0; i < 20000; ++i) {
      const Vec3 t = points();
      ASSERT_LT((interpolator->evaluate(t).force - exponential(t).force).norm(), tolerance);
    }
  }
}

// At the side of a larger leaf the error is that of the larger one.
TEST(ErrorEstimate, FollowsTheErrorOfTheCells) {
  const TouchToolSpace tool_space = graded_space(exponential);
  const auto interpolator = make_interpolator(Method::energy_hermite, tool_space);
  const CellTree tree(tool_space.setup.grid, tool_space.configurations);
  const auto estimates = estimate_errors(tool_space.setup.grid, tool_space.configurations);
  ASSERT_EQ(estimates.size(), tree.leaves().size());
  std::map<Cell, double> estimate_of;
  for (const CellEstimate& e : estimates) estimate_of[e.cell] = e.error;

  const double h = tool_space.setup.grid.spacing();
  std::size_t sharp = 0;
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (const CellTree::Leaf& leaf : tree.leaves()) {
    const Cell& cell = leaf.cell;
    double estimate = 0;
    for (std::int32_t node : leaf.corners) {
      tree.for_each_leaf_around(tree.point(node), [&](std::int32_t other) {
        const Cell& neighbour = tree.leaves()[other].cell;
        if (neighbour == cell || neighbour.side > cell.side) {
          estimate = std::max(estimate, estimate_of.at(neighbour));
        }
      });
    }
    double error = 0;
    for (int i = 0; i < 200; ++i) {
      Vec3 x;
      for (int k = 0; k < 3; ++k) x[k] = cell.first[k] + cell.side * uniform(random);
      error =
          std::max(error, (interpolator->evaluate(h * x).force - exponential(h * x).force).norm());
    }
    EXPECT_LT(error, estimate);
    sharp += error > 0.02 * estimate ? 1 : 0;
  }
  EXPECT_GT(sharp, estimates.size() / 2);
}

TEST(ErrorEstimate, NothingIsSplitWhereAQuadraticEnergyIsReproduced) {
  const auto quadratic = [](const Vec3& t) {
    return test::Sample{50 * t.squaredNorm(), 100 * t, 100 * Mat3::Identity()};
  };
  const TouchToolSpace five = analytic_space(quadratic, 65, 16);
  EXPECT_TRUE(cells_to_split(five.setup.grid, five.configurations, 1e-9).empty());
  // Three check-points in a row are too few to tell.
  const TouchToolSpace three = analytic_space(quadratic, 33, 16);
  EXPECT_EQ(cells_to_split(three.setup.grid, three.configurations, 1e-9).size(), 8U);
  for (const CellEstimate& e : estimate_errors(three.setup.grid, three.configurations)) {
    EXPECT_TRUE(std::isinf(e.error));
  }
}

TEST(ErrorEstimate, RefinementEndsWhereBranchesCross) {
  const double force = largest_force(two_branches);
  for (double relative : {0.01, 0.003}) {
    const TouchToolSpace tool_space = refined(two_branches, relative * force);
    EXPECT_LT(tool_space.configurations.size(), 3000U);
    const CellTree tree(tool_space.setup.grid, tool_space.configurations);
    int crossing = 0;
    int marked = 0;
    const auto estimates = estimate_errors(tool_space.setup.grid, tool_space.configurations);
    for (const CellEstimate& e : estimates) {
      EXPECT_GE(e.cell.side, 64 / kMarkedEdge);
      bool near = false;
      bool far = false;
      for (int corner = 0; corner < 8; ++corner) {
        Vec3 x;
        for (int k = 0; k < 3; ++k) x[k] = e.cell.first[k] + ((corner >> k) & 1) * e.cell.side;
        const double smooth = 0.5 * (x / 64).squaredNorm();
        (two_branches(tool_space.setup.grid.spacing() * x).energy > smooth + 1e-9 ? far : near) =
            true;
      }
      if (!near || !far || e.cell.side > 64 / kMarkedEdge) continue;
      ++crossing;
      marked += e.marked;
    }
    EXPECT_GT(crossing, 100);
    EXPECT_GT(marked, 0.9 * crossing);
  }
}

// A leaf that is left is not split for its error, and nothing is split on its account.
TEST(ErrorEstimate, WhatIsLeftMakesNobodySplit) {
  TouchToolSpace tool_space = analytic_space(wall, 129, 16);
  const Grid& grid = tool_space.setup.grid;
  const double tolerance = 1e-4 * largest_force(wall);
  const std::vector<Cell> cells = cells_to_split(grid, tool_space.configurations, tolerance);
  ASSERT_GT(cells.size(), 1U);
  for (const Cell& cell : cells) test::split(tool_space, wall, cell);
  const auto plan = [&](const std::function<bool(const CellEstimate&)>& is_left) {
    return plan_refinement(grid, tool_space.configurations, tolerance, 1, {}, is_left).to_split;
  };
  const std::vector<Cell> all = plan({});
  ASSERT_GT(all.size(), 2U);
  EXPECT_TRUE(plan([](const CellEstimate&) { return true; }).empty());
  const std::vector<Cell> one = plan([&](const CellEstimate& e) { return !(e.cell == all[0]); });
  EXPECT_LT(one.size(), all.size());
  EXPECT_TRUE(std::includes(all.begin(), all.end(), one.begin(), one.end()));
  EXPECT_FALSE(one.empty());
}

TEST(ErrorEstimate, MarkedAndFailedCornersAreRefinedToAQuarter) {
  const auto bad = [](const Vec3& t) { return t.x() > 0.6 * kHalfWidth; };
  for (bool failed : {false, true}) {
    TouchToolSpace tool_space = analytic_space(wall, 129, 64);
    std::vector<Cell> cells;
    for (int round = 0; round < 20; ++round) {
      for (ConfigurationSummary& c : tool_space.configurations) {
        if (!bad(c.t)) continue;
        if (failed) c.outcome = Outcome::not_converged;
        if (!failed) c.flags = flags::inverted;
      }
      cells = cells_to_split(tool_space.setup.grid, tool_space.configurations,
                             0.0003 * largest_force(wall));
      for (const Cell& cell : cells) test::split(tool_space, wall, cell);
      if (cells.empty()) break;
    }
    EXPECT_TRUE(cells.empty());
    std::int32_t least_marked = 64;
    std::int32_t least = 64;
    for (const CellEstimate& e :
         estimate_errors(tool_space.setup.grid, tool_space.configurations)) {
      const bool all_bad = tool_space.setup.grid.spacing() * e.cell.first[0] > 0.6 * kHalfWidth;
      least = std::min(least, e.cell.side);
      if (all_bad) {
        EXPECT_TRUE(e.marked);
        least_marked = std::min(least_marked, e.cell.side);
      }
    }
    // What keeps neighbours within twice the size may go further.
    EXPECT_GE(least_marked, 64 / kMarkedCorner / 2);
    EXPECT_LE(least, 8);
  }
}

TEST(ErrorEstimate, WhatIsMarkedThroughoutIsLeft) {
  for (bool failed : {false, true}) {
    TouchToolSpace tool_space = analytic_space(wall, 257, 64);
    std::vector<Cell> cells;
    for (int round = 0; round < 20; ++round) {
      for (ConfigurationSummary& c : tool_space.configurations) {
        if (c.check_point[0] < 0) continue;
        if (failed) c.outcome = Outcome::not_converged;
        if (!failed) c.flags = flags::unstable;
      }
      cells = cells_to_split(tool_space.setup.grid, tool_space.configurations,
                             1e-4 * largest_force(wall));
      for (const Cell& cell : cells) test::split(tool_space, wall, cell);
      if (cells.empty()) break;
    }
    EXPECT_TRUE(cells.empty());
    std::int32_t least_at_border = 64;
    const CellTree tree(tool_space.setup.grid, tool_space.configurations);
    for (const CellTree::Leaf& leaf : tree.leaves()) {
      const std::int32_t x = leaf.cell.first[0];
      if (x + leaf.cell.side == 0) least_at_border = std::min(least_at_border, leaf.cell.side);
      // Nothing but what keeps neighbours within twice the size.
      if (x >= 64) {
        EXPECT_EQ(leaf.cell.side, 64);
      }
    }
    // The estimate is over the tolerance on both sides of x = 0.
    EXPECT_LE(least_at_border, 64 / kMarkedCorner);
  }
}

TEST(ErrorEstimate, LeavesBeyondTheForceLimitOrWithoutConfigurationsAreLeft) {
  TouchToolSpace tool_space = analytic_space(wall, 33, 16);
  for (ConfigurationSummary& c : tool_space.configurations) {
    if (c.check_point[0] >= 0) c.flags = flags::beyond_force_limit;
  }
  std::vector<Cell> cells = cells_to_split(tool_space.setup.grid, tool_space.configurations, 1e-3);
  EXPECT_EQ(cells.size(), 4U);
  for (const Cell& cell : cells) EXPECT_EQ(cell.first[0], -16);
  const auto last = tool_space.configurations.begin();
  ASSERT_EQ(last->check_point, (CheckPoint{-16, -16, -16}));
  tool_space.configurations.erase(last);
  cells = cells_to_split(tool_space.setup.grid, tool_space.configurations, 1e-3);
  EXPECT_EQ(cells.size(), 3U);
  for (ConfigurationSummary& c : tool_space.configurations) c.outcome = Outcome::aborted;
  EXPECT_TRUE(cells_to_split(tool_space.setup.grid, tool_space.configurations, 1e-3).empty());
  tool_space.configurations.clear();
  EXPECT_TRUE(cells_to_split(tool_space.setup.grid, tool_space.configurations, 1e-3).empty());
}

TEST(ErrorEstimate, SmallestSide) {
  const TouchToolSpace tool_space = refined(wall, 1e-4 * largest_force(wall), 16);
  const CellTree tree(tool_space.setup.grid, tool_space.configurations);
  for (const CellTree::Leaf& leaf : tree.leaves()) {
    EXPECT_GE(leaf.cell.side, 16);
  }
  const TouchToolSpace uniform = analytic_space(wall, 7);
  EXPECT_TRUE(cells_to_split(uniform.setup.grid, uniform.configurations, 1e-9).empty());
  const TouchToolSpace rest = analytic_space(wall, 1);
  EXPECT_TRUE(cells_to_split(rest.setup.grid, rest.configurations, 1e-9).empty());
  EXPECT_TRUE(estimate_errors(rest.setup.grid, rest.configurations).empty());
}

TEST(ErrorEstimate, RefusesATolerance) {
  const TouchToolSpace tool_space = analytic_space(wall, 5, 2);
  for (double tolerance : {0.0, -1.0, std::nan("")}) {
    EXPECT_THROW((void)cells_to_split(tool_space.setup.grid, tool_space.configurations, tolerance),
                 InputError);
  }
}

TEST(PointsOfSplit, AreThoseThatTheCornersLeave) {
  const std::vector<CheckPoint> points = points_of_split({{-4, 0, 8}, 4});
  ASSERT_EQ(points.size(), 19U);
  EXPECT_TRUE(std::is_sorted(points.begin(), points.end()));
  EXPECT_EQ(points.front(), (CheckPoint{-4, 0, 10}));
  EXPECT_EQ(points[9], (CheckPoint{-2, 2, 10}));
  const std::set<CheckPoint> all(points.begin(), points.end());
  EXPECT_EQ(all.size(), 19U);
  EXPECT_EQ(all.count({0, 4, 12}), 0U);
}

}  // namespace
}  // namespace palpate::test::test_error_estimate
