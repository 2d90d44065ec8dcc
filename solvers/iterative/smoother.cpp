// SPDX-License-Identifier: BSD-3-Clause
#include "iterative/smoother.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <random>

namespace palpate {
namespace {

/// The smoother answers for the eigenvalues from this share of the largest on; the coarse level
/// has the others.
constexpr double kSmoothedShare = 1.0 / 8;
constexpr int kLanczosSteps = 10;
/// A block whose least eigenvalue is below this share of the greatest may be singular: its values
/// are sums of stiffnesses with errors of 1e-16.
constexpr double kRounding = 1e-13;
/// What the steps may miss; the polynomial bears another eighth before it amplifies.
constexpr double kMargin = 1.05;

}  // namespace

Chebyshev::Chebyshev(double largest) {
  const double least = kSmoothedShare * largest;
  const double centre = (largest + least) / 2;
  const double half = (largest - least) / 2;
  const double sigma = centre / half;
  const double rho = 1 / (2 * sigma - 1 / sigma);
  first = static_cast<float>(1 / centre);
  second = {static_cast<float>(rho / sigma), static_cast<float>(2 * rho / half)};
}

double largest_eigenvalue(Eigen::Index size, const ApplyFloat& multiply, const ApplyFloat& divide) {
  if (size == 0) return 1;
  // The coefficients of conjugate gradients preconditioned by D are those of Lanczos's method
  // (Saad, Iterative Methods for Sparse Linear Systems, 2nd ed., 6.7.3).
  Eigen::VectorXf r(size), z(size), p(size), q(size);
  std::mt19937 engine(1);
  for (float& x : r) x = (engine() & 1U) != 0 ? 1.0F : -1.0F;
  divide(r, z);
  p = z;
  const auto dot = [](const Eigen::VectorXf& a, const Eigen::VectorXf& b) {
    double sum = 0;
    for (Eigen::Index i = 0; i < a.size(); ++i) sum += static_cast<double>(a[i]) * b[i];
    return sum;
  };
  Eigen::VectorXd diagonal(kLanczosSteps);
  Eigen::VectorXd beside(kLanczosSteps);
  double rz = dot(r, z);
  const double least = 1e-12 * rz;
  double carried = 0;
  int steps = 0;
  while (steps < kLanczosSteps && rz > least) {
    multiply(p, q);
    const double curvature = dot(p, q);
    if (curvature == 0) break;
    const double alpha = rz / curvature;
    r -= static_cast<float>(alpha) * q;
    divide(r, z);
    const double next = dot(r, z);
    const double beta = next / rz;
    if (!std::isfinite(alpha) || !std::isfinite(beta)) break;
    diagonal[steps] = 1 / alpha + carried;
    beside[steps] = std::sqrt(std::abs(beta)) / alpha;
    carried = beta / alpha;
    p = z + static_cast<float>(beta) * p;
    rz = next;
    ++steps;
  }
  if (steps == 0) return 1;
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen;
  eigen.computeFromTridiagonal(diagonal.head(steps), beside.head(steps - 1),
                               Eigen::EigenvaluesOnly);
  return kMargin * eigen.eigenvalues().cwiseAbs().maxCoeff();
}

SetupReport check_diagonal(const BlockPattern& pattern, const std::vector<double>& values) {
  SetupReport report;
  if (!all_finite(values)) {
    report.status = SetupStatus::not_finite;
    return report;
  }
  for (Index node = 0; node < pattern.num_nodes; ++node) {
    const Mat3 block = diagonal_block(pattern, values, node);
    const double least = kRounding * block.cwiseAbs().maxCoeff();
    // Sylvester's criterion.
    const bool is_definite =
        block(0, 0) > least &&
        block(0, 0) * block(1, 1) - block(0, 1) * block(0, 1) > least * block(0, 0) &&
        block.determinant() > least * least * block(0, 0);
    if (is_definite) continue;
    if (report.num_indefinite_blocks++ == 0) report.node = node;
  }
  if (report.num_indefinite_blocks > 0) {
    report.status = SetupStatus::indefinite_block;
    report.negative_at_least = 1;
  }
  return report;
}

SmoothedMatrix::SmoothedMatrix(std::shared_ptr<const BlockPattern> pattern)
    : pattern_(std::move(pattern)) {}

void SmoothedMatrix::refresh(const std::vector<double>& values, double unit) {
  reserve(1);
  values_.resize(pattern_->num_values());
  for (std::size_t i = 0; i < values_.size(); ++i) {
    values_[i] = static_cast<float>(unit * values[i]);
  }
  inverse_diagonal_.assign(std::size_t{12} * pattern_->num_nodes, 0);
  for (Index node = 0; node < pattern_->num_nodes; ++node) {
    const Mat3 inverse = (unit * diagonal_block(*pattern_, values, node)).inverse();
    for (int c = 0; c < 3; ++c) {
      Eigen::Vector3f::Map(&inverse_diagonal_[std::size_t{12} * node + 4 * c]) =
          inverse.col(c).cast<float>();
    }
  }
  const auto times_inverse = [&](const Eigen::VectorXf& x, Eigen::VectorXf& result) {
    chebyshev_start(pattern_->num_nodes, inverse_diagonal_.data(), 1, 1, x.data(), result.data(),
                    direction_.data());
  };
  const auto times = [&](const Eigen::VectorXf& x, Eigen::VectorXf& result) {
    multiply(view(), 1, x.data(), sums_.data(), result.data());
  };
  largest_ =
      palpate::largest_eigenvalue(Eigen::Index{4} * pattern_->num_nodes, times, times_inverse);
  polynomial_ = Chebyshev(largest_);
}

void SmoothedMatrix::reserve(int columns) {
  if (direction_.num_columns() == columns && direction_.num_nodes() == pattern_->num_nodes) return;
  direction_.set_zero(pattern_->num_nodes, columns);
  sums_.set_zero(pattern_->num_nodes, columns);
}

void SmoothedMatrix::start(int columns, const float* b, float* x) {
  chebyshev_start(pattern_->num_nodes, inverse_diagonal_.data(), columns, polynomial_.first, b, x,
                  direction_.data());
  chebyshev_step(view(), inverse_diagonal_.data(), columns, polynomial_.second, b, sums_.data(), x,
                 direction_.data());
}

void SmoothedMatrix::smooth(int columns, const float* b, float* x) {
  chebyshev_step(view(), inverse_diagonal_.data(), columns, {0, polynomial_.first}, b, sums_.data(),
                 x, direction_.data());
  chebyshev_step(view(), inverse_diagonal_.data(), columns, polynomial_.second, b, sums_.data(), x,
                 direction_.data());
}

void SmoothedMatrix::residual(int columns, const float* b, const float* x, float* r) {
  palpate::residual(view(), columns, b, x, sums_.data(), r);
}

std::size_t SmoothedMatrix::bytes() const {
  return (values_.capacity() + inverse_diagonal_.capacity()) * sizeof(float) + direction_.bytes() +
         sums_.bytes();
}

}  // namespace palpate
