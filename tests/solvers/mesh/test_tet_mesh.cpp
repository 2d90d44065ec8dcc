// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/tet_mesh.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <string>

#include "base/error.h"
#include "solvers/support/box_mesh.h"
#include "solvers/support/orders.h"

namespace palpate::test::test_tet_mesh {
namespace {

constexpr int kEdges[6][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};

/// Sums of a few hundred terms of one magnitude lose two digits at the most.
constexpr double kRounding = 1e-13;

std::string error_of(TetMesh mesh) {
  try {
    check_and_orient(mesh);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

double volume_of_cell(const TetMesh& mesh, Index c) {
  return volume(subset(mesh, [c](Index other) { return other == c; }));
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

class AnyOrder : public testing::TestWithParam<ElementOrder> {
 protected:
  TetMesh box() const { return make_box(GetParam(), {3, 2, 2}, {3, 4, 5}); }
};

INSTANTIATE_TEST_SUITE_P(TetMesh, AnyOrder, testing::ValuesIn(kOrders), name_of_order);

TEST_P(AnyOrder, VolumeOfABox) { EXPECT_NEAR(volume(box()), 60, 60 * kRounding); }

TEST_P(AnyOrder, GoodCellsStayAsTheyAre) {
  TetMesh mesh = box();
  const auto cells = mesh.cells;
  check_and_orient(mesh);
  EXPECT_EQ(mesh.cells, cells);
}

TEST_P(AnyOrder, LeftHandedCellsAreTurnedRound) {
  TetMesh mesh = box();
  for (Vec3& p : mesh.points) p.x() = -p.x();
  ASSERT_LT(volume(mesh), 0);
  check_and_orient(mesh);
  EXPECT_NEAR(volume(mesh), 60, 60 * kRounding);
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    EXPECT_GT(volume_of_cell(mesh, c), 0);
    if (GetParam() == ElementOrder::linear) continue;
    const Index* cell = mesh.cell(c);
    for (int e = 0; e < 6; ++e) {
      const Vec3 middle = (mesh.points[cell[kEdges[e][0]]] + mesh.points[cell[kEdges[e][1]]]) / 2;
      EXPECT_LT((mesh.points[cell[4 + e]] - middle).norm(), kRounding) << "edge " << e;
    }
  }
}

TEST_P(AnyOrder, OnlyTheLeftHandedCellIsTurned) {
  TetMesh mesh = box();
  const auto cells = mesh.cells;
  const int npc = nodes_per_cell(mesh.order);
  Index* cell = mesh.cells.data() + 5 * npc;
  std::swap(cell[2], cell[3]);
  if (mesh.order == ElementOrder::quadratic) {
    std::swap(cell[6], cell[7]);
    std::swap(cell[5], cell[8]);
  }
  check_and_orient(mesh);
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    EXPECT_GT(volume_of_cell(mesh, c), 0);
    if (c != 5) {
      EXPECT_TRUE(std::equal(mesh.cell(c), mesh.cell(c) + npc, cells.data() + c * npc));
    }
  }
}

TEST_P(AnyOrder, ABodyWithoutCellsIsRefused) {
  TetMesh mesh = box();
  mesh.cells.clear();
  EXPECT_TRUE(contains(error_of(mesh), "no tetrahedra")) << error_of(mesh);
}

TEST_P(AnyOrder, ACoordinateThatIsNotFiniteIsNamed) {
  for (double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    TetMesh mesh = box();
    mesh.points[7].y() = bad;
    EXPECT_TRUE(contains(error_of(mesh), "Point 7 ")) << error_of(mesh);
    EXPECT_TRUE(contains(error_of(mesh), "not finite")) << error_of(mesh);
  }
}

TEST_P(AnyOrder, AnIndexOutOfRangeIsNamed) {
  for (Index bad : {-1, 1000000}) {
    TetMesh mesh = box();
    const int npc = nodes_per_cell(mesh.order);
    mesh.cells[4 * npc + npc - 1] = bad;
    EXPECT_TRUE(contains(error_of(mesh), "Cell 4 names point " + std::to_string(bad)))
        << error_of(mesh);
  }
  TetMesh mesh = box();
  mesh.cells[0] = mesh.num_points();  // the first that does not exist
  EXPECT_NE(error_of(mesh), "");
}

TEST_P(AnyOrder, CellsWithoutVolumeAreCountedAndTheFirstIsNamed) {
  TetMesh mesh = box();
  const int npc = nodes_per_cell(mesh.order);
  for (Index c : {6, 9}) mesh.cells[c * npc] = mesh.cells[c * npc + 3];  // two corners in one
  const std::string error = error_of(mesh);
  EXPECT_TRUE(contains(error, "2 of the tetrahedra have no volume")) << error;
  EXPECT_TRUE(contains(error, "cell 6 ")) << error;
}

// A thin cell is bad, not flat; the size of the body and its place have no part in that.
TEST(TetMesh, FlatIsMeasuredAgainstTheSizeOfTheCell) {
  for (double size : {1e-6, 1.0, 1e6}) {
    TetMesh thin;
    thin.points = {{0, 0, 0}, {size, 0, 0}, {0, size, 0}, {size / 3, size / 3, 1e-6 * size}};
    thin.cells = {0, 1, 2, 3};
    EXPECT_EQ(error_of(thin), "");
    thin.points[3].z() = 1e-14 * size;
    EXPECT_TRUE(contains(error_of(thin), "1 of the tetrahedra has no volume")) << error_of(thin);
  }
}

TEST_P(AnyOrder, TheBoundaryIsClosedAndFacesOutward) {
  TetMesh mesh = box();
  warp_curved(mesh, wavy({3, 4, 5}));
  const auto triangles = boundary_triangles(mesh);
  EXPECT_EQ(triangles.size(), 2U * 2 * (3 * 2 + 3 * 2 + 2 * 2));
  double enclosed = 0;
  Vec3 area = Vec3::Zero();
  std::set<std::pair<Index, Index>> edges;
  for (const auto& t : triangles) {
    const Vec3& a = mesh.points[t[0]];
    const Vec3& b = mesh.points[t[1]];
    const Vec3& c = mesh.points[t[2]];
    enclosed += a.cross(b).dot(c) / 6;
    area += (b - a).cross(c - a) / 2;
    for (int i = 0; i < 3; ++i) {
      EXPECT_TRUE(edges.insert({t[i], t[(i + 1) % 3]}).second) << "an edge twice in one direction";
    }
  }
  for (const auto& [a, b] : edges) EXPECT_EQ(edges.count({b, a}), 1U) << "an open edge";
  EXPECT_NEAR(enclosed, volume(mesh), kRounding * volume(mesh));
  EXPECT_LT(area.norm(), kRounding * 100);
}

TEST_P(AnyOrder, FacesHaveTheirMidsideNodesInOrder) {
  const TetMesh mesh = box();
  const auto faces = boundary_faces(mesh);
  const int size = nodes_per_face(mesh.order);
  EXPECT_EQ(faces.size(), boundary_triangles(mesh).size() * size);
  if (mesh.order == ElementOrder::linear) return;
  for (std::size_t i = 0; i < faces.size(); i += size) {
    for (int e = 0; e < 3; ++e) {
      const Vec3 ends = mesh.points[faces[i + e]] + mesh.points[faces[i + (e + 1) % 3]];
      EXPECT_LT((mesh.points[faces[i + 3 + e]] - ends / 2).norm(), kRounding);
    }
  }
}

TEST_P(AnyOrder, BoundaryPointsAreThoseOnTheFacesOfTheBox) {
  const TetMesh mesh = box();
  const auto on_boundary = boundary_points(mesh);
  const Vec3 size(3, 4, 5);
  for (Index p = 0; p < mesh.num_points(); ++p) {
    const Vec3& x = mesh.points[p];
    const bool outside = (x.array() == 0).any() || (x.array() == size.array()).any();
    EXPECT_EQ(on_boundary[p] != 0, outside) << "point " << p;
  }
}

TEST_P(AnyOrder, PointsOfNoCellAreNotInUse) {
  TetMesh mesh = box();
  mesh.points.insert(mesh.points.end(), {Vec3(9, 9, 9), Vec3(0, 0, 0)});
  check_and_orient(mesh);
  const auto used = points_in_use(mesh);
  ASSERT_EQ(used.size(), mesh.points.size());
  EXPECT_EQ(std::count(used.begin(), used.end(), 0), 2);
  EXPECT_EQ(used.end()[-1], 0);
  EXPECT_EQ(used.end()[-2], 0);
  EXPECT_EQ(boundary_points(mesh).end()[-1], 0);
}

}  // namespace
}  // namespace palpate::test::test_tet_mesh
