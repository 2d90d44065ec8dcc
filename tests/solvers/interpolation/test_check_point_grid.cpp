// SPDX-License-Identifier: BSD-3-Clause
#include "interpolation/check_point_grid.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <limits>

#include "base/error.h"
#include "solvers/interpolation/analytic_space.h"

namespace palpate::test::test_check_point_grid {
namespace {

using test::analytic_space;
using test::at;
using test::exponential;
using Place = CheckPointGrid::Place;

TEST(CheckPointGrid, LocatesWithinTheBoxAndOnItsBorder) {
  const TouchToolSpace tool_space = analytic_space(exponential);
  const CheckPointGrid grid(tool_space);
  const double h = grid.spacing();
  const auto inside = grid.locate(h * Vec3(0.25, -1.5, 2.75));
  EXPECT_EQ(inside.place, Place::cell);
  EXPECT_EQ(grid.leaf(inside.leaf).cell, (Cell{{0, -2, 2}, 1}));
  EXPECT_LT((inside.s - Vec3(0.25, 0.5, 0.75)).norm(), 1e-12);
  EXPECT_TRUE(inside.offset.isZero(0));
  for (const ConfigurationSummary& c : tool_space.configurations) {
    EXPECT_EQ(grid.locate(c.t).place, Place::cell);
  }
  const auto outside = grid.locate(h * Vec3(0.25, -4, 3.5));
  EXPECT_EQ(outside.place, Place::beside_cell);
  EXPECT_LT((outside.offset - h * Vec3(0, -1, 0.5)).norm(), 1e-15);
  EXPECT_LT((outside.x - Vec3(0.25, -3, 3)).norm(), 1e-14);
  EXPECT_EQ(outside.s, Vec3(outside.s.x(), 0, 1));
}

TEST(CheckPointGrid, NodesThatAreNotUsableKnowTheNearestThatIs) {
  TouchToolSpace tool_space = analytic_space(exponential);
  EXPECT_FALSE(CheckPointGrid(tool_space).has_extrapolated_nodes());
  at(tool_space, {1, 1, 1}).outcome = Outcome::not_converged;
  at(tool_space, {0, 0, 2}).stiffness(1, 1) = std::numeric_limits<double>::quiet_NaN();
  for (ConfigurationSummary& c : tool_space.configurations) {
    if (c.check_point[2] == -3) c.outcome = Outcome::not_converged;
  }
  const CheckPointGrid grid(tool_space);
  EXPECT_TRUE(grid.has_extrapolated_nodes());
  for (std::int32_t n = 0; n < grid.num_nodes(); ++n) {
    const CheckPoint p = grid.tree().point(n);
    const CheckPoint q = grid.tree().point(grid.nearest(n));
    EXPECT_TRUE(grid.usable(grid.nearest(n)));
    if (grid.usable(n)) {
      EXPECT_EQ(p, q);
    } else if (p[2] == -3) {
      EXPECT_EQ(q, (CheckPoint{p[0], p[1], -2}));
    } else {
      EXPECT_EQ(std::abs(q[0] - p[0]) + std::abs(q[1] - p[1]) + std::abs(q[2] - p[2]), 1);
    }
  }
  const double h = grid.spacing();
  const auto beside_hole = grid.locate(h * Vec3(0.9, 0.9, 0.9));
  EXPECT_EQ(beside_hole.place, Place::cell);
  EXPECT_EQ(beside_hole.support, Support::extrapolated);
  EXPECT_FALSE(grid.is_complete(beside_hole.leaf));
  EXPECT_EQ(grid.locate(h * Vec3(-0.1, 0.9, 0.9)).support, Support::inside);
}

TEST(CheckPointGrid, MarksCells) {
  for (Flags flag : {flags::inverted, flags::unstable, flags::near_fold}) {
    TouchToolSpace tool_space = analytic_space(exponential);
    at(tool_space, {1, 1, 1}).flags = flag | flags::beyond_force_limit;
    const CheckPointGrid grid(tool_space);
    EXPECT_EQ(grid.locate(grid.spacing() * Vec3(1.9, 0.1, 0.5)).support, Support::marked);
    EXPECT_EQ(grid.locate(grid.spacing() * Vec3(2.1, 0.1, 0.5)).support, Support::inside);
  }
  TouchToolSpace tool_space = analytic_space(exponential);
  at(tool_space, {1, 1, 1}).flags = flags::beyond_force_limit | flags::inertia_not_computed;
  EXPECT_EQ(CheckPointGrid(tool_space).locate(Vec3(0.005, 0.005, 0.005)).support, Support::inside);
}

TEST(CheckPointGrid, TakesTheFirstUsableLevel) {
  TouchToolSpace tool_space = analytic_space(exponential, 3);
  ConfigurationSummary second = at(tool_space, {0, 0, 0});
  second.level = 1;
  second.energy = 77;
  const auto place = tool_space.configurations.begin() + 14;
  tool_space.configurations.insert(place, second);
  const CheckPointGrid grid(tool_space);
  EXPECT_EQ(grid.configuration(grid.tree().find({0, 0, 0})), 13);
  tool_space.configurations[13].outcome = Outcome::not_converged;
  const CheckPointGrid other(tool_space);
  EXPECT_EQ(other.configuration(other.tree().find({0, 0, 0})), 14);
}

TEST(CheckPointGrid, OneCheckPoint) {
  TouchToolSpace tool_space = analytic_space(exponential, 1);
  const CheckPointGrid grid(tool_space);
  const auto found = grid.locate(Vec3(0.01, 0, 0));
  EXPECT_EQ(found.place, Place::rest);
  EXPECT_EQ(found.support, Support::extrapolated);
  EXPECT_EQ(found.offset, Vec3(0.01, 0, 0));
  tool_space.configurations[0].outcome = Outcome::aborted;
  EXPECT_EQ(CheckPointGrid(tool_space).locate(Vec3::Zero()).place, Place::nowhere);
}

TEST(CheckPointGrid, RefusesBadGrids) {
  const TouchToolSpace good = analytic_space(exponential, 3);
  for (std::int32_t resolution : {0, -3, 2, 4, 100001}) {
    TouchToolSpace tool_space = good;
    tool_space.setup.grid.resolution = resolution;
    EXPECT_THROW((void)CheckPointGrid(tool_space), InputError) << resolution;
  }
  for (double half_width : {0.0, -0.01, std::numeric_limits<double>::quiet_NaN(),
                            std::numeric_limits<double>::infinity(), 0.011}) {
    TouchToolSpace tool_space = good;
    tool_space.setup.grid.half_width = half_width;
    EXPECT_THROW((void)CheckPointGrid(tool_space), InputError) << half_width;
  }
}

}  // namespace
}  // namespace palpate::test::test_check_point_grid
