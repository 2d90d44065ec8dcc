// SPDX-License-Identifier: BSD-3-Clause
#include "iterative/galerkin.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "solvers/iterative/tangents.h"

namespace palpate::test::test_galerkin {
namespace {

/// Of sums of a few hundred values, relative to the largest.
constexpr double kRounding = 1e-13;

struct Coarse {
  BlockPattern pattern;
  std::vector<double> values;
  [[nodiscard]] Eigen::MatrixXd matrix() const { return dense(expanded(pattern), values); }
};

Coarse coarse_of(const Tangent& tangent, double unit = 1) {
  check(tangent.levels, *tangent.pattern);
  Coarse coarse;
  coarse.pattern = coarse_pattern(*tangent.pattern, tangent.levels);
  galerkin_product(*tangent.pattern, tangent.levels,
                   find_galerkin_parts(*tangent.pattern, tangent.levels), tangent.values, unit,
                   coarse.pattern, find_neighbourhoods(coarse.pattern), coarse.values);
  return coarse;
}

void expect_product(const Tangent& tangent) {
  const Eigen::MatrixXd p = dense_prolongation(tangent.levels);
  const Eigen::MatrixXd expected = p.transpose() * tangent.matrix() * p;
  const Eigen::MatrixXd found = coarse_of(tangent).matrix();
  ASSERT_EQ(found.rows(), expected.rows());
  EXPECT_LT((found - expected).cwiseAbs().maxCoeff(), kRounding * expected.cwiseAbs().maxCoeff());
  EXPECT_EQ(coarse_of(tangent, 0.25).matrix(), 0.25 * found);
}

TEST(Galerkin, IsTheProduct) {
  const Scene scene = block_scene();
  expect_product(tangent_of(scene));
  expect_product(tangent_of(scene, stretched(scene, 0.6)));
  expect_product(tangent_of(floating(scene)));
  const Scene linear = block_scene(ElementOrder::linear);
  expect_product(tangent_of(linear));
}

TEST(Galerkin, OfNodesInAnyOrder) {
  // The corners of a body come before its midside nodes in most meshes, but need not.
  Scene scene = block_scene();
  const Index count = scene.body.mesh.num_points();
  const auto turned = [&](Index p) { return (11 * p + 3) % count; };
  ASSERT_NE(count % 11, 0) << "two points would have one place";
  Scene other = scene;
  for (Index p = 0; p < count; ++p) {
    other.body.mesh.points[turned(p)] = scene.body.mesh.points[p];
    other.body.fixed[turned(p)] = scene.body.fixed[p];
  }
  for (Index& p : other.body.mesh.cells) p = turned(p);
  expect_product(tangent_of(other));
}

TEST(Galerkin, NodesThatAToolHoldsHaveNoPart) {
  const Scene scene = block_scene();
  Tangent tangent = tangent_of(scene);
  std::vector<char> held(tangent.levels.num_nodes(), 0);
  for (Index node = 0; node < tangent.levels.num_nodes(); node += 5) held[node] = 1;
  tangent.levels = without(tangent.levels, held);
  expect_product(tangent);
  const Eigen::MatrixXd p = dense_prolongation(tangent.levels);
  for (Index node = 0; node < tangent.levels.num_nodes(); node += 5) {
    EXPECT_TRUE(p.middleRows<3>(3 * node).isZero(0));
  }
}

// A displacement that is linear in space is one of the corners', exactly.
TEST(Galerkin, LinearFieldsAreProlongedExactly) {
  const Scene scene = floating(block_scene());
  const Tangent tangent = tangent_of(scene);
  const Mat3 gradient = Random(65).matrix(1);
  Eigen::VectorXd corners(3 * tangent.levels.num_corners());
  for (Index c = 0; c < tangent.levels.num_corners(); ++c) {
    corners.segment<3>(3 * c) = gradient * tangent.levels.corners[c];
  }
  const Eigen::VectorXd nodes = dense_prolongation(tangent.levels) * corners;
  const Assembly assembly(scene);
  for (Index p = 0; p < scene.body.mesh.num_points(); ++p) {
    const Index unknown = assembly.unknown_of_point()[p];
    ASSERT_GE(unknown, 0);
    EXPECT_LT((nodes.segment<3>(unknown) - gradient * scene.body.mesh.points[p]).norm(), 1e-15);
  }
}

TEST(Galerkin, RigidMotionsAreInTheNullSpaceOfTheCorners) {
  const Tangent tangent = tangent_of(floating(block_scene()));
  const Eigen::MatrixXd coarse = coarse_of(tangent).matrix();
  const Eigen::MatrixXd motions = rigid_motions_of(tangent.levels.corners);
  EXPECT_LT((coarse * motions).cwiseAbs().maxCoeff(), 1e-12 * coarse.cwiseAbs().maxCoeff());
  // And nothing else is.
  EXPECT_EQ(kernel_size(coarse), 6);
}

TEST(Galerkin, LevelsOfAnotherBodyAreRefused) {
  const Tangent tangent = tangent_of(block_scene());
  const auto refused = [&](const NodeLevels& levels) {
    Tangent other = tangent;
    other.levels = levels;
    EXPECT_THROW((void)coarse_of(other), InputError);
  };
  refused(tangent_of(block_scene(ElementOrder::quadratic, {3, 3, 3})).levels);
  NodeLevels levels = tangent.levels;
  levels.parents.back() = {0, levels.num_corners()};
  refused(levels);
  levels = tangent.levels;
  std::swap(levels.node_of_corner.front(), levels.node_of_corner.back());
  refused(levels);
  levels = tangent.levels;
  levels.corners.pop_back();
  refused(levels);
  // Corners that lie far from one another have no common child.
  levels = tangent.levels;
  levels.parents.back() = {0, levels.num_corners() - 1};
  refused(levels);
}

}  // namespace
}  // namespace palpate::test::test_galerkin
