// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/surface_tree.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "base/error.h"
#include "solvers/support/surfaces.h"

namespace palpate::test::test_surface_tree {
namespace {

const Vec3 kBox(0.08, 0.08, 0.04);

SurfaceTree box_tree() {
  const test::Surface box = test::box_surface(kBox, {4, 4, 4});
  return {box.points, box.triangles};
}

/// Distance to the surface of the box, negative inside.
double distance_to_box(const Vec3& p) {
  const Vec3 q = (p - kBox / 2).cwiseAbs() - kBox / 2;
  return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0);
}

class Points {
 public:
  Vec3 operator()() {
    Vec3 p;
    for (int k = 0; k < 3; ++k) p[k] = kBox[k] * (-0.5 + 2 * uniform_(random_));
    return p;
  }

 private:
  std::mt19937 random_{3};
  std::uniform_real_distribution<double> uniform_{0, 1};
};

TEST(SurfaceTree, DistanceAndSignAreThoseOfTheBox) {
  const SurfaceTree tree = box_tree();
  Points points;
  Index hint = -1;
  for (int i = 0; i < 20000; ++i) {
    const Vec3 p = points();
    const SurfaceTree::Nearest nearest = tree.nearest(p, hint);
    ASSERT_GE(nearest.triangle, 0);
    ASSERT_NEAR(nearest.distance, distance_to_box(p), 1e-15) << p.transpose();
    ASSERT_NEAR((p - nearest.point).norm(), std::abs(nearest.distance), 1e-15);
    ASSERT_NEAR(nearest.normal.norm(), 1, 1e-14);
    ASSERT_NEAR(nearest.weights.sum(), 1, 1e-14);
    ASSERT_GE(nearest.weights.minCoeff(), 0);
    hint = nearest.triangle;
  }
}

// At corners and edges the normal of a face alone tells inside from outside wrongly.
TEST(SurfaceTree, SignAtCornersAndEdgesOfAPeak) {
  test::Surface peak;  // a needle of a tetrahedron
  peak.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.1, 0.1, 20}};
  peak.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  const SurfaceTree tree(peak.points, peak.triangles);
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  for (const Vec3& corner : peak.points) {
    for (int i = 0; i < 2000; ++i) {
      const Vec3 p = corner + 0.01 * Vec3(normal(random), normal(random), normal(random));
      // Inside is where all faces have it below them.
      bool inside = true;
      for (const auto& [a, b, c] : peak.triangles) {
        const Vec3& o = peak.points[a];
        inside &= (peak.points[b] - o).cross(peak.points[c] - o).dot(p - o) < 0;
      }
      ASSERT_EQ(tree.nearest(p).distance < 0, inside) << p.transpose();
    }
  }
}

TEST(SurfaceTree, AHintChangesNothing) {
  const SurfaceTree tree = box_tree();
  Points points;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 p = points();
    const double distance = tree.nearest(p).distance;
    ASSERT_EQ(tree.nearest(p, i % tree.num_triangles()).distance, distance);
    ASSERT_EQ(tree.nearest(p, 1 << 20).distance, distance);
  }
}

TEST(SurfaceTree, PlacesThatAreNone) {
  const SurfaceTree tree = box_tree();
  EXPECT_EQ(tree.nearest(Vec3::Constant(std::nan(""))).triangle, -1);
  EXPECT_EQ(tree.nearest(Vec3(0, std::numeric_limits<double>::infinity(), 0)).triangle, -1);
  EXPECT_EQ(tree.nearest(Vec3::Constant(1e300)).triangle, -1);
  const SurfaceTree::Nearest far = tree.nearest(Vec3(0.04, 0.04, 1e6));
  EXPECT_NEAR(far.distance, 1e6, 1);
}

TEST(SurfaceTree, BadSurfaces) {
  EXPECT_THROW((SurfaceTree{{}, {}}), InputError);
  test::Surface surface = test::box_surface(kBox, {1, 1, 1});
  surface.points[3][1] = std::nan("");
  EXPECT_THROW((SurfaceTree{surface.points, surface.triangles}), InputError);
}

}  // namespace
}  // namespace palpate::test::test_surface_tree
