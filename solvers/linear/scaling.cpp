// SPDX-License-Identifier: BSD-3-Clause
#include "linear/scaling.h"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

/// A bound of the values of S. Those of a definite matrix are below it, since its diagonal is.
constexpr double kBound = 2;
/// More rounds than any matrix needs; each takes the root of what is too large.
constexpr int kMaxRounds = 12;

/// The power of two d with ½ ≤ d² value < 2.
double inverse_root(double value) {
  int exponent = 0;
  (void)std::frexp(value, &exponent);
  return std::ldexp(1.0, -(exponent >> 1));
}

}  // namespace

bool Scaling::scale(const SymmetricPattern& pattern, const std::vector<double>& values) {
  const double largest = Eigen::Map<const Eigen::ArrayXd>(values.data(), pattern.num_values())
                             .abs()
                             .maxCoeff<Eigen::PropagateNaN>();
  if (!std::isfinite(largest)) return false;
  exponent_ = 0;
  (void)std::frexp(largest, &exponent_);
  choose(pattern, values);
  for (int round = 0; !apply(pattern, values) && round < kMaxRounds; ++round) shrink(pattern);
  return true;
}

void Scaling::choose(const SymmetricPattern& pattern, const std::vector<double>& values) {
  const double unit = std::ldexp(1.0, -exponent_);
  d_.resize(pattern.size);
  bool is_positive = true;
  for (Index c = 0; c < pattern.size; ++c) {
    const double diagonal = unit * values[pattern.column_start[c]];
    is_positive = is_positive && diagonal > 0;
    d_[c] = diagonal > 0 ? inverse_root(diagonal) : 0;
  }
  if (is_positive) return;
  // For rows without a positive diagonal: the sum of the squares of the coupling values, each
  // divided by the diagonal of its other row.
  Eigen::VectorXd left = Eigen::VectorXd::Zero(pattern.size);
  for (Index c = 0; c < pattern.size; ++c) {
    for (Index i = pattern.column_start[c]; i < pattern.column_start[c + 1]; ++i) {
      const Index r = pattern.row[i];
      const double value = unit * values[i];
      if (r == c) {
        left[c] += std::abs(value);
      } else {
        left[c] += value * d_[r] * value * d_[r];
        left[r] += value * d_[c] * value * d_[c];
      }
    }
  }
  for (Index c = 0; c < pattern.size; ++c) {
    if (d_[c] == 0) d_[c] = left[c] > 0 ? inverse_root(left[c]) : 1;
  }
}

bool Scaling::apply(const SymmetricPattern& pattern, const std::vector<double>& values) {
  const double unit = std::ldexp(1.0, -exponent_);
  scaled_.resize(values.size());
  double largest = 0;
  for (Index c = 0; c < pattern.size; ++c) {
    const double of_column = unit * d_[c];
    for (Index i = pattern.column_start[c]; i < pattern.column_start[c + 1]; ++i) {
      scaled_[i] = of_column * values[i] * d_[pattern.row[i]];
      largest = std::max(largest, std::abs(scaled_[i]));
    }
  }
  return largest < kBound;
}

void Scaling::shrink(const SymmetricPattern& pattern) {
  Eigen::VectorXd largest = Eigen::VectorXd::Zero(pattern.size);
  for (Index c = 0; c < pattern.size; ++c) {
    for (Index i = pattern.column_start[c]; i < pattern.column_start[c + 1]; ++i) {
      const double value = std::abs(scaled_[i]);
      largest[c] = std::max(largest[c], value);
      largest[pattern.row[i]] = std::max(largest[pattern.row[i]], value);
    }
  }
  for (Index c = 0; c < pattern.size; ++c) {
    if (largest[c] >= kBound) d_[c] *= inverse_root(largest[c]);
  }
}

void Scaling::before_solve(Eigen::Ref<Eigen::MatrixXd> columns) const {
  columns.array().colwise() *= d_.array();
}

void Scaling::after_solve(Eigen::Ref<Eigen::MatrixXd> columns) const {
  const double unit = std::ldexp(1.0, -exponent_);
  columns.array().colwise() *= unit * d_.array();
}

}  // namespace palpate
