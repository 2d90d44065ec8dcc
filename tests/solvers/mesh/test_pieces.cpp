// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/pieces.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "solvers/support/box_mesh.h"
#include "solvers/support/orders.h"

namespace palpate::test::test_pieces {
namespace {

/// Sums of some hundred terms lose two digits at the most.
constexpr double kRounding = 1e-13;

void expect_near(const Vec3& found, const Vec3& expected) {
  EXPECT_LE((found - expected).norm(), kRounding * expected.norm()) << found.transpose();
}

/// Adds a copy of the mesh that shares no point with it.
void add_beside(TetMesh& mesh, const Vec3& shift) {
  const TetMesh one = mesh;
  for (const Vec3& p : one.points) mesh.points.push_back(p + shift);
  for (const Index p : one.cells) mesh.cells.push_back(p + one.num_points());
}

class PiecesOfAnyOrder : public testing::TestWithParam<ElementOrder> {};
INSTANTIATE_TEST_SUITE_P(Pieces, PiecesOfAnyOrder, testing::ValuesIn(kOrders), name_of_order);

TEST_P(PiecesOfAnyOrder, ABoxIsOne) {
  const TetMesh box = make_box(GetParam(), {3, 2, 2}, {3, 4, 5});
  for (const Pieces& pieces : {find_pieces(box), find_rigid_parts(box)}) {
    ASSERT_EQ(pieces.size(), 1);
    EXPECT_EQ(pieces.each[0].num_cells, box.num_cells());
    EXPECT_NEAR(pieces.each[0].volume, 60, 60 * kRounding);
    expect_near(pieces.each[0].centre, {1.5, 2, 2.5});
  }
}

TEST_P(PiecesOfAnyOrder, TwoBoxesAreTwo) {
  TetMesh mesh = make_box(GetParam(), {2, 1, 1}, {2, 1, 1});
  const Index num_points = mesh.num_points();
  add_beside(mesh, {0, 0, 1});  // whose points are there twice where they meet
  mesh.points.emplace_back(9, 9, 9);
  const Pieces pieces = find_pieces(mesh);
  ASSERT_EQ(pieces.size(), 2);
  expect_near(pieces.each[0].centre, {1, 0.5, 0.5});
  expect_near(pieces.each[1].centre, {1, 0.5, 1.5});
  const std::vector<Index> of_point = piece_of_points(mesh, pieces);
  EXPECT_EQ(of_point[0], 0);
  EXPECT_EQ(of_point[num_points], 1);
  EXPECT_EQ(of_point.back(), -1);
  EXPECT_EQ(describe(pieces.each[1]), "12 cells, 2 m³, around (1, 0.5, 1.5) m");
}

// Two cells with one edge in common.
TEST(Pieces, AnEdgeJoinsPointsButNoFaces) {
  TetMesh mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, -1, 0}, {0, 0, -1}};
  mesh.cells = {0, 1, 2, 3, 0, 1, 4, 5};
  EXPECT_EQ(find_pieces(mesh).size(), 1);
  EXPECT_EQ(find_rigid_parts(mesh).size(), 2);
  mesh.cells = {0, 1, 2, 3, 0, 1, 2, 5};
  EXPECT_EQ(find_rigid_parts(mesh).size(), 1);
}

}  // namespace
}  // namespace palpate::test::test_pieces
