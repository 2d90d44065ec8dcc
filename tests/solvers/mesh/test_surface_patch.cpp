// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/surface_patch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "base/error.h"
#include "solvers/support/box_mesh.h"
#include "solvers/support/orders.h"

namespace palpate::test::test_surface_patch {
namespace {

Index nearest(const TetMesh& mesh, const Vec3& place) {
  const auto distance = [&](const Vec3& p) { return (p - place).norm(); };
  const auto best =
      std::min_element(mesh.points.begin(), mesh.points.end(),
                       [&](const Vec3& a, const Vec3& b) { return distance(a) < distance(b); });
  return static_cast<Index>(best - mesh.points.begin());
}

class SurfacePatch : public testing::TestWithParam<ElementOrder> {};
INSTANTIATE_TEST_SUITE_P(AnyOrder, SurfacePatch, testing::ValuesIn(kOrders), name_of_order);

TEST_P(SurfacePatch, HasThePointsOfTheSurfaceWithinTheRadius) {
  const TetMesh mesh = make_box(GetParam(), {4, 4, 2}, {4, 4, 2});
  const auto on_boundary = boundary_points(mesh);
  const SurfacePatches patches(mesh);
  for (const Vec3& place : {Vec3(2, 2, 2), Vec3(0, 2, 1), Vec3(4, 4, 2)}) {
    const Index node = nearest(mesh, place);
    EXPECT_EQ(patches.around(node, 0), std::vector<Index>{node});
    for (const double radius : {0.3, 0.5, 1.0, 1.5, 10.0}) {
      std::vector<Index> expected;
      for (Index p = 0; p < mesh.num_points(); ++p) {
        // Around these nodes the surface bends outward: whatever is near is connected.
        if (on_boundary[p] != 0 && (mesh.points[p] - mesh.points[node]).norm() <= radius) {
          expected.push_back(p);
        }
      }
      EXPECT_EQ(patches.around(node, radius), expected) << radius;
    }
  }
}

// Two legs that are near each other, but far along the surface.
TEST_P(SurfacePatch, IsConnected) {
  const TetMesh box = make_box(GetParam(), {5, 1, 4}, {5, 1, 4});
  const TetMesh legs = subset(box, [&](Index c) {
    Vec3 centre = Vec3::Zero();
    for (int a = 0; a < 4; ++a) centre += box.points[box.cell(c)[a]] / 4;
    return centre.z() > 3 || centre.x() < 2 || centre.x() > 3;
  });
  const Index node = nearest(legs, {2, 0, 0});
  const Index other_leg = nearest(legs, {3, 0, 0});
  const SurfacePatches patches(legs);
  const auto patch = patches.around(node, 1.5);
  EXPECT_GT(patch.size(), 3U);
  EXPECT_EQ(std::count(patch.begin(), patch.end(), other_leg), 0);
  const auto all = patches.around(node, 10);
  EXPECT_EQ(std::count(all.begin(), all.end(), other_leg), 1);
}

// The middle between two points counts whatever the unit of length.
TEST_P(SurfacePatch, ScalesWithTheBody) {
  const TetMesh mesh = make_box(GetParam(), {4, 4, 2}, {0.4, 0.4, 0.2});
  const Index node = nearest(mesh, {0.2, 0.2, 0.2});
  const auto patch = SurfacePatches(mesh).around(node, 0.1);
  EXPECT_GE(patch.size(), 5U);
  for (const double scale : {1e-6, 1e-3, 3.0, 1e3}) {
    TetMesh scaled = mesh;
    for (Vec3& p : scaled.points) p *= scale;
    EXPECT_EQ(SurfacePatches(scaled).around(node, scale * 0.1), patch) << scale;
  }
}

TEST_P(SurfacePatch, RefusesWhatIsNoPlaceOrNoRadius) {
  const TetMesh mesh = make_box(GetParam(), {2, 2, 2}, {2, 2, 2});
  const SurfacePatches patches(mesh);
  const Index inside = nearest(mesh, {1, 1, 1});
  EXPECT_FALSE(patches.on_surface(inside));
  for (const Index node : {inside, -1, mesh.num_points()}) {
    EXPECT_THROW((void)patches.around(node, 0), InputError);
  }
  for (const double radius :
       {-1.0, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THROW((void)patches.around(0, radius), InputError);
  }
}

}  // namespace
}  // namespace palpate::test::test_surface_patch
