// SPDX-License-Identifier: BSD-3-Clause
// The sign of det F over a whole cell, rigorously. The map ξ → x of a Tet10 is quadratic, so that
// ∂x/∂ξ is linear in the barycentric coordinates λ and its determinant a polynomial of degree
// three,
//
//   det ∂x/∂ξ = Σ_abc λ_a λ_b λ_c det[(J_a)_1 (J_b)_2 (J_c)_3],   J_a: ∂x/∂ξ at corner a
//
// Its 20 Bézier coefficients, the means of these determinants over the orders of a, b and c, bound
// it from below and above (Johnen, Remacle & Geuzaine, Geometrical validity of curvilinear finite
// elements, J. Comput. Phys. 233, 2013). Where the bound leaves the sign open, the cell is halved.
#pragma once

#include <Eigen/LU>
#include <algorithm>
#include <array>

#include "elements/tetrahedron.h"
#include "solvers/support/deformation.h"

namespace palpate::test {

/// ∂x/∂ξ at the corners of a cell, or of a part of it.
using CornerJacobians = std::array<Mat3, 4>;

inline CornerJacobians corner_jacobians(const TetMesh& mesh, Index cell, const NodalVector& u) {
  CornerJacobians corners;
  const Vec3 places[4] = {Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};
  for (int corner = 0; corner < 4; ++corner) {
    const auto gradients = shape_gradients(mesh.order, places[corner]);
    corners[corner].setZero();
    for (Eigen::Index a = 0; a < gradients.rows(); ++a) {
      const Index node = mesh.cell(cell)[a];
      corners[corner] += (mesh.points[node] + u.segment<3>(3 * node)) * gradients.row(a);
    }
  }
  return corners;
}

/// The least of the 20 coefficients.
inline double least_bezier_coefficient(const CornerJacobians& corners) {
  double least = 1e300;
  for (int a = 0; a < 4; ++a) {
    for (int b = a; b < 4; ++b) {
      for (int c = b; c < 4; ++c) {
        std::array<int, 3> order = {a, b, c};
        double sum = 0;
        int number = 0;
        do {
          Mat3 columns;
          for (int i = 0; i < 3; ++i) columns.col(i) = corners[order[i]].col(i);
          sum += columns.determinant();
          ++number;
        } while (std::next_permutation(order.begin(), order.end()));
        least = std::min(least, sum / number);
      }
    }
  }
  return least;
}

/// Whether det ∂x/∂ξ ≤ 0 somewhere; also where it cannot be told after so many halvings.
inline bool is_inverted(const CornerJacobians& corners, int halvings = 60) {
  for (const Mat3& corner : corners) {
    if (corner.determinant() <= 0) return true;
  }
  if (least_bezier_coefficient(corners) > 0) return false;
  if (halvings == 0) return true;
  int from = 0;
  int to = 1;
  for (int a = 0; a < 4; ++a) {
    for (int b = a + 1; b < 4; ++b) {
      if ((corners[a] - corners[b]).norm() > (corners[from] - corners[to]).norm()) {
        from = a;
        to = b;
      }
    }
  }
  const Mat3 middle = (corners[from] + corners[to]) / 2;
  CornerJacobians first = corners;
  CornerJacobians second = corners;
  first[to] = second[from] = middle;
  return is_inverted(first, halvings - 1) || is_inverted(second, halvings - 1);
}

}  // namespace palpate::test
