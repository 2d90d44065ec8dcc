// SPDX-License-Identifier: BSD-3-Clause
// A symmetric matrix that couples points and is the same for the three components, such as the
// matrix of mass or of springs. It couples only points of one cell, so that it can be added to a
// tangent on the pattern of the assembly.
#pragma once

#include <Eigen/SparseCore>
#include <array>
#include <vector>

#include "assembly/assembly.h"

namespace palpate {

/// The positions of the 3 × 3 block of two points in the values of a tangent. For each of its three
/// columns this is the position of the first row or, in a diagonal block, of the diagonal.
/// @param row, column The first unknown of each point; row ≥ column.
[[nodiscard]] std::array<Index, 3> block_positions(const SymmetricPattern& pattern, Index row,
                                                   Index column);

/// Calls visit(row, column, position) for each stored value of a 3 × 3 block: for all of them, or
/// in a diagonal block for the lower half.
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
  /// @param triplets Entries of points; those of the same pair are added.
  PointMatrix(const std::vector<Eigen::Triplet<double>>& triplets, const Assembly& assembly);

  /// A x for a change of the state; zero for pressures.
  /// @param x [at least 3 num_points]
  /// @returns [state_size]
  [[nodiscard]] NodalVector times(const NodalVector& x) const;
  /// values += factor A, on the pattern of the assembly.
  void add_to(double factor, std::vector<double>& values) const;
  /// [num_points × num_points].
  [[nodiscard]] const Eigen::SparseMatrix<double, Eigen::RowMajor>& of_points() const {
    return of_points_;
  }

 private:
  /// Positions of each component of a pair of points in the values of a tangent.
  struct Target {
    std::array<Index, 3> positions;
    double value;
  };

  Index state_size_;
  Eigen::SparseMatrix<double, Eigen::RowMajor> of_points_;
  std::vector<Target> targets_;
};

}  // namespace palpate
