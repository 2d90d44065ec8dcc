// SPDX-License-Identifier: BSD-3-Clause
// What a displacement does to the cells of a body, by the shape functions alone.
#pragma once

#include <Eigen/LU>
#include <algorithm>
#include <vector>

#include "elements/tetrahedron.h"

namespace palpate::test {

/// Calls f(gradients by place at rest [nodes × 3], Jacobian of the reference element) at a place
/// of a cell.
template <class F>
void at_place(const TetMesh& mesh, Index cell, const Vec3& xi, F&& f) {
  const auto by_xi = shape_gradients(mesh.order, xi);
  Mat3 jacobian = Mat3::Zero();
  for (Eigen::Index a = 0; a < by_xi.rows(); ++a) {
    jacobian += mesh.points[mesh.cell(cell)[a]] * by_xi.row(a);
  }
  const Eigen::Matrix<double, Eigen::Dynamic, 3> gradients = by_xi * jacobian.inverse();
  f(gradients, jacobian.determinant());
}

inline Mat3 deformation_gradient(const TetMesh& mesh, Index cell,
                                 const Eigen::Matrix<double, Eigen::Dynamic, 3>& gradients,
                                 const NodalVector& u) {
  Mat3 f = Mat3::Identity();
  for (Eigen::Index a = 0; a < gradients.rows(); ++a) {
    f += u.segment<3>(3 * mesh.cell(cell)[a]) * gradients.row(a);
  }
  return f;
}

/// Least det F over quadrature points and corners of all cells.
inline double least_det_f(const TetMesh& mesh, const NodalVector& u) {
  std::vector<Vec3> places = {Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};
  for (const QuadraturePoint& q : quadrature(mesh.order)) places.push_back(q.xi);
  double least = 1e300;
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    for (const Vec3& xi : places) {
      at_place(mesh, c, xi, [&](const auto& gradients, double) {
        least = std::min(least, deformation_gradient(mesh, c, gradients, u).determinant());
      });
    }
  }
  return least;
}

/// ∫ (det F − 1) over the volume, by the quadrature of the cells.
inline double relative_change_of_volume(const TetMesh& mesh, const NodalVector& u) {
  double change = 0;
  double volume_at_rest = 0;
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    for (const QuadraturePoint& q : quadrature(mesh.order)) {
      at_place(mesh, c, q.xi, [&](const auto& gradients, double jacobian) {
        const double volume = q.weight * jacobian;
        change += volume * (deformation_gradient(mesh, c, gradients, u).determinant() - 1);
        volume_at_rest += volume;
      });
    }
  }
  return change / volume_at_rest;
}

}  // namespace palpate::test
