// SPDX-License-Identifier: BSD-3-Clause
// Shape functions and quadrature of the linear (Tet4) and the quadratic (Tet10) tetrahedron on the
// reference element with corners 0, e_x, e_y, e_z. Node order as in TetMesh.
#pragma once

#include <vector>

#include "base/types.h"
#include "mesh/tet_mesh.h"

namespace palpate {

struct QuadraturePoint {
  /// The point in reference coordinates.
  Vec3 xi;
  /// The weight of the point; the weights of an element add up to the reference volume 1/6.
  double weight;
};

/// The quadrature points of an element: one point for Tet4, which is exact for its constant strain,
/// and the 4-point rule of degree 2 for Tet10 (Keast 1986), ordered by the corner that each point
/// is nearest to.
[[nodiscard]] const std::vector<QuadraturePoint>& quadrature(ElementOrder order);

/// A rule of degree 5 (15 points, Walkington 2000), with positive weights: exact for the product of
/// two shape functions of Tet10.
[[nodiscard]] const std::vector<QuadraturePoint>& fine_quadrature();

/// The gradients ∂N_a/∂ξ of the shape functions at xi [nodes_per_cell × 3].
[[nodiscard]] Eigen::Matrix<double, Eigen::Dynamic, 3> shape_gradients(ElementOrder order,
                                                                       const Vec3& xi);

/// The shape functions N_a at xi [nodes_per_cell].
[[nodiscard]] Eigen::VectorXd shape_values(ElementOrder order, const Vec3& xi);

}  // namespace palpate
