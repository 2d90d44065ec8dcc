// SPDX-License-Identifier: BSD-3-Clause
#include "linear/singularity_test.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "linear/product.h"

namespace palpate {
namespace {

/// ε |y|ᵀ|K||y| adds up all rounding as if it had one sign; this is the usual share of it.
constexpr double kUsualShare = 0.1;

/// Below this error there is no doubt.
constexpr double kCertain = 1e-3;

/// ε |K||y|.
Eigen::VectorXd rounding_of_product(const SymmetricPattern& pattern,
                                    const std::vector<double>& values, const Eigen::VectorXd& y) {
  Eigen::VectorXd sums = Eigen::VectorXd::Zero(pattern.size);
  for (Index c = 0; c < pattern.size; ++c) {
    for (Index i = pattern.column_start[c]; i < pattern.column_start[c + 1]; ++i) {
      const Index r = pattern.row[i];
      sums[c] += std::abs(values[i] * y[r]);
      if (r != c) sums[r] += std::abs(values[i] * y[c]);
    }
  }
  return std::numeric_limits<double>::epsilon() * sums;
}

}  // namespace

double lowest_mode_error(const SymmetricPattern& pattern, const std::vector<double>& values,
                         const SolveColumns& solve) {
  std::minstd_rand random;  // the same column every time
  Eigen::VectorXd b(pattern.size);
  for (double& value : b) {
    value = 2 * static_cast<double>(random()) / std::minstd_rand::max() - 1;
  }
  Eigen::VectorXd y = b;
  solve(y);
  const Eigen::VectorXd rounding = rounding_of_product(pattern, values, y);
  const double of_stiffness = kUsualShare * rounding.dot(y.cwiseAbs()) / std::abs(y.dot(b));
  const double of_matrix = std::max(of_stiffness, rounding.norm() / b.norm());
  if (of_matrix < kCertain) return of_matrix;
  Eigen::VectorXd step = b - product(pattern, values, y);
  solve(step);
  const double of_factor = step.norm() / y.norm();
  const double error = std::max(of_matrix, of_factor);
  return std::isfinite(of_matrix + of_factor) ? error : std::numeric_limits<double>::infinity();
}

}  // namespace palpate
