// SPDX-License-Identifier: BSD-3-Clause
#include "cutting/opened_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "mesh/pieces.h"
#include "solvers/support/cut_cube.h"

namespace palpate::test::test_opened_mesh {
namespace {

class OpenedMeshOf : public testing::TestWithParam<ElementOrder> {};

TEST_P(OpenedMeshOf, HasThePointsBehindTheFrontTwice) {
  const CutCube cube = make_cut_cube(GetParam());
  for (int stage = 0; stage <= 3; ++stage) {
    const OpenedMesh opened = open_mesh(cube.mesh, cube.faces, stage);
    // The points of the plane but for those of the front.
    std::size_t expected = 0;
    for (const Vec3& x : cube.mesh.points) {
      if (std::abs(x.z() - 0.5) < 1e-9 && x.x() < 0.25 * stage - 1e-9) ++expected;
    }
    EXPECT_EQ(opened.originals.size(), expected);
    EXPECT_EQ(opened.mesh.num_cells(), cube.mesh.num_cells());
    EXPECT_NEAR(volume(opened.mesh), 1, 1e-12);
    for (std::size_t i = 0; i < opened.originals.size(); ++i) {
      EXPECT_EQ(opened.mesh.points[cube.mesh.points.size() + i],
                cube.mesh.points[opened.originals[i]]);
    }
    const std::size_t faces =
        boundary_triangles(opened.mesh).size() - boundary_triangles(cube.mesh).size();
    EXPECT_EQ(faces, 2U * 2U * kCutCubeCells * stage);
    EXPECT_FALSE(find_fault(cube.mesh, cube.faces, stage).has_value());
    EXPECT_EQ(euler_characteristic(opened.mesh), 2);
    EXPECT_EQ(find_rigid_parts(opened.mesh).size(), 1);
  }
}

INSTANTIATE_TEST_SUITE_P(Orders, OpenedMeshOf,
                         testing::Values(ElementOrder::linear, ElementOrder::quadratic));

/// Only those open faces stay that have a corner at a place.
void keep_open(CutCube& cube, const Vec3& place, bool only_one) {
  for (Index c = 0; c < cube.mesh.num_cells(); ++c) {
    for (int k = 0; k < 4; ++k) {
      bool is_there = false;
      for (int a = 0; a < 4; ++a) {
        is_there =
            is_there || (a != k && (cube.mesh.points[cube.mesh.cell(c)[a]] - place).norm() < 1e-9);
      }
      if (!is_there) cube.faces[c][k] = 0;
    }
  }
  if (!only_one) return;
  // The first face that is open, and the same of the cell behind it.
  Vec3 first = Vec3::Constant(-1);
  for (Index c = 0; c < cube.mesh.num_cells(); ++c) {
    for (int k = 0; k < 4; ++k) {
      if (cube.faces[c][k] == 0) continue;
      Vec3 middle = Vec3::Zero();
      for (int a = 0; a < 4; ++a)
        middle += a == k ? Vec3::Zero() : cube.mesh.points[cube.mesh.cell(c)[a]];
      if (first.x() < 0) first = middle;
      if ((middle - first).norm() > 1e-9) cube.faces[c][k] = 0;
    }
  }
}

TEST(OpenedMesh, OfACrackInsideHasASurfaceOfItsOwn) {
  CutCube cube = make_cut_cube(ElementOrder::linear);
  keep_open(cube, Vec3(0.5, 0.5, 0.5), false);
  EXPECT_FALSE(find_fault(cube.mesh, cube.faces, 3).has_value());
  const OpenedMesh opened = open_mesh(cube.mesh, cube.faces, 3);
  EXPECT_EQ(opened.originals.size(), 1U);
  EXPECT_EQ(euler_characteristic(opened.mesh), 4);
}

TEST(OpenedMesh, IsFaultyWhereNoCornerOfAFaceOpens) {
  CutCube cube = make_cut_cube(ElementOrder::linear);
  keep_open(cube, Vec3(0.5, 0.5, 0.5), true);
  const auto fault = find_fault(cube.mesh, cube.faces, 3);
  ASSERT_TRUE(fault.has_value());
  EXPECT_TRUE(fault->edge.has_value());
}

TEST(OpenedMesh, MayFallApart) {
  const CutCube cube = make_cut_cube(ElementOrder::linear, 1);
  EXPECT_EQ(find_rigid_parts(open_mesh(cube.mesh, cube.faces, 4).mesh).size(), 2);
}

TEST(OpenedMesh, IsFaultyWhereAFaceIsOpenOnOneSideAlone) {
  CutCube cube = make_cut_cube(ElementOrder::linear);
  const auto is_open = [](const OpenedFaces& faces) {
    return std::any_of(faces.begin(), faces.end(), [](int stage) { return stage == 1; });
  };
  const auto found = std::find_if(cube.faces.begin(), cube.faces.end(), is_open);
  std::replace(found->begin(), found->end(), 1, 0);
  const auto fault = find_fault(cube.mesh, cube.faces, 1);
  ASSERT_TRUE(fault.has_value());
  EXPECT_NE(fault->text.find("one side"), std::string::npos);
}

}  // namespace
}  // namespace palpate::test::test_opened_mesh
