// SPDX-License-Identifier: BSD-3-Clause
#include "discretisation/gradient_recovery.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "elements/tetrahedron.h"
#include "solvers/support/box_mesh.h"

namespace palpate::test::test_gradient_recovery {
namespace {

const Vec3 kSize(0.3, 0.2, 0.2);

TetMesh make_mesh(ElementOrder order) {
  TetMesh mesh = test::make_box(order, {3, 2, 2}, kSize);
  test::warp_straight(mesh, test::wavy(kSize));
  check_and_orient(mesh);
  return mesh;
}

/// The places of the quadrature points.
std::vector<Vec3> places(const TetMesh& mesh) {
  std::vector<Vec3> places;
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    for (const QuadraturePoint& point : quadrature(mesh.order)) {
      const Eigen::VectorXd shape = shape_values(mesh.order, point.xi);
      Vec3& x = places.emplace_back(Vec3::Zero());
      for (int a = 0; a < nodes_per_cell(mesh.order); ++a) {
        x += shape[a] * mesh.points[mesh.cell(c)[a]];
      }
    }
  }
  return places;
}

/// Polynomials of the degree of the shape functions, another one for each component.
Gradients polynomials(const std::vector<Vec3>& places, ElementOrder order) {
  Gradients values(9, places.size());
  for (std::size_t p = 0; p < places.size(); ++p) {
    const Vec3 x = places[p] / kSize.x();
    for (int m = 0; m < 9; ++m) {
      const Vec3 slope(0.3 - 0.1 * m, 0.2 * m, 1 - 0.2 * m);
      double value = 0.5 * m - 1 + slope.dot(x);
      if (order == ElementOrder::quadratic) value += slope.dot(x) * (x.x() - m * x.y() + x.z());
      values(m, static_cast<Eigen::Index>(p)) = value;
    }
  }
  return values;
}

class Each : public testing::TestWithParam<ElementOrder> {};
INSTANTIATE_TEST_SUITE_P(GradientRecovery, Each,
                         testing::Values(ElementOrder::linear, ElementOrder::quadratic),
                         [](const auto& of) {
                           return of.param == ElementOrder::linear ? "Tet4" : "Tet10";
                         });

TEST_P(Each, LeavesPolynomialsAsTheyAre) {
  const TetMesh mesh = make_mesh(GetParam());
  const GradientRecovery recovery(mesh, {});
  const Gradients exact = polynomials(places(mesh), GetParam());
  EXPECT_LT((recovery.recover(exact) - exact).cwiseAbs().maxCoeff(), 1e-11);
}

TEST_P(Each, GradientsAreThoseOfTheDisplacement) {
  const TetMesh mesh = make_mesh(GetParam());
  const GradientRecovery recovery(mesh, {});
  Mat3 h;
  h << 0.1, -0.2, 0.3, 0.05, 0.2, -0.1, 0.4, 0.15, -0.3;
  NodalVector u(3 * mesh.num_points());
  for (Index p = 0; p < mesh.num_points(); ++p) u.segment<3>(3 * p) = h * mesh.points[p];
  const Gradients gradients = recovery.gradients(u);
  for (int m = 0; m < 9; ++m) {
    EXPECT_LT((gradients.row(m).array() - h(m / 3, m % 3)).abs().maxCoeff(), 1e-13);
  }
  double sum = 0;
  for (const double weight : recovery.weights()) sum += weight;
  EXPECT_NEAR(sum, volume(mesh), 1e-12 * sum);
}

TEST_P(Each, JumpsBetweenTissues) {
  const TetMesh mesh = make_mesh(GetParam());
  std::vector<Index> tissues;
  for (Index c = 0; c < mesh.num_cells(); ++c) tissues.push_back(c % 36 < 12 ? 1 : 0);
  const GradientRecovery recovery(mesh, tissues);
  Gradients jumps(9, recovery.num_points());
  for (Eigen::Index p = 0; p < jumps.cols(); ++p) {
    jumps.col(p).setConstant(1 + 5.0 * tissues[p / recovery.points_per_cell()]);
  }
  EXPECT_LT((recovery.recover(jumps) - jumps).cwiseAbs().maxCoeff(), 1e-11);
  const GradientRecovery of_one(mesh, {});
  EXPECT_GT((of_one.recover(jumps) - jumps).cwiseAbs().maxCoeff(), 0.1);
}

TEST_P(Each, ASingleCellHasItsMean) {
  TetMesh mesh = make_mesh(GetParam());
  mesh.cells.resize(nodes_per_cell(mesh.order));
  const GradientRecovery recovery(mesh, {});
  const Gradients exact = polynomials(places(mesh), ElementOrder::linear);
  EXPECT_TRUE(recovery.recover(exact).allFinite());
  const Gradients constant = Gradients::Constant(9, recovery.num_points(), 3);
  EXPECT_LT((recovery.recover(constant) - constant).cwiseAbs().maxCoeff(), 1e-12);
}

}  // namespace
}  // namespace palpate::test::test_gradient_recovery
