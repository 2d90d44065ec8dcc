// SPDX-License-Identifier: BSD-3-Clause
// A fine surface of a cube is split where the cut of a coarser cube goes through it.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <vector>

#include "cutting/opened_scene.h"
#include "solvers/support/box_mesh.h"
#include "solvers/support/cut_cube.h"
#include "state_space/split_surface.h"

namespace palpate::test::test_split_surface {
namespace {

using Triangle = std::array<Index, 3>;

/// Where the cut of the cube ends in x, m.
constexpr double kEnd = 0.75;
constexpr double kAside = 1e-3;

double area_of(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles) {
  double area = 0;
  for (const auto& [a, b, c] : triangles) {
    area += 0.5 * (points[b] - points[a]).cross(points[c] - points[a]).norm();
  }
  return area;
}

class SplitCube : public testing::TestWithParam<ElementOrder> {
 protected:
  SplitCube()
      : sheet_(sheet_of_cut(make_surface(open_scene(make_cut_scene(GetParam()), 2).scene.body))) {
    // Neither its points nor its edges are on the sheet, and it is a little larger than the body.
    surface_ = make_surface(make_box(ElementOrder::linear, {7, 7, 7}, Vec3(1, 1, 1)));
    for (Vec3& x : surface_.points) x = Vec3(0.5, 0.5, 0.5) + 1.01 * (x - Vec3(0.5, 0.5, 0.5));
    points_ = surface_.points;
  }

  void split() {
    split_ = split_surface(surface_.points, surface_.triangles, sheet_, 0.05, kAside);
    points_ = surface_.points;
    for (const auto& [a, b, share] : split_.added) {
      points_.push_back((1 - share) * surface_.points[a] + share * surface_.points[b]);
    }
  }

  Sheet sheet_;
  Surface surface_;
  SplitSurface split_;
  std::vector<Vec3> points_;
};
INSTANTIATE_TEST_SUITE_P(Orders, SplitCube,
                         testing::Values(ElementOrder::linear, ElementOrder::quadratic));

TEST_P(SplitCube, OpensAlongTheCutAndNowhereElse) {
  split();
  ASSERT_EQ(split_.on_side.size(), points_.size());
  EXPECT_NEAR(area_of(points_, split_.triangles), 6 * 1.01 * 1.01, 1e-12);
  std::map<std::array<Index, 2>, int> edges;
  for (const Triangle& triangle : split_.triangles) {
    for (int k = 0; k < 3; ++k) ++edges[{triangle[k], triangle[(k + 1) % 3]}];
  }
  double length = 0;
  for (const auto& [edge, uses] : edges) {
    EXPECT_EQ(uses, 1);
    if (edges.count({edge[1], edge[0]}) > 0) continue;
    for (const Index p : edge) {
      EXPECT_NEAR(points_[p].z(), 0.5, 1e-12);
      EXPECT_LT(points_[p].x(), kEnd);
    }
    length += (points_[edge[1]] - points_[edge[0]]).norm();
  }
  // Both lips, without the last triangle of each end.
  EXPECT_LT(length, 2 * (1.01 + 2 * (kEnd + 0.005)));
  EXPECT_GT(length, 2 * (1.01 + 2 * (kEnd - 0.15)));
  // No triangle has a part on either side, but where the cut ends.
  for (const Triangle& triangle : split_.triangles) {
    double least = 1, most = -1, last = 0;
    for (const Index p : triangle) {
      least = std::min(least, split_.on_side[p].z() - 0.5);
      most = std::max(most, split_.on_side[p].z() - 0.5);
      last = std::max(last, points_[p].x());
    }
    if (last < kEnd - 0.15) {
      EXPECT_TRUE(least > 0.99 * kAside || most < -0.99 * kAside) << least << " " << most;
    }
  }
}

TEST_P(SplitCube, PointsThatAreSeveralAtAPlaceAreSplitAlike) {
  split();
  const SplitSurface welded = split_;
  const std::vector<Vec3> places = points_;
  Surface loose;
  for (const Triangle& triangle : surface_.triangles) {
    const Index first = loose.num_points();
    for (const Index p : triangle) loose.points.push_back(surface_.points[p]);
    loose.triangles.push_back({first, first + 1, first + 2});
  }
  surface_ = loose;
  split();
  ASSERT_EQ(split_.triangles.size(), welded.triangles.size());
  EXPECT_EQ(split_.parents, welded.parents);
  for (std::size_t t = 0; t < split_.triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR((points_[split_.triangles[t][k]] - places[welded.triangles[t][k]]).norm(), 0,
                  1e-12);
      EXPECT_NEAR(
          (split_.on_side[split_.triangles[t][k]] - welded.on_side[welded.triangles[t][k]]).norm(),
          0, 1e-12);
    }
  }
}

TEST_P(SplitCube, ASurfaceBesideTheCutStaysAsItIs) {
  for (Vec3& x : surface_.points) x.z() += 2;
  split();
  EXPECT_EQ(split_.triangles, surface_.triangles);
  EXPECT_TRUE(split_.added.empty());
  EXPECT_EQ(split_.on_side, surface_.points);
}

}  // namespace
}  // namespace palpate::test::test_split_surface
