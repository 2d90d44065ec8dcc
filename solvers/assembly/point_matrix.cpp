// SPDX-License-Identifier: BSD-3-Clause
#include "assembly/point_matrix.h"

#include <algorithm>

namespace palpate {

std::array<Index, 3> block_positions(const SymmetricPattern& pattern, Index row, Index column) {
  std::array<Index, 3> positions{};
  for (Index c = 0; c < 3; ++c) {
    const auto first = pattern.row.begin() + pattern.column_start[column + c];
    const auto last = pattern.row.begin() + pattern.column_start[column + c + 1];
    const Index wanted = row == column ? row + c : row;
    positions[c] = static_cast<Index>(std::lower_bound(first, last, wanted) - pattern.row.begin());
  }
  return positions;
}

PointMatrix::PointMatrix(const std::vector<Eigen::Triplet<double>>& triplets,
                         const Assembly& assembly)
    : state_size_(assembly.state_size()), of_points_(assembly.num_points(), assembly.num_points()) {
  of_points_.setFromTriplets(triplets.begin(), triplets.end());
  const std::vector<Index>& unknown = assembly.unknown_of_point();
  for (Index a = 0; a < assembly.num_points(); ++a) {
    if (unknown[a] < 0) continue;
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator of(of_points_, a); of; ++of) {
      const Index column = unknown[of.col()];
      if (column < 0 || column > unknown[a]) continue;
      Target target{block_positions(assembly.pattern(), unknown[a], column), of.value()};
      if (column != unknown[a]) {
        // In an off-diagonal block, the diagonal is one row further down in each column.
        for (Index c = 0; c < 3; ++c) target.positions[c] += c;
      }
      targets_.push_back(target);
    }
  }
}

NodalVector PointMatrix::times(const NodalVector& x) const {
  const Eigen::Index n = of_points_.rows();
  NodalVector y = NodalVector::Zero(state_size_);
  const auto from = x.head(3 * n).reshaped<Eigen::RowMajor>(n, 3);
  y.head(3 * n).reshaped<Eigen::RowMajor>(n, 3) = of_points_ * from;
  return y;
}

void PointMatrix::add_to(double factor, std::vector<double>& values) const {
  for (const Target& target : targets_) {
    for (const Index position : target.positions) values[position] += factor * target.value;
  }
}

}  // namespace palpate
