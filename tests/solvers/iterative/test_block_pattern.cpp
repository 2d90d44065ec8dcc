// SPDX-License-Identifier: BSD-3-Clause
#include "iterative/block_pattern.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "base/error.h"
#include "solvers/iterative/tangents.h"

namespace palpate::test::test_block_pattern {
namespace {

TEST(BlockPattern, IsThatOfTheScalars) {
  for (ElementOrder order : {ElementOrder::linear, ElementOrder::quadratic}) {
    const Tangent tangent = tangent_of(block_scene(order));
    const SymmetricPattern again = expanded(*tangent.pattern);
    EXPECT_EQ(again.size, tangent.scalars.size);
    EXPECT_EQ(again.column_start, tangent.scalars.column_start);
    EXPECT_EQ(again.row, tangent.scalars.row);
    EXPECT_EQ(tangent.pattern->num_values(), tangent.scalars.num_values());
  }
}

TEST(BlockPattern, BlocksAreWhereTheyBelong) {
  const Tangent tangent = tangent_of(block_scene());
  const Eigen::MatrixXd matrix = tangent.matrix();
  const BlockPattern& pattern = *tangent.pattern;
  for (Index node = 0; node < pattern.num_nodes; ++node) {
    EXPECT_EQ(diagonal_block(pattern, tangent.values, node),
              (matrix.block<3, 3>(3 * node, 3 * node)));
    for (Index k = pattern.start[node]; k < pattern.start[node + 1]; ++k) {
      EXPECT_EQ(block_at(pattern, tangent.values, node, k),
                (matrix.block<3, 3>(3 * pattern.neighbour[k], 3 * node)));
    }
  }
}

TEST(BlockPattern, NeighboursKnowOneAnother) {
  const Tangent tangent = tangent_of(block_scene());
  const Eigen::MatrixXd matrix = tangent.matrix();
  const Neighbourhoods all = find_neighbourhoods(*tangent.pattern);
  ASSERT_EQ(all.all.size(), 2U * tangent.pattern->num_blocks());
  for (Index node = 0; node < tangent.pattern->num_nodes; ++node) {
    Index before = -1;
    for (Index k = all.start[node]; k < all.start[node + 1]; ++k) {
      const auto& [other, place] = all.all[k];
      EXPECT_GT(other, before) << "they ascend";
      before = other;
      EXPECT_EQ(block_at(*tangent.pattern, tangent.values, std::min(node, other), place),
                (matrix.block<3, 3>(3 * std::max(node, other), 3 * std::min(node, other))));
    }
  }
}

TEST(BlockPattern, PressuresAreRefused) {
  Scene scene = block_scene();
  scene.organ.materials[0] = with_formulation(scene.organ.materials[0], Formulation::mixed);
  const Assembly assembly(scene);
  ASSERT_GT(assembly.num_unknown_pressures(), 0);
  try {
    (void)make_block_pattern(assembly.pattern());
    FAIL() << "was taken";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("direct solver"), std::string::npos) << error.what();
  }
}

TEST(BlockPattern, AMatrixThatIsNotOfBlocksIsRefused) {
  // Three unknowns of which two are not coupled.
  EXPECT_THROW((void)make_block_pattern({3, {0, 2, 3, 4}, {0, 1, 1, 2}}), InputError);
  EXPECT_THROW((void)make_block_pattern({2, {0, 2, 3}, {0, 1, 1}}), InputError);
  EXPECT_EQ(make_block_pattern({0, {0}, {}}).num_nodes, 0);
}

TEST(BlockPattern, KnowsWhatIsNoNumber) {
  EXPECT_TRUE(all_finite({}));
  EXPECT_TRUE(all_finite({1e308, 1e308, -3}));
  EXPECT_FALSE(all_finite({1, std::numeric_limits<double>::quiet_NaN()}));
  EXPECT_FALSE(all_finite({-std::numeric_limits<double>::infinity(), 1}));
}

}  // namespace
}  // namespace palpate::test::test_block_pattern
