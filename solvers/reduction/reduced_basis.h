// SPDX-License-Identifier: BSD-3-Clause
// The basis of a reduced model: modes that are orthonormal in the stiffness K₀ of the body at rest,
// see reduced/reduced_model.h.
#pragma once

#include <Eigen/SparseCore>
#include <vector>

#include "assembly/assembly.h"
#include "assembly/point_matrix.h"

namespace palpate {

/// K₀ for the displacements of all points.
class RestStiffness {
 public:
  /// @param rest u_r [3 num_points], m; empty: the body at rest is not deformed.
  /// @param springs Springs that support the body; null: there are none.
  explicit RestStiffness(const Assembly& assembly, const NodalVector& rest = {},
                         const PointMatrix* springs = nullptr);

  /// K₀ x; zero at fixed points.
  /// @param x [3 num_points × any], m.
  [[nodiscard]] Eigen::MatrixXd times(const Eigen::MatrixXd& x) const;

 private:
  std::vector<Index> state_of_unknown_;
  /// The lower triangle.
  Eigen::SparseMatrix<double> matrix_;
};

/// Removes rounding from a basis along directions in which points are held: a mode of little energy
/// is scaled up, and its rounding with it.
/// @param basis [3 num_points × any].
void hold_directions(const Body& body, Eigen::MatrixXd& basis);

/// Makes modes group by group.
class ModeBuilder {
 public:
  /// @param stiffness It must outlive this object.
  ModeBuilder(const RestStiffness& stiffness, Eigen::Index num_rows);

  /// Adds the first POD modes of the part of the fields that is orthogonal to the present modes.
  /// @param fields [num_rows × any], m.
  /// @param most The largest number of new modes. There are fewer if the fields have fewer
  ///   directions.
  void add(Eigen::MatrixXd fields, Eigen::Index most);

  /// Φ [num_rows × n], m/√J.
  [[nodiscard]] const Eigen::MatrixXd& modes() const { return modes_; }
  /// Φᵀ K₀ x for each column.
  [[nodiscard]] Eigen::MatrixXd coordinates(const Eigen::MatrixXd& x) const;

 private:
  const RestStiffness& stiffness_;
  Eigen::MatrixXd modes_;
  /// K₀ Φ.
  Eigen::MatrixXd of_modes_;
};

}  // namespace palpate
