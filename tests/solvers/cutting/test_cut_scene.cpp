// SPDX-License-Identifier: BSD-3-Clause
#include "cutting/cut_scene.h"

#include <gtest/gtest.h>

#include <cmath>

#include "cutting/opened_scene.h"
#include "cutting/straight_cells.h"
#include "solvers/support/block.h"
#include "solvers/support/bodies.h"
#include "solvers/support/box_mesh.h"

namespace palpate::test::test_cut_scene {
namespace {

const Vec3 kSize(0.1, 0.06, 0.06);

/// A plane from x < 0 to `end`, at a height that no layer of points has.
Sheet make_sheet(double end, double height) {
  return Sheet({Vec3(-0.02, -0.02, height), Vec3(end, -0.02, height), Vec3(end, 0.08, height),
                Vec3(-0.02, 0.08, height)},
               {{0, 1, 2}, {0, 2, 3}}, {-0.02, end, end, -0.02});
}

SheetMesh put(const Scene& scene, double end, double height, double spacing) {
  SheetOptions options;
  options.spacing = spacing;
  return put_sheet(straight_cells(scene.body.mesh), scene.body.material_of_cell,
                   make_sheet(end, height), options);
}

/// Held at x = 0.1, of two tissues, with everything that a body may have elsewhere.
Scene make_body(ElementOrder order) {
  TetMesh mesh = make_box(order, {8, 5, 5}, kSize);
  std::vector<char> fixed;
  for (const Vec3& x : mesh.points) fixed.push_back(x.x() > kSize.x() - 1e-9 ? 1 : 0);
  Scene scene = make_scene(std::move(mesh), make_isotropic(Law::neo_hookean, 5000, 0.4), fixed);
  put_inside(scene, make_isotropic(Law::neo_hookean, 9000, 0.4),
             [](const Vec3& x) { return x.y() > 0.036 - 1e-9; });
  Body& body = scene.body;
  const std::size_t num_points = body.mesh.points.size();
  body.held_directions.assign(num_points, HeldDirections::Zero());
  body.support_stiffness.assign(num_points, 0);
  body.applied_traction.assign(num_points, Vec3::Zero());
  for (std::size_t p = 0; p < num_points; ++p) {
    const Vec3& x = body.mesh.points[p];
    if (x.y() < 1e-9 && body.fixed[p] == 0) body.held_directions[p].col(0) = Vec3::UnitY();
    if (x.x() < 1e-9) body.support_stiffness[p] = 1e5 * (1 + x.z());
    if (x.z() > kSize.z() - 1e-9) body.applied_traction[p] = Vec3(0, 0, 10);
  }
  check(scene);
  return scene;
}

class CutSceneOf : public testing::TestWithParam<ElementOrder> {};
INSTANTIATE_TEST_SUITE_P(Orders, CutSceneOf,
                         testing::Values(ElementOrder::linear, ElementOrder::quadratic));

TEST_P(CutSceneOf, IsHeldLoadedAndTouchedAtTheSamePlaces) {
  const Scene before = make_body(GetParam());
  const SheetMesh mesh = put(before, 0.05, 0.031, 0.01);
  Scene closed = cut_scene(before, mesh);
  EXPECT_NO_THROW(check(closed));
  const Body& body = closed.body;
  ASSERT_EQ(body.mesh.order, GetParam());
  ASSERT_GT(body.mesh.num_cells(), before.body.mesh.num_cells());
  const std::vector<char> on_surface = boundary_points(body.mesh);
  std::vector<char> is_corner(body.mesh.points.size(), 0);
  for (Index c = 0; c < body.mesh.num_cells(); ++c) {
    Vec3 middle = Vec3::Zero();
    for (int k = 0; k < 4; ++k) {
      is_corner[body.mesh.cell(c)[k]] = 1;
      middle += 0.25 * body.mesh.points[body.mesh.cell(c)[k]];
    }
    EXPECT_EQ(body.material_of_cell[c], middle.y() > 0.036 ? 1 : 0);
  }
  for (std::size_t p = 0; p < body.mesh.points.size(); ++p) {
    const Vec3& x = body.mesh.points[p];
    const bool is_fixed = x.x() > kSize.x() - 1e-9;
    EXPECT_EQ(body.fixed[p] != 0, is_fixed) << x.transpose();
    EXPECT_EQ(!body.held_directions[p].isZero(0), x.y() < 1e-9 && !is_fixed) << x.transpose();
    if (is_corner[p] == 0) continue;
    EXPECT_NEAR(body.support_stiffness[p], x.x() < 1e-9 ? 1e5 * (1 + x.z()) : 0, 1e-6);
    EXPECT_NEAR(body.applied_traction[p].z(), x.z() > kSize.z() - 1e-9 ? 10 : 0, 1e-9);
    EXPECT_EQ(body.touchable[p], !is_fixed && on_surface[p] != 0 ? 1 : 0) << x.transpose();
  }
  EXPECT_EQ(body.cut.areas, mesh.areas);
  Scene opened = open_scene(closed, mesh.num_stages()).scene;
  EXPECT_NO_THROW(check(opened));
}

TEST_P(CutSceneOf, WhatIsOpenOfAnEarlierCutStaysOpen) {
  const Scene whole = make_body(GetParam());
  const Scene once = open_scene(cut_scene(whole, put(whole, 0.05, 0.021, 1)), 1).scene;
  const Scene twice = open_scene(cut_scene(once, put(once, 0.04, 0.043, 1)), 1).scene;
  ASSERT_EQ(twice.body.cut.areas.size(), 2U);
  EXPECT_NEAR(twice.body.cut.area(), 0.06 * (0.05 + 0.04), 1e-9);
  double open[2] = {0, 0};
  const TetMesh& mesh = twice.body.mesh;
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    for (int k = 0; k < 4; ++k) {
      if (!is_open(twice.body.cut.faces[c][k], 1)) continue;
      std::array<Vec3, 3> x;
      for (int a = 0, n = 0; a < 4; ++a) {
        if (a != k) x[n++] = mesh.points[mesh.cell(c)[a]];
      }
      open[x[0].z() > 0.03 ? 1 : 0] += 0.25 * (x[1] - x[0]).cross(x[2] - x[0]).norm();
    }
  }
  EXPECT_NEAR(open[0], 0.06 * 0.05, 1e-9);
  EXPECT_NEAR(open[1], 0.06 * 0.04, 1e-9);
  Scene checked = twice;
  EXPECT_NO_THROW(check(checked));
}

}  // namespace
}  // namespace palpate::test::test_cut_scene
