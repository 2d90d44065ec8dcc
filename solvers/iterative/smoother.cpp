// SPDX-License-Identifier: BSD-3-Clause
#include "iterative/smoother.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <numeric>
#include <random>

#include "base/parallel.h"

namespace palpate {
namespace {

/// The smoother reduces errors with eigenvalues above this share of the largest; the coarse level
/// reduces the others.
constexpr double kSmoothedShare = 1.0 / 8;
constexpr int kLanczosSteps = 10;
/// A block whose least eigenvalue is below this share of the largest may be singular: its values
/// are sums of stiffnesses with errors of 1e-16.
constexpr double kSingularShare = 1e-13;
/// The factor for what the Lanczos steps may miss; the polynomial tolerates another eighth before
/// it amplifies.
constexpr double kMargin = 1.05;

/// Whether a block is positive definite, by Sylvester's criterion.
bool is_definite(const Mat3& block) {
  const double least = kSingularShare * block.cwiseAbs().maxCoeff();
  return block(0, 0) > least &&
         block(0, 0) * block(1, 1) - block(0, 1) * block(0, 1) > least * block(0, 0) &&
         block.determinant() > least * least * block(0, 0);
}

double product_of(const Eigen::VectorXf& a, const Eigen::VectorXf& b) {
  const Ranges ranges(static_cast<Index>(a.size()), kNumbersOfPart);
  std::array<double, Ranges::kMostParts> sums{};
  for_each_part(ranges.num_parts(), [&](Index part) {
    double sum = 0;
    for (Index i = ranges.first(part); i < ranges.first(part + 1); ++i) {
      sum += static_cast<double>(a[i]) * b[i];
    }
    sums[part] = sum;
  });
  return std::accumulate(sums.begin(), sums.begin() + ranges.num_parts(), 0.0);
}

/// y ← x + factor y.
void scale_and_add(const Eigen::VectorXf& x, float factor, Eigen::VectorXf& y) {
  for_each_range({static_cast<Index>(x.size()), kNumbersOfPart}, [&](Index first, Index last) {
    y.segment(first, last - first) =
        x.segment(first, last - first) + factor * y.segment(first, last - first);
  });
}

/// y ← y + factor x.
void add(const Eigen::VectorXf& x, float factor, Eigen::VectorXf& y) {
  for_each_range({static_cast<Index>(x.size()), kNumbersOfPart}, [&](Index first, Index last) {
    y.segment(first, last - first) += factor * x.segment(first, last - first);
  });
}

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
  Eigen::VectorXd diagonal(kLanczosSteps);
  Eigen::VectorXd beside(kLanczosSteps);
  double rz = product_of(r, z);
  const double least = 1e-12 * rz;
  double carried = 0;
  int steps = 0;
  while (steps < kLanczosSteps && rz > least) {
    multiply(p, q);
    const double curvature = product_of(p, q);
    if (curvature == 0) break;
    const double alpha = rz / curvature;
    add(q, -static_cast<float>(alpha), r);
    divide(r, z);
    const double next = product_of(r, z);
    const double beta = next / rz;
    if (!std::isfinite(alpha) || !std::isfinite(beta)) break;
    diagonal[steps] = 1 / alpha + carried;
    beside[steps] = std::sqrt(std::abs(beta)) / alpha;
    carried = beta / alpha;
    scale_and_add(z, static_cast<float>(beta), p);
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
  const Ranges ranges(pattern.num_nodes, kNodesOfPart);
  std::array<SetupReport, Ranges::kMostParts> of_part;
  for_each_part(ranges.num_parts(), [&](Index part) {
    for (Index node = ranges.first(part); node < ranges.first(part + 1); ++node) {
      if (is_definite(diagonal_block(pattern, values, node))) continue;
      if (of_part[part].num_indefinite_blocks++ == 0) of_part[part].node = node;
    }
  });
  for (Index part = ranges.num_parts() - 1; part >= 0; --part) {
    if (of_part[part].num_indefinite_blocks == 0) continue;
    report.num_indefinite_blocks += of_part[part].num_indefinite_blocks;
    report.node = of_part[part].node;
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
  for_each_range({pattern_->num_values(), kNumbersOfPart}, [&](Index first, Index last) {
    for (Index i = first; i < last; ++i) values_[i] = static_cast<float>(unit * values[i]);
  });
  inverse_diagonal_.assign(std::size_t{12} * pattern_->num_nodes, 0);
  for_each_range({pattern_->num_nodes, kNodesOfPart}, [&](Index first, Index last) {
    for (Index node = first; node < last; ++node) {
      const Mat3 inverse = (unit * diagonal_block(*pattern_, values, node)).inverse();
      for (int c = 0; c < 3; ++c) {
        Eigen::Vector3f::Map(&inverse_diagonal_[std::size_t{12} * node + 4 * c]) =
            inverse.col(c).cast<float>();
      }
    }
  });
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
  sums_.set_zero(pattern_->num_sums(), columns);
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
