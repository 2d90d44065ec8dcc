// SPDX-License-Identifier: BSD-3-Clause
#include "iterative/aggregation.h"

#include <gtest/gtest.h>

#include <set>

#include "iterative/smoothed_aggregation.h"
#include "solvers/iterative/tangents.h"

namespace palpate::test::test_aggregation {
namespace {

/// Of sums of a few hundred values, relative to the largest.
constexpr double kRounding = 1e-12;

template <int R, int C>
Eigen::MatrixXd dense_of(const BlockRows<R, C>& rows) {
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(R * rows.num_rows(), C * rows.num_columns);
  for (Index row = 0; row < rows.num_rows(); ++row) {
    for (Index k = rows.start[row]; k < rows.start[row + 1]; ++k) {
      matrix.block<R, C>(R * row, C * rows.column[k]) = rows.block[k];
    }
  }
  return matrix;
}

/// A body of Tet4, all of whose nodes are corners.
struct Level {
  Tangent tangent;
  BlockRows<3, 3> rows;

  explicit Level(const Scene& scene) : tangent(tangent_of(scene)) {
    rows = all_blocks(*tangent.pattern, find_neighbourhoods(*tangent.pattern), tangent.values);
  }
};

Scene linear_scene() { return block_scene(ElementOrder::linear, {7, 5, 5}); }

TEST(Aggregation, AllBlocksAreTheMatrix) {
  const Level level(linear_scene());
  EXPECT_EQ(dense_of(level.rows), level.tangent.matrix());
}

TEST(Aggregation, EveryNodeIsInOneAggregateOfNeighbours) {
  const Level level(linear_scene());
  const Aggregates aggregates = aggregate(level.rows, 0.02);
  ASSERT_EQ(aggregates.of_node.size(), static_cast<std::size_t>(level.rows.num_rows()));
  std::vector<std::set<Index>> members(aggregates.count);
  for (Index node = 0; node < level.rows.num_rows(); ++node) {
    ASSERT_GE(aggregates.of_node[node], 0);
    ASSERT_LT(aggregates.of_node[node], aggregates.count);
    members[aggregates.of_node[node]].insert(node);
  }
  for (const std::set<Index>& of : members) {
    ASSERT_FALSE(of.empty());
    // From any member all are reached through members.
    std::set<Index> reached{*of.begin()};
    for (std::size_t before = 0; before != reached.size();) {
      before = reached.size();
      for (Index node : std::set<Index>(reached)) {
        for (Index k = level.rows.start[node]; k < level.rows.start[node + 1]; ++k) {
          if (of.count(level.rows.column[k]) != 0) reached.insert(level.rows.column[k]);
        }
      }
    }
    EXPECT_EQ(reached, of);
  }
  EXPECT_LT(aggregates.count, level.rows.num_rows() / 4);
}

TEST(Aggregation, NodesThatAreNotCoupledStayAlone) {
  BlockRows<3, 3> matrix;
  matrix.num_columns = 4;
  for (Index node = 0; node < 4; ++node) {
    matrix.column.push_back(node);
    matrix.block.push_back(Mat3::Identity());
    matrix.start.push_back(node + 1);
  }
  EXPECT_EQ(aggregate(matrix, 0.02).count, 4);
}

TEST(Aggregation, TheProlongationHasTheMotionsExactly) {
  const Level level(floating(linear_scene()));
  const Aggregates aggregates = aggregate(level.rows, 0.02);
  Motions<6> coarse;
  const Motions<3> motions = rigid_motions(level.tangent.levels.corners);
  const BlockRows<3, 6> tentative = tentative_prolongation(aggregates, motions, coarse);
  const Eigen::MatrixXd p = dense_of(tentative);
  EXPECT_LT((p.transpose() * p - Eigen::MatrixXd::Identity(p.cols(), p.cols())).norm(), kRounding);
  Eigen::MatrixXd fine_motions(p.rows(), 6);
  for (std::size_t i = 0; i < motions.size(); ++i) fine_motions.middleRows<3>(3 * i) = motions[i];
  Eigen::MatrixXd coarse_motions(p.cols(), 6);
  for (std::size_t i = 0; i < coarse.size(); ++i) coarse_motions.middleRows<6>(6 * i) = coarse[i];
  EXPECT_LT((p * coarse_motions - fine_motions).norm(), kRounding * fine_motions.norm());

  // A floating body has no stiffness against them, so that smoothing leaves them and the coarse
  // matrix has none either.
  std::vector<Mat3> inverse(level.rows.num_rows());
  const Eigen::MatrixXd matrix = level.tangent.matrix();
  Eigen::MatrixXd inverse_diagonal = Eigen::MatrixXd::Zero(matrix.rows(), matrix.cols());
  for (Index node = 0; node < level.rows.num_rows(); ++node) {
    inverse[node] = matrix.block<3, 3>(3 * node, 3 * node).inverse();
    inverse_diagonal.block<3, 3>(3 * node, 3 * node) = inverse[node];
  }
  const BlockRows<3, 6> smoothed = smoothed_prolongation(level.rows, inverse, 0.6, tentative);
  const Eigen::MatrixXd s = dense_of(smoothed);
  EXPECT_LT((s - (p - 0.6 * inverse_diagonal * matrix * p)).norm(), kRounding * p.norm());
  EXPECT_LT((s * coarse_motions - fine_motions).norm(), kRounding * fine_motions.norm());

  const BlockRows<6, 6> next = coarse_matrix(level.rows, smoothed);
  const Eigen::MatrixXd expected = s.transpose() * matrix * s;
  EXPECT_LT((dense_of(next) - expected).norm(), kRounding * expected.norm());
  EXPECT_LT((dense_of(next) * coarse_motions).norm(), kRounding * expected.norm());
  EXPECT_EQ(kernel_size(dense_of(next)), 6);

  // The same once more, from a level of aggregates.
  Aggregates pairs;
  for (Index a = 0; a < aggregates.count; ++a) pairs.of_node.push_back(a / 2);
  pairs.count = (aggregates.count + 1) / 2;
  Motions<6> last;
  const Eigen::MatrixXd q = dense_of(tentative_prolongation(pairs, coarse, last));
  Eigen::MatrixXd last_motions(q.cols(), 6);
  for (std::size_t i = 0; i < last.size(); ++i) last_motions.middleRows<6>(6 * i) = last[i];
  EXPECT_LT((q * last_motions - coarse_motions).norm(), kRounding * coarse_motions.norm());
}

// Two nodes do not turn about the line through them, and one does not turn at all.
TEST(Aggregation, MotionsThatAnAggregateDoesNotHaveAreZero) {
  Aggregates aggregates;
  aggregates.count = 2;
  aggregates.of_node = {0, 1, 1};
  Motions<6> coarse;
  const Eigen::MatrixXd p = dense_of(tentative_prolongation(
      aggregates, rigid_motions({Vec3(0, 0, 0), Vec3(1, 2, 3), Vec3(2, 0, 1)}), coarse));
  EXPECT_EQ(p.cols() - kernel_size(p), 3 + 5);
  const Eigen::VectorXd lengths = p.colwise().norm();
  EXPECT_EQ((lengths.array() == 0).count(), 3 + 1);
  EXPECT_EQ(((lengths.array() - 1).abs() < kRounding).count(), 3 + 5);

  BlockRows<3, 3> matrix;
  matrix.num_columns = 3;
  for (Index node = 0; node < 3; ++node) {
    matrix.column.push_back(node);
    matrix.block.push_back(2 * Mat3::Identity());
    matrix.start.push_back(node + 1);
  }
  Motions<6> unused;
  const BlockRows<6, 6> next = coarse_matrix(
      matrix,
      tentative_prolongation(aggregates,
                             rigid_motions({Vec3(0, 0, 0), Vec3(1, 2, 3), Vec3(2, 0, 1)}), unused));
  EXPECT_GT(dense_of(next).diagonal().minCoeff(), 0) << "so that it can be inverted";
}

TEST(Aggregation, LevelsBecomeSmallFast) {
  const Tangent tangent = tangent_of(block_scene(ElementOrder::linear, {24, 16, 16}));
  AggregationCycle cycle(tangent.pattern, tangent.levels.corners);
  ASSERT_EQ(cycle.refresh(tangent.values, 1).status, SetupStatus::ok);
  const std::vector<Index> sizes = cycle.level_sizes();
  ASSERT_GE(sizes.size(), 3U);
  EXPECT_EQ(sizes.front(), tangent.levels.num_nodes());
  for (std::size_t i = 1; i < sizes.size(); ++i) EXPECT_LT(sizes[i], sizes[i - 1] / 5);
  EXPECT_LE(sizes.back(), 100);
}

}  // namespace
}  // namespace palpate::test::test_aggregation
