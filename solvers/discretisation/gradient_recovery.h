// SPDX-License-Identifier: BSD-3-Clause
// Recovery of the displacement gradient: a field that is continuous within each tissue, and nearer
// to the true gradient than that of the cells, which jumps from cell to cell (Zienkiewicz & Zhu,
// The superconvergent patch recovery and a posteriori error estimates, Int. J. Numer. Methods Eng.
// 33, 1992).
//
// A patch is a corner of the mesh with the cells of one tissue around it, and those around these
// where they are too few or do not determine the fit. A polynomial of the
// degree of the shape functions is fitted to the gradients at the quadrature points of the patch by
// least squares. At a node, the recovered gradient is the mean of the polynomials of the corners
// that it belongs to; between nodes it is interpolated by the shape functions. Across the border of
// two tissues the gradient jumps, so each tissue has values of its own there.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mesh/tet_mesh.h"

namespace palpate {

/// Tensors at points, a column each, row by row [9 × points].
using Gradients = Eigen::Matrix<double, 9, Eigen::Dynamic>;

class GradientRecovery {
 public:
  /// @param tissue_of_cell The tissue of each cell [num_cells]; empty: there is one.
  GradientRecovery(const TetMesh& mesh, const std::vector<Index>& tissue_of_cell);

  /// The quadrature points of a cell (quadrature() in elements/tetrahedron.h). All points are
  /// numbered cell by cell.
  [[nodiscard]] int points_per_cell() const { return points_per_cell_; }
  [[nodiscard]] Index num_points() const { return static_cast<Index>(weights_.size()); }
  /// The weight of each point, m³ [num_points()].
  [[nodiscard]] const std::vector<double>& weights() const { return weights_; }
  /// ∇u at the points.
  /// @param u The displacement of each point of the mesh [3 × mesh points], m; there may be more
  ///   rows below, which are not read.
  [[nodiscard]] Gradients gradients(const Eigen::Ref<const NodalVector>& u) const;
  /// The recovered gradient at the points, a linear function of the gradients there.
  [[nodiscard]] Gradients recover(const Gradients& at_points) const;

 private:
  /// A node of one tissue.
  struct Node {
    /// The points that its value is computed from, and their weights, which add up to 1.
    std::vector<Index> points;
    std::vector<double> weights;
  };

  void make_gradients(const TetMesh& mesh);
  void make_nodes(const TetMesh& mesh, const std::vector<Index>& tissue_of_cell);

  int nodes_per_cell_;
  int points_per_cell_;
  std::vector<Index> mesh_nodes_;
  /// ∂N_a/∂X at each point [3 × (points × nodes_per_cell)], 1/m.
  Eigen::Matrix3Xd shape_gradients_;
  /// N_a at the points of a cell [nodes_per_cell × points_per_cell].
  Eigen::MatrixXd shape_;
  std::vector<double> weights_;
  std::vector<Vec3> places_;
  std::vector<Node> nodes_;
  /// The place in nodes_ of each node of each cell [num_cells × nodes_per_cell].
  std::vector<Index> node_of_cell_;
};

}  // namespace palpate
