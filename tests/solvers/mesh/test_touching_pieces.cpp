// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/touching_pieces.h"

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

#include "solvers/support/box_mesh.h"
#include "solvers/support/message_of.h"
#include "solvers/support/orders.h"

namespace palpate::test::test_touching_pieces {
namespace {

constexpr std::array<int, 3> kBricks{3, 2, 2};
const Vec3 kSize(0.03, 0.02, 0.02);

/// Appends a mesh that shares no point with the one before.
void append(TetMesh& mesh, const TetMesh& other) {
  const Index first = mesh.num_points();
  mesh.points.insert(mesh.points.end(), other.points.begin(), other.points.end());
  for (const Index p : other.cells) mesh.cells.push_back(first + p);
}

TetMesh moved(TetMesh mesh, const Vec3& by) {
  for (Vec3& p : mesh.points) p += by;
  return mesh;
}

/// Two boxes, one on the other, each with points of its own.
TetMesh two_halves(ElementOrder order) {
  TetMesh mesh = make_box(order, kBricks, kSize);
  append(mesh, moved(make_box(order, kBricks, kSize), {0, 0, kSize.z()}));
  return mesh;
}

TouchingPieces find(const TetMesh& mesh) { return find_touching_pieces(mesh, find_pieces(mesh)); }

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// Points on the face that the halves share.
Index num_shared(ElementOrder order) { return order == ElementOrder::linear ? 4 * 3 : 7 * 5; }

class TouchingOfAnyOrder : public testing::TestWithParam<ElementOrder> {};
INSTANTIATE_TEST_SUITE_P(TouchingPieces, TouchingOfAnyOrder, testing::ValuesIn(kOrders),
                         name_of_order);

TEST_P(TouchingOfAnyOrder, HalvesAreFoundAndMerged) {
  TetMesh mesh = two_halves(GetParam());
  // What single precision leaves of coordinates as large as a scanner's.
  for (Vec3& p : mesh.points) p = (p + Vec3(0.3, 0.2, 0.1)).cast<float>().cast<double>();
  for (std::size_t p = mesh.points.size() / 2; p < mesh.points.size(); ++p) {
    mesh.points[p] *= 1 + 1e-7;
  }
  const TouchingPieces touching = find(mesh);
  EXPECT_EQ(touching.num_pieces, 2);
  EXPECT_EQ(touching.num_coincident, num_shared(GetParam()));
  EXPECT_EQ(touching.num_of_slits, 0);
  EXPECT_EQ(touching.num_other_faces, 0);
  const std::string text = describe(touching, 2, false).value_or("");
  EXPECT_TRUE(contains(text, "2 of the 2 pieces")) << text;
  EXPECT_TRUE(contains(text, std::to_string(num_shared(GetParam())) + " points coincide")) << text;
  EXPECT_FALSE(describe(touching, 2, true));

  const MergedMesh merged = merge_points(mesh, touching);
  EXPECT_EQ(find_pieces(merged.mesh).size(), 1);
  EXPECT_EQ(find_rigid_parts(merged.mesh).size(), 1);
  EXPECT_EQ(merged.mesh.num_points(), mesh.num_points() - num_shared(GetParam()));
  EXPECT_EQ(merged.mesh.num_cells(), mesh.num_cells());
  for (Index p = 0; p < merged.mesh.num_points(); ++p) {
    EXPECT_EQ(merged.number[merged.before[p]], p);
    EXPECT_EQ(merged.mesh.points[p], mesh.points[merged.before[p]]);
  }
  EXPECT_FALSE(find_overlap(merged.mesh));
}

TEST_P(TouchingOfAnyOrder, OneThatIsApartTouchesNothing) {
  TetMesh mesh = make_box(GetParam(), kBricks, kSize);
  append(mesh, moved(mesh, {0, 0, 1.01 * kSize.z()}));
  const TouchingPieces touching = find(mesh);
  EXPECT_EQ(touching.num_pieces, 0);
  EXPECT_EQ(touching.num_coincident, 0);
  EXPECT_FALSE(describe(touching, 2, false));
}

// Of one piece of which points coincide: they are the two sides of a cut.
TEST_P(TouchingOfAnyOrder, ASlitIsLeft) {
  TetMesh mesh = two_halves(GetParam());
  TouchingPieces touching = find(mesh);
  // The halves stay joined at x = 0 alone.
  for (Index p = 0; p < mesh.num_points(); ++p) {
    if (mesh.points[p].x() > 0) touching.merged[p] = p;
  }
  const TetMesh slit = merge_points(mesh, touching).mesh;
  ASSERT_EQ(find_pieces(slit).size(), 1);
  EXPECT_EQ(find(slit).num_coincident, 0);
  EXPECT_EQ(find(slit).num_pieces, 0);
  // A third piece that lies at the slit is joined to one of its sides, and the slit stays.
  TetMesh three = slit;
  append(three, moved(make_box(GetParam(), kBricks, kSize), {kSize.x(), 0, 0}));
  const TouchingPieces beside = find(three);
  EXPECT_GT(beside.num_of_slits, 0);
  EXPECT_TRUE(contains(describe(beside, 2, true).value_or(""), "close a slit"));
  const TetMesh joined = merge_points(three, beside).mesh;
  EXPECT_EQ(find_pieces(joined).size(), 1);
  EXPECT_GT(boundary_triangles(joined).size(), 0U);
}

TEST_P(TouchingOfAnyOrder, CellsOfWhichEachIsAPieceBecomeOneBody) {
  const TetMesh box = make_box(GetParam(), {2, 1, 1}, kSize);
  TetMesh cells;
  cells.order = GetParam();
  for (const Index p : box.cells) {
    cells.cells.push_back(cells.num_points());
    cells.points.push_back(box.points[p]);
  }
  EXPECT_EQ(find_pieces(cells).size(), box.num_cells());
  const TouchingPieces touching = find(cells);
  EXPECT_EQ(touching.num_pieces, box.num_cells());
  EXPECT_EQ(touching.num_other_faces, 0);
  const MergedMesh merged = merge_points(cells, touching);
  EXPECT_EQ(merged.mesh.num_points(), box.num_points());
  EXPECT_EQ(boundary_triangles(merged.mesh).size(), boundary_triangles(box).size());
}

// The upper half is divided twice as finely where they meet.
TEST_P(TouchingOfAnyOrder, FacesThatAreDividedOtherwiseAreTold) {
  TetMesh mesh = make_box(GetParam(), kBricks, kSize);
  append(mesh, moved(make_box(GetParam(), {6, 4, 4}, kSize), {0, 0, kSize.z()}));
  const TouchingPieces touching = find(mesh);
  EXPECT_EQ(touching.num_pieces, 2);
  // Those of the coarse side and those of the fine one.
  EXPECT_EQ(touching.num_other_faces, 2 * 3 * 2 + 2 * 6 * 4);
  EXPECT_TRUE(contains(describe(touching, 2, true).value_or(""), "60 faces lie"));
}

TEST(TouchingPieces, AFaceThatIsCurvedOtherwiseIsTold) {
  TetMesh mesh = two_halves(ElementOrder::quadratic);
  const TouchingPieces straight = find(mesh);
  ASSERT_EQ(straight.num_other_faces, 0);
  // A midside node of the lower half that is on the common face, away from its border.
  for (Index p = 0; p < mesh.num_points() / 2; ++p) {
    if ((mesh.points[p] - Vec3(0.015, 0.01, kSize.z())).norm() < 1e-9) mesh.points[p].z() -= 1e-3;
  }
  const TouchingPieces touching = find(mesh);
  EXPECT_EQ(touching.num_coincident, num_shared(ElementOrder::quadratic) - 1);
  EXPECT_EQ(touching.num_other_faces, 4);
}

TEST(TouchingPieces, WhatIsThereTwiceIsNotMerged) {
  TetMesh mesh = make_box(ElementOrder::linear, kBricks, kSize);
  append(mesh, make_box(ElementOrder::linear, kBricks, kSize));
  const TouchingPieces touching = find(mesh);
  EXPECT_TRUE(contains(message_of([&] { (void)merge_points(mesh, touching); }), "overlap"));
}

}  // namespace
}  // namespace palpate::test::test_touching_pieces
