// SPDX-License-Identifier: BSD-3-Clause
// A symmetric matrix that couples points, the same for the three components, such as that of mass
// or of springs. Points that it couples are of one cell, so that it is added to a tangent on the
// pattern of the assembly.
#pragma once

#include <Eigen/SparseCore>
#include <array>
#include <vector>

#include "assembly/assembly.h"

namespace palpate {

/// Where the values of the 3 × 3 block of two points are in those of a tangent: of the block's
/// three columns, that of its first row, and on the diagonal that of the diagonal itself.
/// @param row, column The first unknown of each point; row ≥ column.
[[nodiscard]] std::array<Index, 3> block_positions(const SymmetricPattern& pattern, Index row,
                                                   Index column);

/// Calls visit(row, column, position) for what is stored of a 3 × 3 block, where its values are:
/// all of it, or on the diagonal its lower half.
/// @param positions As block_positions() gives them.
template <class Visit>
void for_each_in_block(const std::array<Index, 3>& positions, bool is_diagonal,
                       const Visit& visit) {
  for (int column = 0; column < 3; ++column) {
    const int first = is_diagonal ? column : 0;
    for (int row = first; row < 3; ++row) visit(row, column, positions[column] + row - first);
  }
}

class PointMatrix {
 public:
  /// @param triplets Of points; those of a pair add up.
  PointMatrix(const std::vector<Eigen::Triplet<double>>& triplets, const Assembly& assembly);

  /// A x for a change of the state: zero for pressures.
  /// @param x [at least 3 num_points] @returns [state_size]
  [[nodiscard]] NodalVector times(const NodalVector& x) const;
  /// values += factor A, on the pattern of the assembly.
  void add_to(double factor, std::vector<double>& values) const;
  /// [num_points × num_points].
  [[nodiscard]] const Eigen::SparseMatrix<double, Eigen::RowMajor>& of_points() const {
    return of_points_;
  }

 private:
  /// The place in the values of a tangent of each component of a pair of points.
  struct Target {
    std::array<Index, 3> positions;
    double value;
  };

  Index state_size_;
  Eigen::SparseMatrix<double, Eigen::RowMajor> of_points_;
  std::vector<Target> targets_;
};

}  // namespace palpate
