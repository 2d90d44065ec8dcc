// SPDX-License-Identifier: BSD-3-Clause
// A grid that takes chunks is the grid that is made of all of them at once.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>
#include <random>

#include "interpolation/check_point_grid.h"
#include "interpolation/clearance.h"
#include "interpolation/hermite_data.h"
#include "solvers/interpolation/analytic_space.h"
#include "solvers/interpolation/contact_space.h"

namespace palpate::test::test_growing_grid {
namespace {

using HangingNode = CheckPointGrid::HangingNode;

void expect_same_hanging_nodes(const CheckPointGrid& a, const std::vector<HangingNode>& of_a,
                               const CheckPointGrid& b, const std::vector<HangingNode>& of_b) {
  ASSERT_EQ(of_a.size(), of_b.size());
  for (std::size_t i = 0; i < of_a.size(); ++i) {
    EXPECT_EQ(of_a[i].node, of_b[i].node);
    EXPECT_EQ(a.leaf(of_a[i].leaf).cell, b.leaf(of_b[i].leaf).cell);
    EXPECT_EQ(of_a[i].s, of_b[i].s);
  }
}

/// But for the order of the leaves.
void expect_same(const CheckPointGrid& a, const CheckPointGrid& b) {
  ASSERT_EQ(a.num_nodes(), b.num_nodes());
  for (std::int32_t n = 0; n < a.num_nodes(); ++n) {
    EXPECT_EQ(a.tree().point(n), b.tree().point(n));
    EXPECT_EQ(a.configuration(n), b.configuration(n));
    EXPECT_EQ(a.is_free(n), b.is_free(n));
    EXPECT_EQ(a.is_marking(n), b.is_marking(n));
    EXPECT_EQ(a.nearest(n), b.nearest(n));
  }
  ASSERT_EQ(a.tree().leaves().size(), b.tree().leaves().size());
  std::map<Cell, std::int32_t> leaf_of_b;
  for (std::size_t l = 0; l < b.tree().leaves().size(); ++l) {
    leaf_of_b[b.tree().leaves()[l].cell] = static_cast<std::int32_t>(l);
  }
  for (std::size_t l = 0; l < a.tree().leaves().size(); ++l) {
    const auto here = static_cast<std::int32_t>(l);
    const auto found = leaf_of_b.find(a.leaf(here).cell);
    ASSERT_NE(found, leaf_of_b.end());
    const std::int32_t there = found->second;
    EXPECT_EQ(a.leaf(here).corners, b.leaf(there).corners);
    EXPECT_EQ(a.is_proved_free(here), b.is_proved_free(there));
    EXPECT_EQ(a.is_zero(here), b.is_zero(there));
    EXPECT_EQ(a.is_complete(here), b.is_complete(there));
    EXPECT_EQ(a.is_marked(here), b.is_marked(there));
    EXPECT_EQ(a.is_unknown(here), b.is_unknown(there));
    EXPECT_EQ(a.is_across(here), b.is_across(there));
  }
  EXPECT_EQ(a.any_usable(), b.any_usable());
  EXPECT_EQ(a.has_extrapolated_nodes(), b.has_extrapolated_nodes());
  expect_same_hanging_nodes(a, a.hanging_nodes(), b, b.hanging_nodes());
  expect_same_hanging_nodes(a, a.hanging_on_complete(), b, b.hanging_on_complete());
}

/// To the bit.
void expect_same_data(const std::vector<HermiteNode>& a, const std::vector<HermiteNode>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t n = 0; n < a.size(); ++n) {
    EXPECT_EQ(std::memcmp(a[n].of, b[n].of, 27 * sizeof(double)), 0) << "node " << n;
  }
}

/// Places in the box and around it.
void expect_same_places(const CheckPointGrid& a, const CheckPointGrid& b, const Grid& grid) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> coordinate(-1.1 * grid.half_width, 1.1 * grid.half_width);
  for (int i = 0; i < 300; ++i) {
    const Vec3 t = grid.origin + Vec3(coordinate(random), coordinate(random), coordinate(random));
    const auto of_a = a.locate(t);
    const auto of_b = b.locate(t);
    EXPECT_EQ(of_a.place, of_b.place);
    EXPECT_EQ(of_a.support, of_b.support);
    EXPECT_EQ(of_a.s, of_b.s);
    EXPECT_EQ(of_a.x, of_b.x);
    EXPECT_EQ(of_a.offset, of_b.offset);
    if (of_a.place == CheckPointGrid::Place::cell ||
        of_a.place == CheckPointGrid::Place::beside_cell) {
      EXPECT_EQ(a.leaf(of_a.leaf).cell, b.leaf(of_b.leaf).cell);
    }
  }
}

/// Takes a space chunk by chunk, the nearest to a hand that moves first.
void expect_grows(const TouchToolSpace& whole, std::size_t chunk) {
  std::vector<ConfigurationSummary> left = whole.configurations;
  TouchToolSpace grown = whole;
  grown.configurations.clear();
  std::optional<CheckPointGrid> grid;
  std::vector<HermiteNode> data;
  HermiteMemory memory;
  for (int number = 0; !left.empty(); ++number) {
    const Vec3 hand = whole.setup.grid.half_width * Vec3(std::sin(number), std::cos(number), 0.3);
    std::sort(left.begin(), left.end(), [&](const auto& a, const auto& b) {
      return (a.t - hand).squaredNorm() > (b.t - hand).squaredNorm();
    });
    std::vector<CheckPoint> changed;
    for (std::size_t i = 0; i < chunk && !left.empty(); ++i) {
      changed.push_back(left.back().check_point);
      grown.configurations.push_back(left.back());
      left.pop_back();
    }
    std::sort(grown.configurations.begin(), grown.configurations.end());
    if (grid) {
      CellTree::Growth growth;
      grid.emplace(CheckPointGrid(*grid, grown, changed, growth));
      HermiteMemory now;
      const HermiteBefore before{growth, data, memory};
      data = hermite_data(*grid, grown.configurations, {}, &before, &now);
      memory = std::move(now);
    } else {
      grid.emplace(grown);
      data = hermite_data(*grid, grown.configurations, {}, nullptr, &memory);
    }
    const CheckPointGrid anew(grown);
    expect_same_data(data, hermite_data(anew, grown.configurations));
    expect_same(*grid, anew);
    expect_same_places(*grid, anew, whole.setup.grid);
    if (testing::Test::HasFailure()) FAIL() << "chunk " << number;
  }
}

/// Some of a space's configurations are marked, some are singular or nearly so, which changes when
/// larger forces are found elsewhere, and some failed.
TouchToolSpace with_failures(TouchToolSpace space) {
  std::mt19937 random(5);
  for (ConfigurationSummary& c : space.configurations) {
    const auto number = random() % 40;
    if (number == 0) c.outcome = Outcome::not_converged;
    if (number == 1) c.flags |= flags::unstable;
    if (number < 6) c.stiffness *= static_cast<double>(1 << number);
  }
  return space;
}

/// A body of which a tool presses the whole, with cells of several sizes.
TouchToolSpace pressed_body() {
  const ContactExample contact = ellipsoid(Vec3(0.001, 0.0007, -0.0003), Vec3(0.05, 0.035, 0.03));
  Grid grid;
  grid.sparse = true;
  grid.half_width = 0.064;
  grid.resolution = 65;
  grid.coarsest = 4;
  TouchToolSpace space = contact_space(contact, grid, 0.012);
  const std::vector<Cell> cells =
      cells_to_split(grid, space.configurations, 0.3, 1, space.clearance);
  EXPECT_GT(cells.size(), 10u);
  split(space, contact, cells);
  return space;
}

TEST(GrowingGrid, AClearanceIsAskedOnceAtAPlace) {
  int num_asked = 0;
  const Clearance clearance = remembering([&](const Vec3& q) {
    ++num_asked;
    return q.norm() - 1;
  });
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(clearance(Vec3(0, 3, 4)), 4);
    EXPECT_EQ(clearance(Vec3(0, 0, 4)), 3);
  }
  EXPECT_EQ(num_asked, 2);
}

TEST(GrowingGrid, OfABoxWithUniformCells) { expect_grows(analytic_space(exponential), 40); }

TEST(GrowingGrid, OfABoxWithCellsOfSeveralSizes) {
  expect_grows(graded_space(exponential), 150);
  expect_grows(unbalanced_space(exponential), 50);
}

TEST(GrowingGrid, WithConfigurationsThatFailed) {
  expect_grows(with_failures(graded_space(exponential)), 150);
}

TEST(GrowingGrid, AroundABody) {
  expect_grows(pressed_body(), 300);
  expect_grows(with_failures(pressed_body()), 300);
}

}  // namespace
}  // namespace palpate::test::test_growing_grid
