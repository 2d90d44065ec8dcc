// SPDX-License-Identifier: BSD-3-Clause
#include "assembly/node_levels.h"

#include <gtest/gtest.h>

#include "assembly/assembly.h"
#include "solvers/support/block.h"

namespace palpate::test::test_node_levels {
namespace {

TEST(NodeLevels, AMidsideNodeLiesBetweenItsParents) {
  Scene scene = make_block(Law::neo_hookean).scene;
  std::fill(scene.body.fixed.begin(), scene.body.fixed.end(), 0);
  const Assembly assembly(scene);
  const NodeLevels levels = make_node_levels(scene.body.mesh, assembly.unknown_of_point());
  ASSERT_EQ(levels.num_nodes(), scene.body.mesh.num_points());
  Index num_corners = 0;
  for (Index p = 0; p < scene.body.mesh.num_points(); ++p) {
    const auto [a, b] = levels.parents[assembly.unknown_of_point()[p] / 3];
    ASSERT_GE(a, 0);
    ASSERT_GE(b, 0);
    num_corners += a == b ? 1 : 0;
    EXPECT_LT(((levels.corners[a] + levels.corners[b]) / 2 - scene.body.mesh.points[p]).norm(),
              1e-15);
  }
  EXPECT_EQ(num_corners, levels.num_corners());
}

TEST(NodeLevels, PointsThatAreHeldAreNoParents) {
  const Scene scene = make_block(Law::neo_hookean).scene;
  const Assembly assembly(scene);
  const NodeLevels levels = make_node_levels(scene.body.mesh, assembly.unknown_of_point());
  EXPECT_EQ(3 * levels.num_nodes(), assembly.pattern().size);
  bool has_half = false;
  for (const auto& [a, b] : levels.parents) has_half = has_half || (a < 0) != (b < 0);
  EXPECT_TRUE(has_half) << "some edge goes from a held corner to a free one";
  for (Index c = 0; c < levels.num_corners(); ++c) {
    EXPECT_GT(levels.corners[c].x(), 0) << "the block is held at x = 0";
    EXPECT_EQ(levels.parents[levels.node_of_corner[c]], (std::array<Index, 2>{c, c}));
  }
}

TEST(NodeLevels, AllNodesOfTet4AreCorners) {
  BlockOptions options;
  options.order = ElementOrder::linear;
  const Scene scene = make_block(Law::neo_hookean, options).scene;
  const Assembly assembly(scene);
  const NodeLevels levels = make_node_levels(scene.body.mesh, assembly.unknown_of_point());
  EXPECT_EQ(levels.num_corners(), levels.num_nodes());
  EXPECT_EQ(3 * levels.num_nodes(), assembly.pattern().size);
}

TEST(NodeLevels, WhatAToolHoldsIsTakenOut) {
  const Scene scene = make_block(Law::neo_hookean).scene;
  const Assembly assembly(scene);
  const NodeLevels all = make_node_levels(scene.body.mesh, assembly.unknown_of_point());
  std::vector<char> held(all.num_nodes(), 0);
  held[all.node_of_corner[1]] = 1;
  const NodeLevels levels = without(all, held);
  EXPECT_EQ(levels.num_nodes(), all.num_nodes());
  EXPECT_EQ(levels.num_corners(), all.num_corners() - 1);
  const auto number = [](Index corner) {
    return corner <= 1 ? (corner == 1 ? -1 : corner) : corner - 1;
  };
  for (Index node = 0; node < levels.num_nodes(); ++node) {
    const auto& [a, b] = all.parents[node];
    EXPECT_EQ(levels.parents[node], (std::array<Index, 2>{number(a), number(b)}));
  }
  std::fill(held.begin(), held.end(), 1);
  EXPECT_EQ(without(all, held).num_corners(), 0);
}

}  // namespace
}  // namespace palpate::test::test_node_levels
