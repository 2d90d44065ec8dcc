// SPDX-License-Identifier: BSD-3-Clause
// The least det F of a quadratic displacement is where it should be, in the corners too; and no
// inversion between them escapes.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <limits>
#include <vector>

#include "assembly/assembly.h"
#include "elements/tetrahedron.h"
#include "solvers/support/bezier.h"
#include "solvers/support/block.h"
#include "solvers/support/box_mesh.h"
#include "solvers/support/deformation.h"
#include "solvers/support/laws.h"
#include "solvers/support/random.h"

namespace palpate::test::test_determinant {
namespace {

/// u_i = x · a_i x: F = I + 2 (a_i x) is exact on straight Tet10 cells.
struct QuadraticField {
  Mat3 a[3];

  Vec3 u(const Vec3& x) const { return {x.dot(a[0] * x), x.dot(a[1] * x), x.dot(a[2] * x)}; }
  double det_f(const Vec3& x) const {
    Mat3 f = Mat3::Identity();
    for (int i = 0; i < 3; ++i) f.row(i) += ((a[i] + a[i].transpose()) * x).transpose();
    return f.determinant();
  }
};

TEST(Determinant, IsTheLeastOverQuadraturePointsAndCorners) {
  Random random(31);
  int in_a_corner = 0;
  constexpr int kTrials = 4 * num_laws;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Law law{trial % num_laws};
    const Scene scene = make_block(law).scene;
    const Assembly assembly(scene);
    QuadraticField field;
    for (Mat3& a : field.a) a = random.matrix(2 * trial < kTrials ? 1.0 : 4.0);  // 4: det F < 0

    NodalVector u = NodalVector::Zero(assembly.state_size());
    for (Index p = 0; p < scene.body.mesh.num_points(); ++p) {
      u.segment<3>(3 * p) = field.u(scene.body.mesh.points[p]);
    }
    double least = std::numeric_limits<double>::max();
    double at_quadrature = least;
    Index where = -1;
    Index num_inverted = 0;
    Index num_between = 0;
    for (Index c = 0; c < scene.body.mesh.num_cells(); ++c) {
      const Index* cell = scene.body.mesh.cell(c);
      double least_of_cell = std::numeric_limits<double>::max();
      for (const auto& point : quadrature(ElementOrder::quadratic)) {
        const Eigen::VectorXd n = shape_values(ElementOrder::linear, point.xi);
        Vec3 x = Vec3::Zero();
        for (int i = 0; i < 4; ++i) x += n[i] * scene.body.mesh.points[cell[i]];
        least_of_cell = std::min(least_of_cell, field.det_f(x));
      }
      at_quadrature = std::min(at_quadrature, least_of_cell);
      for (int i = 0; i < 4; ++i) {
        least_of_cell = std::min(least_of_cell, field.det_f(scene.body.mesh.points[cell[i]]));
      }
      if (least_of_cell > 0 && is_inverted(corner_jacobians(scene.body.mesh, c, u))) {
        ++num_between;
      } else if (least_of_cell <= 0) {
        ++num_inverted;
      }
      if (least_of_cell < least) {
        least = least_of_cell;
        where = c;
      }
    }
    // Coordinates of 0.1 and gradients of order one: some ε.
    const auto found = assembly.minimum_det_f(u);
    if (num_between == 0) {
      EXPECT_NEAR(found.value, least, 1e-13);
    } else {
      EXPECT_LE(found.value, std::min(0.0, least) + 1e-13);
    }
    EXPECT_EQ(found.num_inverted_cells, num_inverted + num_between);
    NodalVector force;
    const double known = law == Law::linear ? 1 : at_quadrature;
    EXPECT_NEAR(assembly.residual(u, force).minimum_det_f, known, 1e-13) << to_string(law);
    if (least < at_quadrature) ++in_a_corner;
    // A corner belongs to several cells, which see the same value but for rounding.
    const auto has = [&](Index cell, Index p) {
      return std::find(scene.body.mesh.cell(cell), scene.body.mesh.cell(cell) + 4, p) !=
             scene.body.mesh.cell(cell) + 4;
    };
    bool touches = false;
    for (int i = 0; i < 4; ++i)
      touches = touches || has(found.cell, scene.body.mesh.cell(where)[i]);
    EXPECT_TRUE(touches || num_between > 0)
        << "cell " << found.cell << " is far from cell " << where;
  }
  EXPECT_GT(in_a_corner, kTrials / 2) << "this test would not notice corners that are left out";
}

/// A Tet10 with straight or curved edges that is nowhere inverted at rest.
TetMesh one_cell(bool curved, Random& random) {
  TetMesh straight;
  straight.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  straight.cells = {0, 1, 2, 3};
  straight = with_midside_nodes(straight);
  for (;;) {
    TetMesh mesh = straight;
    for (Vec3& point : mesh.points) {
      if (curved) point += random.vector(3, 0.05);
    }
    const NodalVector none = NodalVector::Zero(3 * Eigen::Index{mesh.num_points()});
    if (!is_inverted(corner_jacobians(mesh, 0, none))) return mesh;
  }
}

// det F of a Tet10 is no less than the least of its 20 Bézier coefficients, and parts of the cell
// have better bounds. What is said to be positive is so everywhere, and what is not is so
// somewhere.
TEST(Determinant, HasTheSignOfTheBezierBound) {
  Random random(32);
  int num_inverted = 0;
  int num_between = 0;
  constexpr int kTrials = 4000;
  for (int trial = 0; trial < kTrials; ++trial) {
    const TetMesh mesh = one_cell(trial % 2 == 0, random);
    const Assembly assembly(make_scene(mesh, make_isotropic(Law::st_venant_kirchhoff, 1, 0.3),
                                       std::vector<char>(mesh.points.size(), 0)));
    const NodalVector u = random.vector(3 * Eigen::Index{mesh.num_points()}, 0.14);
    const bool inverted = is_inverted(corner_jacobians(mesh, 0, u));
    EXPECT_EQ(assembly.minimum_det_f(u).value <= 0, inverted) << trial;
    if (inverted) ++num_inverted;
    if (inverted && least_det_f(mesh, u) > 0) ++num_between;
    if (inverted) continue;
    // What is positive by its bound is positive wherever one looks.
    for (int i = 0; i < 20; ++i) {
      Eigen::Vector4d place = random.vector(4, 1).cwiseAbs();
      place /= place.sum();
      at_place(mesh, 0, place.tail<3>(), [&](const auto& gradients, double) {
        EXPECT_GT(deformation_gradient(mesh, 0, gradients, u).determinant(), 0) << trial;
      });
    }
  }
  EXPECT_GT(num_inverted, kTrials / 10);
  EXPECT_LT(num_inverted, 9 * kTrials / 10);
  // About one random cell in two hundred.
  EXPECT_GT(num_between, kTrials / 400) << "quadrature points and corners would do";
}

}  // namespace
}  // namespace palpate::test::test_determinant
