// SPDX-License-Identifier: BSD-3-Clause
#include "linear/condition.h"

#include <algorithm>
#include <cmath>

#include "linear/product.h"

namespace palpate {
namespace {

constexpr int kMaxEstimates = 5;

double one_norm(const SymmetricPattern& pattern, const std::vector<double>& values) {
  Eigen::VectorXd sums = Eigen::VectorXd::Zero(pattern.size);
  for (Index c = 0; c < pattern.size; ++c) {
    for (Index i = pattern.column_start[c]; i < pattern.column_start[c + 1]; ++i) {
      const double value = std::abs(values[i]);
      sums[c] += value;
      if (pattern.row[i] != c) sums[pattern.row[i]] += value;
    }
  }
  return sums.maxCoeff();
}

/// ‖K⁻¹‖₁ as the maximum of ‖K⁻¹x‖₁ over ‖x‖₁ = 1. Since the norm is convex, the maximum is at a
/// corner, a unit vector. The search goes from corner to corner by the gradient.
double inverse_one_norm(Index size, const SolveColumns& solve_columns) {
  const auto solve = [&](Eigen::VectorXd column) {
    solve_columns(column);
    return column;
  };
  Eigen::VectorXd x = solve(Eigen::VectorXd::Constant(size, 1.0 / size));
  double estimate = x.lpNorm<1>();
  Eigen::Index corner = -1;
  for (int round = 0; round < kMaxEstimates && size > 1; ++round) {
    const Eigen::VectorXd signs = x.unaryExpr([](double v) { return v < 0 ? -1.0 : 1.0; });
    Eigen::Index next = 0;
    solve(signs).cwiseAbs().maxCoeff(&next);
    if (next == corner) break;
    corner = next;
    x = solve(Eigen::VectorXd::Unit(size, corner));
    const double better = x.lpNorm<1>();
    if (better <= estimate) break;
    estimate = better;
  }
  // A further column, chosen without regard to signs, keeps the method from being fooled.
  Eigen::VectorXd alternating(size);
  for (Index i = 0; i < size; ++i) {
    alternating[i] = (i % 2 == 0 ? 1 : -1) * (1 + static_cast<double>(i) / std::max(size - 1, 1));
  }
  return std::max(estimate, 2 * solve(alternating).lpNorm<1>() / (3.0 * size));
}

}  // namespace

double condition_estimate(const SymmetricPattern& pattern, const std::vector<double>& values,
                          const SolveColumns& solve) {
  if (pattern.size == 0) return 1;
  return one_norm(pattern, values) * inverse_one_norm(pattern.size, solve);
}

}  // namespace palpate
