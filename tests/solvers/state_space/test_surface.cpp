// SPDX-License-Identifier: BSD-3-Clause
#include "state_space/surface.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "cutting/opened_scene.h"
#include "solvers/state_space/example_space.h"
#include "solvers/support/cut_cube.h"
#include "state_space/shown_surface.h"
#include "state_space/touch_space.h"

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

// All stages of a cut have the same triangles, so that what moves one of them moves the shown one.
TEST_P(SurfaceOfOrder, OfACutHasBothSidesAtEachStage) {
  std::vector<SpaceBody> bodies;
  for (Scene& stage : open_stages(make_cut_scene(GetParam()))) {
    bodies.push_back(make_space_body(std::move(stage)));
    bodies.back().number = static_cast<BodyId>(bodies.size());
  }
  const ShownSurface shown(bodies);
  const Surface& last = shown.surface();
  const std::size_t split = GetParam() == ElementOrder::quadratic ? 4 : 1;
  EXPECT_EQ(last.stages_of_cut.size(), split * 2 * 2 * 3 * kCutCubeCells);
  const Scene& closed = *bodies.back().scene;
  EXPECT_EQ(last.touched_triangles().size(), split * boundary_triangles(closed.body.mesh).size());
  for (const SpaceBody& body : bodies) {
    const Surface& surface = shown.surface_of(body.number);
    ASSERT_EQ(surface.triangles.size(), last.triangles.size());
    EXPECT_EQ(surface.stages_of_cut, last.stages_of_cut);
    for (std::size_t t = 0; t < last.triangles.size(); ++t) {
      for (int a = 0; a < 3; ++a) {
        EXPECT_EQ(surface.points[surface.triangles[t][a]], last.points[last.triangles[t][a]]);
      }
    }
    // The places of this body's points, carried over, are those of the shown ones.
    Eigen::MatrixXf places(3 * static_cast<Eigen::Index>(surface.num_points()), 1);
    for (Index p = 0; p < surface.num_points(); ++p) {
      places.middleRows<3>(3 * Eigen::Index{p}) = surface.points[p].cast<float>();
    }
    const Eigen::MatrixXf carried = shown.carry(body.number, places);
    for (Index p = 0; p < last.num_points(); ++p) {
      EXPECT_EQ((carried.middleRows<3>(3 * Eigen::Index{p})), last.points[p].cast<float>());
    }
  }
  const TouchSpace space = make_empty_touch_space(shown);
  ASSERT_EQ(space.stages.size(), 4U);
  for (std::size_t s = 0; s < space.stages.size(); ++s) {
    EXPECT_EQ(space.stages[s].area, 0.25 * static_cast<double>(s));
    EXPECT_EQ(space.stages[s].body, static_cast<BodyId>(4 - s));
  }
}

INSTANTIATE_TEST_SUITE_P(, SurfaceOfOrder,
                         testing::Values(ElementOrder::linear, ElementOrder::quadratic),
                         [](const auto& order) {
                           return order.param == ElementOrder::linear ? "Linear" : "Quadratic";
                         });

}  // namespace
}  // namespace palpate::test::test_surface
