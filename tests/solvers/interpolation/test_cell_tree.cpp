// SPDX-License-Identifier: BSD-3-Clause
#include "interpolation/cell_tree.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "interpolation/error_estimate.h"
#include "solvers/interpolation/analytic_space.h"

namespace palpate::test::test_cell_tree {
namespace {

using test::analytic_space;
using test::exponential;
using test::graded_space;

CellTree tree_of(const TouchToolSpace& tool_space) {
  return {tool_space.setup.grid, tool_space.configurations};
}

TEST(CellTree, OfAUniformGrid) {
  const CellTree tree = tree_of(analytic_space(exponential, 7));
  EXPECT_EQ(tree.num_nodes(), 343);
  EXPECT_EQ(tree.leaves().size(), 216U);
  EXPECT_EQ(tree.find({-3, -3, -3}), 0);
  EXPECT_EQ(tree.find({-3, -3, -2}), 1);
  EXPECT_EQ(tree.find({0, 0, 0}), 171);
  EXPECT_EQ(tree.find({4, 0, 0}), -1);
  EXPECT_EQ(tree.point(342), (CheckPoint{3, 3, 3}));
  const auto place = tree.locate(Vec3(3.25, 0, 6));
  EXPECT_EQ(tree.leaves()[place.leaf].cell, (Cell{{0, -3, 2}, 1}));
  EXPECT_EQ(place.s, Vec3(0.25, 0, 1));
}

TEST(CellTree, SplitsACellThatHasAllPointsOfItsHalves) {
  const TouchToolSpace coarse = analytic_space(exponential, 9, 4);
  EXPECT_EQ(tree_of(coarse).leaves().size(), 8U);
  EXPECT_EQ(tree_of(coarse).find({2, 2, 2}), -1);
  const Cell cell{{0, -4, 0}, 4};
  TouchToolSpace tool_space = coarse;
  test::split(tool_space, exponential, cell);
  EXPECT_EQ(tree_of(tool_space).leaves().size(), 15U);
  EXPECT_EQ(tree_of(tool_space).num_nodes(), 27 + 19);
  for (const CheckPoint& p : points_of_split(cell)) {
    TouchToolSpace lacking = tool_space;
    ConfigurationSummary& c = test::at(lacking, p);
    c.outcome = Outcome::not_converged;
    EXPECT_EQ(tree_of(lacking).leaves().size(), 15U) << "it is there, usable or not";
    c.check_point = {100, 0, 0};  // off the grid
    std::sort(lacking.configurations.begin(), lacking.configurations.end());
    EXPECT_EQ(tree_of(lacking).leaves().size(), 8U);
    EXPECT_EQ(tree_of(lacking).num_nodes(), 27);
  }
}

TEST(CellTree, LeavesTileTheBoxAndAreFound) {
  const TouchToolSpace tool_space = graded_space(exponential);
  const CellTree tree = tree_of(tool_space);
  EXPECT_EQ(static_cast<std::size_t>(tree.num_nodes()), tool_space.configurations.size());
  std::int64_t volume = 0;
  std::int32_t least = 1000;
  for (const CellTree::Leaf& leaf : tree.leaves()) {
    const std::int64_t side = leaf.cell.side;
    volume += side * side * side;
    least = std::min(least, leaf.cell.side);
    for (int corner = 0; corner < 8; ++corner) {
      CheckPoint p = leaf.cell.first;
      for (int k = 0; k < 3; ++k) p[k] += ((corner >> (2 - k)) & 1) * leaf.cell.side;
      EXPECT_EQ(tree.point(leaf.corners[corner]), p);
    }
  }
  EXPECT_EQ(volume, 64 * 64 * 64);
  EXPECT_EQ(least, 1);

  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0, 64);
  for (int i = 0; i < 20000; ++i) {
    Vec3 x(uniform(random), uniform(random), uniform(random));
    for (int k = 0; k < 3; ++k) {
      if (((i >> k) & 1) != 0) x[k] = std::round(x[k]);
    }
    const CellTree::Place place = tree.locate(x);
    const Cell& cell = tree.leaves()[place.leaf].cell;
    for (int k = 0; k < 3; ++k) {
      const double first = cell.first[k] + 32;
      EXPECT_EQ(first + cell.side * place.s[k], x[k]);
      EXPECT_GE(place.s[k], 0);
      // Where leaves meet, the upper one.
      EXPECT_TRUE(place.s[k] < 1 || first + cell.side == 64);
    }
  }
}

TEST(CellTree, LeavesAroundACheckPoint) {
  const CellTree tree = tree_of(graded_space(exponential));
  for (std::int32_t node = 0; node < tree.num_nodes(); ++node) {
    const CheckPoint p = tree.point(node);
    std::vector<std::int32_t> found;
    tree.for_each_leaf_around(p, [&](std::int32_t leaf) { found.push_back(leaf); });
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    std::vector<std::int32_t> expected;
    for (std::size_t l = 0; l < tree.leaves().size(); ++l) {
      const Cell& cell = tree.leaves()[l].cell;
      bool holds = true;
      for (int k = 0; k < 3; ++k) {
        holds = holds && p[k] >= cell.first[k] && p[k] <= cell.first[k] + cell.side;
      }
      if (holds) expected.push_back(static_cast<std::int32_t>(l));
    }
    EXPECT_EQ(found, expected);
  }
}

TEST(CellTree, RestAlone) {
  const CellTree tree = tree_of(analytic_space(exponential, 1));
  EXPECT_EQ(tree.num_nodes(), 1);
  EXPECT_TRUE(tree.leaves().empty());
  EXPECT_EQ(tree.find({0, 0, 0}), 0);
}

TEST(CellTree, RefusesCellsThatDoNotTileTheBox) {
  const TouchToolSpace good = analytic_space(exponential, 9, 4);
  for (std::int32_t coarsest : {0, -1, 3, 8, 6}) {
    TouchToolSpace tool_space = good;
    tool_space.setup.grid.coarsest = coarsest;
    EXPECT_THROW((void)tree_of(tool_space), InputError) << coarsest;
  }
}

}  // namespace
}  // namespace palpate::test::test_cell_tree
