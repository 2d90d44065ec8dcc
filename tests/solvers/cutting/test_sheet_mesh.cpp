// SPDX-License-Identifier: BSD-3-Clause
#include "cutting/sheet_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "base/error.h"
#include "solvers/support/box_mesh.h"
#include "solvers/support/random.h"

namespace palpate::test::test_sheet_mesh {
namespace {

/// A cube of 10 cm with cells of 2 cm, whose inner points lie at random.
TetMesh make_body() {
  constexpr int kCells = 5;
  TetMesh mesh = make_box(ElementOrder::linear, {kCells, kCells, kCells}, Vec3(0.1, 0.1, 0.1));
  Random random(5);
  const std::vector<char> is_outside = boundary_points(mesh);
  for (std::size_t p = 0; p < mesh.points.size(); ++p) {
    if (is_outside[p] == 0) mesh.points[p] += Vec3(random.vector(3, 0.002));
  }
  return mesh;
}

/// A sheet from x = −1 cm to an end, bent across y.
Sheet make_sheet(double end, double bend, double height = 0.048) {
  constexpr int kParts = 40;
  std::vector<Vec3> points;
  std::vector<std::array<Index, 3>> triangles;
  std::vector<double> front;
  for (int i = 0; i <= kParts; ++i) {
    for (int j = 0; j <= kParts; ++j) {
      const double x = -0.01 + (end + 0.01) * i / kParts;
      const double y = -0.01 + 0.12 * j / kParts;
      points.emplace_back(x, y, height + 0.1 * x + bend * (y - 0.05) * (y - 0.05));
      front.push_back(x);
      if (i == kParts || j == kParts) continue;
      const Index a = i * (kParts + 1) + j;
      const Index b = a + kParts + 1;
      triangles.push_back({a, b, a + 1});
      triangles.push_back({a + 1, b, b + 1});
    }
  }
  return Sheet(std::move(points), std::move(triangles), std::move(front));
}

SheetOptions fronts_of(double spacing) {
  SheetOptions options;
  options.spacing = spacing;
  return options;
}

TEST(SheetMesh, HasFacesOnThePlaneUpToEachFront) {
  const TetMesh body = make_body();
  const SheetMesh cut = put_sheet(body, {}, make_sheet(0.06, 0), fronts_of(0.02));
  ASSERT_EQ(cut.num_stages(), 3);
  EXPECT_GT(cut.least_angle, 5);
  EXPECT_NEAR(volume(cut.mesh), 1e-3, 1e-12);
  for (int stage = 1; stage <= 3; ++stage) {
    EXPECT_NEAR(cut.fronts[stage], 0.02 * stage, 1e-9);
    EXPECT_NEAR(cut.areas[stage], 0.1 * 0.02 * stage * std::sqrt(1.01), 1e-9);
    EXPECT_FALSE(find_fault(cut.mesh, cut.faces, stage).has_value());
    EXPECT_EQ(euler_characteristic(open_mesh(cut.mesh, cut.faces, stage).mesh), 2);
  }
  for (Index c = 0; c < cut.mesh.num_cells(); ++c) {
    for (int k = 0; k < 4; ++k) {
      const int stage = cut.faces[c][k];
      for (int a = 0; a < 4 && stage > 0; ++a) {
        if (a == k) continue;
        const Vec3& x = cut.mesh.points[cut.mesh.cell(c)[a]];
        EXPECT_NEAR(x.z(), 0.048 + 0.1 * x.x(), 1e-12);
        EXPECT_LT(x.x(), cut.fronts[stage] + 1e-9);
        EXPECT_GT(x.x(), cut.fronts[stage - 1] - 1e-9);
      }
    }
  }
}

TEST(SheetMesh, FollowsABentSheet) {
  const TetMesh body = make_body();
  SheetOptions options = fronts_of(0.015);
  options.edge = 0.012;
  const Sheet sheet = make_sheet(0.05, 4);
  const SheetMesh cut = put_sheet(body, {}, sheet, options);
  EXPECT_GT(cut.least_angle, 3);
  EXPECT_NEAR(volume(cut.mesh), 1e-3, 1e-7);
  std::vector<double> heights;
  for (Index c = 0; c < cut.mesh.num_cells(); ++c) {
    for (int k = 0; k < 4; ++k) {
      for (int a = 0; a < 4 && cut.faces[c][k] > 0; ++a) {
        if (a != k)
          heights.push_back(std::abs(sheet.at(cut.mesh.points[cut.mesh.cell(c)[a]]).height));
      }
    }
  }
  // The sheet bends to points at the edges of the cube, which cannot move.
  std::sort(heights.begin(), heights.end());
  EXPECT_LT(heights.back(), 0.15 * options.edge);
  EXPECT_LT(heights[heights.size() * 9 / 10], 2e-5);
}

TEST(SheetMesh, KeepsTheWallsOfTissues) {
  const TetMesh body = make_body();
  // Two layers of bricks are another tissue. Its wall, as the body's inner points, is not flat.
  std::vector<Index> regions;
  double expected = 0;
  for (Index c = 0; c < body.num_cells(); ++c) {
    regions.push_back(c < body.num_cells() * 2 / 5 ? 1 : 0);
  }
  const auto volume_of = [](const TetMesh& mesh, const std::vector<Index>& of, Index region) {
    TetMesh part;
    part.points = mesh.points;
    for (Index c = 0; c < mesh.num_cells(); ++c) {
      if (of[c] == region) {
        part.cells.insert(part.cells.end(), mesh.cell(c), mesh.cell(c) + 4);
      }
    }
    return volume(part);
  };
  expected = volume_of(body, regions, 1);
  const SheetMesh cut = put_sheet(body, regions, make_sheet(0.05, 0), fronts_of(0.01));
  std::vector<Index> of_parts;
  for (const Index parent : cut.parents) of_parts.push_back(regions[parent]);
  // Points of the wall move along its edges alone, which cuts corners off where it is bent.
  EXPECT_NEAR(volume_of(cut.mesh, of_parts, 1), expected, 0.01 * expected);
}

std::string message(const Sheet& sheet) {
  try {
    (void)put_sheet(make_body(), {}, sheet, fronts_of(0.02));
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(SheetMesh, IsRefusedWhereTheBodyWouldFallApart) {
  EXPECT_NE(message(make_sheet(0.12, 0)).find("severs"), std::string::npos);
  EXPECT_NE(message(make_sheet(0.05, 0, 0.3)).find("does not meet"), std::string::npos);
}

}  // namespace
}  // namespace palpate::test::test_sheet_mesh
