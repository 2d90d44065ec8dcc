// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/refinement.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <vector>

#include "elements/tetrahedron.h"
#include "solvers/support/bodies.h"
#include "solvers/support/box_mesh.h"
#include "solvers/support/orders.h"

namespace palpate::test::test_refinement {
namespace {

constexpr double kRounding = 1e-12;
const Vec3 kSize(0.3, 0.2, 0.2);

/// 1 for the cells one of whose corners is near a place.
std::vector<char> near(const TetMesh& mesh, const Vec3& place, double distance) {
  std::vector<char> chosen;
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    const Index* cell = mesh.cell(c);
    chosen.push_back(std::any_of(
        cell, cell + 4, [&](Index p) { return (mesh.points[p] - place).norm() < distance; }));
  }
  return chosen;
}

std::vector<double> volumes(const TetMesh& mesh) {
  std::vector<double> volumes;
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    const Index* cell = mesh.cell(c);
    const auto edge = [&](int a) -> Vec3 { return mesh.points[cell[a]] - mesh.points[cell[0]]; };
    volumes.push_back(edge(1).cross(edge(2)).dot(edge(3)) / 6);
  }
  return volumes;
}

/// How many cells have each triangle of corners.
std::map<std::set<Index>, int> uses_of_faces(const TetMesh& mesh) {
  std::map<std::set<Index>, int> uses;
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    for (int left_out = 0; left_out < 4; ++left_out) {
      std::set<Index> face;
      for (int a = 0; a < 4; ++a) {
        if (a != left_out) face.insert(mesh.cell(c)[a]);
      }
      ++uses[face];
    }
  }
  return uses;
}

double area_of_surface(const TetMesh& mesh) {
  double area = 0;
  for (const auto& [a, b, c] : boundary_triangles(mesh)) {
    const Vec3& p = mesh.points[a];
    area += (mesh.points[b] - p).cross(mesh.points[c] - p).norm() / 2;
  }
  return area;
}

/// The place of the reference coordinates xi in a cell.
Vec3 place_in(const TetMesh& mesh, Index cell, const Vec3& xi) {
  const Eigen::VectorXd shape = shape_values(mesh.order, xi);
  Vec3 x = Vec3::Zero();
  for (int a = 0; a < nodes_per_cell(mesh.order); ++a)
    x += shape[a] * mesh.points[mesh.cell(cell)[a]];
  return x;
}

class RefinementOfAnyOrder : public testing::TestWithParam<ElementOrder> {
 protected:
  [[nodiscard]] TetMesh box() const {
    TetMesh mesh = make_box(GetParam(), {3, 2, 2}, kSize);
    warp_straight(mesh, wavy_inside(kSize));
    return mesh;
  }
};
INSTANTIATE_TEST_SUITE_P(Refinement, RefinementOfAnyOrder, testing::ValuesIn(kOrders),
                         name_of_order);

TEST_P(RefinementOfAnyOrder, PartsFillTheirCells) {
  const TetMesh mesh = box();
  const Refinement fine = refine(mesh, near(mesh, Vec3::Zero(), 0.12));
  ASSERT_GT(fine.mesh.num_cells(), mesh.num_cells());
  ASSERT_EQ(fine.parents.size(), static_cast<std::size_t>(fine.mesh.num_cells()));
  const std::vector<double> of_cells = volumes(mesh);
  const std::vector<double> of_parts = volumes(fine.mesh);
  std::vector<double> sums(of_cells.size(), 0);
  for (std::size_t i = 0; i < of_parts.size(); ++i) {
    EXPECT_GT(of_parts[i], 0);
    sums[fine.parents[i]] += of_parts[i];
  }
  for (std::size_t c = 0; c < sums.size(); ++c) {
    EXPECT_NEAR(sums[c], of_cells[c], kRounding * of_cells[c]);
  }
  EXPECT_TRUE(std::is_sorted(fine.parents.begin(), fine.parents.end()));
}

TEST_P(RefinementOfAnyOrder, CellsShareWholeFaces) {
  TetMesh mesh = box();
  const double area = area_of_surface(mesh);
  for (int round = 0; round < 4; ++round) {
    mesh = refine(mesh, near(mesh, Vec3(0.1, 0.07, 0.2), 0.1 / (1 << round))).mesh;
    for (const auto& [face, uses] : uses_of_faces(mesh)) EXPECT_LE(uses, 2);
    // A face that is divided on one side alone would be on the surface twice.
    EXPECT_NEAR(area_of_surface(mesh), area, kRounding * area);
    const std::vector<char> used = points_in_use(mesh);
    EXPECT_EQ(std::count(used.begin(), used.end(), 0), 0);
  }
}

TEST_P(RefinementOfAnyOrder, PointsOfBeforeStayAndNewOnesSayWhereTheyAre) {
  TetMesh mesh = box();
  if (mesh.order == ElementOrder::quadratic) warp_curved(mesh, wavy(kSize));
  const Refinement fine = refine(mesh, near(mesh, kSize, 0.15));
  ASSERT_EQ(fine.mesh.points.size(), mesh.points.size() + fine.new_points.size());
  for (std::size_t p = 0; p < mesh.points.size(); ++p) {
    EXPECT_EQ(fine.mesh.points[p], mesh.points[p]);
  }
  for (std::size_t i = 0; i < fine.new_points.size(); ++i) {
    const Refinement::Place& place = fine.new_points[i];
    EXPECT_NEAR(place.barycentric.sum(), 1, kRounding);
    const Vec3 expected = place_in(mesh, place.cell, place.barycentric.tail<3>());
    EXPECT_LE((fine.mesh.points[mesh.points.size() + i] - expected).norm(), kRounding);
  }
}

TEST_P(RefinementOfAnyOrder, ADisplacementIsCarriedAsItIs) {
  const TetMesh mesh = box();
  // What the shape functions can represent.
  const auto field = [&](const Vec3& x) -> Vec3 {
    const Vec3 linear(x.y() + 2 * x.z(), 1 - x.x(), 0.5 * x.y());
    return mesh.order == ElementOrder::quadratic ? Vec3(linear + x.squaredNorm() * Vec3(1, 2, 3))
                                                 : linear;
  };
  NodalVector u(3 * static_cast<Eigen::Index>(mesh.num_points()));
  for (Index p = 0; p < mesh.num_points(); ++p) {
    u.segment<3>(3 * Eigen::Index{p}) = field(mesh.points[p]);
  }
  const Refinement fine = refine(mesh, near(mesh, kSize, 0.15));
  const NodalVector of_fine = carried(mesh, fine, u);
  ASSERT_EQ(of_fine.size(), 3 * static_cast<Eigen::Index>(fine.mesh.num_points()));
  for (Index p = 0; p < fine.mesh.num_points(); ++p) {
    const Vec3 found = of_fine.segment<3>(3 * Eigen::Index{p});
    EXPECT_LE((found - field(fine.mesh.points[p])).norm(), kRounding);
  }
}

// Curved cells, too: a part maps its reference cell into that of its parent by an affine map.
TEST(Refinement, PartsOfACurvedCellAreItsOwn) {
  TetMesh mesh = make_box(ElementOrder::quadratic, {2, 1, 1}, kSize);
  warp_curved(mesh, wavy(kSize));
  const Refinement fine = refine_all(mesh);
  EXPECT_EQ(fine.mesh.num_cells(), 8 * mesh.num_cells());
  const auto place_of = [&](Index part, int corner) -> Vec3 {
    const Index point = fine.mesh.cell(part)[corner];
    const Index parent = fine.parents[part];
    for (int a = 0; a < 10; ++a) {
      if (mesh.cell(parent)[a] != point) continue;
      Vec3 xi = Vec3::Zero();
      for (int i = 0; i < 4; ++i) {
        const bool is_end = a < 4 ? a == i : (kTetEdges[a - 4][0] == i || kTetEdges[a - 4][1] == i);
        if (i > 0 && is_end) xi[i - 1] = a < 4 ? 1 : 0.5;
      }
      return xi;
    }
    ADD_FAILURE() << "a corner is none of the parent's nodes";
    return Vec3::Zero();
  };
  for (Index part = 0; part < fine.mesh.num_cells(); ++part) {
    std::array<Vec3, 4> corners;
    for (int a = 0; a < 4; ++a) corners[a] = place_of(part, a);
    for (const QuadraturePoint& point : fine_quadrature()) {
      Vec3 xi = (1 - point.xi.sum()) * corners[0];
      for (int a = 1; a < 4; ++a) xi += point.xi[a - 1] * corners[a];
      const Vec3 expected = place_in(mesh, fine.parents[part], xi);
      EXPECT_LE((place_in(fine.mesh, part, point.xi) - expected).norm(), kRounding);
    }
  }
}

TEST_P(RefinementOfAnyOrder, OthersAreDividedOnlyAsNeeded) {
  const TetMesh mesh = box();
  const Refinement none = refine(mesh, std::vector<char>(mesh.num_cells(), 0));
  EXPECT_EQ(none.mesh.cells, mesh.cells);
  EXPECT_TRUE(none.new_points.empty());

  std::vector<char> first(mesh.num_cells(), 0);
  first[0] = 1;
  const Refinement one = refine(mesh, first);
  EXPECT_EQ(std::count(one.parents.begin(), one.parents.end(), 0), 8);
  const Index last = mesh.num_cells() - 1;
  EXPECT_EQ(std::count(one.parents.begin(), one.parents.end(), last), 1);
}

// Again and again at a corner: the shapes stay as good.
TEST(Refinement, KeepsTheShapesOfCells) {
  TetMesh mesh = make_box(ElementOrder::linear, {3, 2, 2}, kSize);
  warp_straight(mesh, wavy(kSize));
  const double angle = least_dihedral_angle(mesh);
  double distance = 0.1;
  for (int round = 0; round < 12; ++round, distance /= 2) {
    mesh = refine(mesh, near(mesh, mesh.points[0], distance)).mesh;
  }
  EXPECT_LT(mesh.num_cells(), 20000);
  EXPECT_GT(least_dihedral_angle(mesh), 0.4 * angle);
  const std::vector<double> of_cells = volumes(mesh);
  EXPECT_LT(*std::min_element(of_cells.begin(), of_cells.end()), 1e-12);
}

}  // namespace
}  // namespace palpate::test::test_refinement
