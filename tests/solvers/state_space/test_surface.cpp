// SPDX-License-Identifier: BSD-3-Clause
#include "state_space/surface.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <map>

#include "solvers/state_space/example_space.h"

namespace palpate::test::test_surface {
namespace {

class SurfaceOfOrder : public testing::TestWithParam<ElementOrder> {};

TEST_P(SurfaceOfOrder, IsClosedOutwardAndHoldsTheBoundaryPoints) {
  const TetMesh mesh = test::cube_mesh(3, GetParam());
  const Surface surface = make_surface(mesh);

  const std::vector<char> expected = boundary_points(mesh);
  EXPECT_EQ(surface.num_points(), std::count(expected.begin(), expected.end(), 1));
  EXPECT_TRUE(std::is_sorted(surface.mesh_points.begin(), surface.mesh_points.end()));
  for (Index p = 0; p < surface.num_points(); ++p) {
    EXPECT_EQ(expected[surface.mesh_points[p]], 1);
    EXPECT_EQ(surface.points[p], mesh.points[surface.mesh_points[p]]);
    EXPECT_EQ(surface.find(surface.mesh_points[p]), p);
  }
  const auto inside = std::find(expected.begin(), expected.end(), 0) - expected.begin();
  EXPECT_EQ(surface.find(static_cast<Index>(inside)), -1);

  const std::size_t split = GetParam() == ElementOrder::quadratic ? 4 : 1;
  EXPECT_EQ(surface.triangles.size(), split * boundary_triangles(mesh).size());
  std::map<std::pair<Index, Index>, int> edges;
  double six_volumes = 0;
  for (const auto& t : surface.triangles) {
    for (int a = 0; a < 3; ++a) ++edges[{t[a], t[(a + 1) % 3]}];
    six_volumes += surface.points[t[0]].dot(surface.points[t[1]].cross(surface.points[t[2]]));
  }
  for (const auto& [edge, uses] : edges) {
    EXPECT_EQ(uses, 1);
    EXPECT_EQ(edges.count({edge.second, edge.first}), 1U) << "open edge";
  }
  EXPECT_NEAR(six_volumes / 6, 1e-3, 1e-15);
}

INSTANTIATE_TEST_SUITE_P(, SurfaceOfOrder,
                         testing::Values(ElementOrder::linear, ElementOrder::quadratic),
                         [](const auto& order) {
                           return order.param == ElementOrder::linear ? "Linear" : "Quadratic";
                         });

}  // namespace
}  // namespace palpate::test::test_surface
