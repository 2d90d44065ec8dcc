// SPDX-License-Identifier: BSD-3-Clause
// Recovery of the pressures of mixed cells. The pressure p of a cell is linear, so its gradient is
// constant there; the recovered gradient g_a at corner a is that of a linear polynomial that is
// fitted to the gradients of the cells around, as in gradient_recovery.h. With it the pressure is
// recovered as a quadratic function:
//
//   p* = Σ_a λ_a (p_a + ½ g_a · (x − x_a)),   p* − p = ½ Σ_a λ_a g_a · (x − x_a)
//
// with the barycentric coordinates λ_a. It is exact for pressures that are quadratic.
#pragma once

#include <Eigen/SparseCore>
#include <vector>

#include "mesh/tet_mesh.h"

namespace palpate {

class PressureRecovery {
 public:
  /// @param pressures_of_corners See Assembly::pressures_of_corners().
  /// @param num_pressures 0: no cell is mixed.
  PressureRecovery(const TetMesh& mesh, std::vector<Index> pressures_of_corners,
                   Index num_pressures);

  /// The pressure at each quadrature point (quadrature() in elements/tetrahedron.h), cell by cell,
  /// Pa; 0 where a cell is not mixed.
  /// @param p The pressures [num_pressures], Pa.
  [[nodiscard]] NodalVector at_points(const Eigen::Ref<const NodalVector>& p) const;
  /// p* − p there, a linear function of p.
  [[nodiscard]] NodalVector errors(const Eigen::Ref<const NodalVector>& p) const;

 private:
  [[nodiscard]] Index pressure(Index cell, int corner) const {
    return pressures_of_corners_[4 * static_cast<std::size_t>(cell) +
                                 static_cast<std::size_t>(corner)];
  }
  /// The value of a mixed cell at each quadrature point, by the point's λ; 0 in other cells.
  template <class Value>
  [[nodiscard]] NodalVector at_each_point(Value&& value) const;
  void make_gradients(const TetMesh& mesh, Index num_pressures);

  std::vector<Index> pressures_of_corners_;
  /// The places of the corners of all cells [3 × 4 num_cells], m.
  Eigen::Matrix3Xd corners_;
  /// λ at the quadrature points of a cell.
  std::vector<Eigen::Vector4d> shares_;
  /// The recovered gradients of the pressures [3 num_pressures × num_pressures], 1/m.
  Eigen::SparseMatrix<double, Eigen::RowMajor> gradients_;
};

}  // namespace palpate
