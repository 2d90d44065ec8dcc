// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/SparseCore>
#include <vector>

#include "assembly/symmetric_pattern.h"

namespace palpate {

/// The matrix whose lower triangle has these values, without a copy.
[[nodiscard]] inline auto lower_triangle(const SymmetricPattern& pattern,
                                         const std::vector<double>& values) {
  return Eigen::Map<const Eigen::SparseMatrix<double, Eigen::ColMajor, Index>>(
      pattern.size, pattern.size, pattern.num_values(), pattern.column_start.data(),
      pattern.row.data(), values.data());
}

/// K x.
[[nodiscard]] inline Eigen::VectorXd product(const SymmetricPattern& pattern,
                                             const std::vector<double>& values,
                                             const Eigen::VectorXd& x) {
  return lower_triangle(pattern, values).selfadjointView<Eigen::Lower>() * x;
}

}  // namespace palpate
