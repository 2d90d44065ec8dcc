// SPDX-License-Identifier: BSD-3-Clause
#include "state_space/pod.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace palpate {
namespace {

using Eigen::Index;
using Eigen::MatrixXf;
using Fields = Eigen::Ref<const MatrixXf>;

/// Directions taken at a time: enough for products of matrices to be fast, few enough not to
/// overshoot the rank by much.
constexpr Index kBlock = 32;

/// The range finder goes to this share of the bound, to leave the rest to truncation.
constexpr double kRangeShare = 0.25;

/// Truncation goes to this share, so that the rounding of what is stored fits in.
constexpr double kTruncationShare = 0.9;

/// Rounding of a field to single precision, relative to the largest displacement.
constexpr double kSinglePrecision = 6e-8;

/// Largest length of a point's vector in any column.
double largest_at_a_point(const Fields& fields) {
  float largest = 0;
  for (Index c = 0; c < fields.cols(); ++c) {
    const float* f = fields.col(c).data();
    for (Index i = 0; i < fields.rows(); i += 3) {
      largest = std::max(largest, f[i] * f[i] + f[i + 1] * f[i + 1] + f[i + 2] * f[i + 2]);
    }
  }
  return std::sqrt(static_cast<double>(largest));
}

/// ±1 at random, the same on every machine.
MatrixXf random_signs(Index rows, Index cols, std::mt19937_64& random) {
  MatrixXf signs(rows, cols);
  for (Index i = 0; i < signs.size(); ++i) signs.data()[i] = (random() >> 63) != 0 ? 1.F : -1.F;
  return signs;
}

void append_columns(MatrixXf& matrix, const Fields& columns) {
  matrix.conservativeResize(Eigen::NoChange, matrix.cols() + columns.cols());
  matrix.rightCols(columns.cols()) = columns;
}

void append_rows(MatrixXf& matrix, const Fields& rows) {
  matrix.conservativeResize(matrix.rows() + rows.rows(), Eigen::NoChange);
  matrix.bottomRows(rows.rows()) = rows;
}

void remove_span(MatrixXf& block, const MatrixXf& basis) {
  if (basis.cols() == 0) return;
  const MatrixXf coefficients = basis.transpose() * block;
  block.noalias() -= basis * coefficients;
}

/// Makes the columns orthonormal, and orthogonal to two bases. Twice: what one projection leaves
/// by rounding is removed by the second.
void orthonormalise(MatrixXf& block, const MatrixXf& first, const MatrixXf& second) {
  for (int pass = 0; pass < 2; ++pass) {
    remove_span(block, first);
    remove_span(block, second);
    const Eigen::HouseholderQR<MatrixXf> qr(block);
    block = qr.householderQ() * MatrixXf::Identity(block.rows(), block.cols());
  }
}

/// Turns Q, B so that the rows of B are orthogonal and descend in length.
void sort_by_energy(MatrixXf& q, MatrixXf& b) {
  const Eigen::MatrixXd wide = b.cast<double>();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(wide * wide.transpose());
  const MatrixXf w = eigen.eigenvectors().rowwise().reverse().cast<float>();
  q = (q * w).eval();
  b = (w.transpose() * b).eval();
}

}  // namespace

PodBasis::PodBasis(Index num_dofs, double bound) : modes_(num_dofs, 0), bound_(bound) {
  if (!(bound >= kLeastPodBound && bound < 1)) {
    throw InputError("The bound on the error of the surface displacement is " +
                     std::to_string(bound) + "; give one from " + std::to_string(kLeastPodBound) +
                     " to below 1.");
  }
}

PodFit PodBasis::extend(const MatrixXf& snapshots) {
  const Index n = snapshots.cols() / 4;
  PodFit fit;
  fit.largest_displacement = largest_at_a_point(snapshots.leftCols(n));
  const bool moves = fit.largest_displacement > 0;
  // The columns that the bound holds for.
  const Index first = moves ? 0 : n;
  const Index count = moves ? n : 3 * n;
  const double scale =
      moves ? fit.largest_displacement : largest_at_a_point(snapshots.rightCols(3 * n));
  const double limit = (bound_ - kSinglePrecision) * scale;

  fit.coefficients = modes_.transpose() * snapshots;
  MatrixXf residual = snapshots;
  residual.noalias() -= modes_ * fit.coefficients;
  if (largest_at_a_point(residual.middleCols(first, count)) > limit) {
    MatrixXf q(snapshots.rows(), 0);
    MatrixXf b(0, snapshots.cols());
    // More than there are snapshots: few random signs may be dependent.
    const Index most = snapshots.rows() - modes_.cols();
    while (q.cols() < most &&
           largest_at_a_point(residual.middleCols(first, count)) > kRangeShare * limit) {
      const Index size = std::min(kBlock, most - q.cols());
      MatrixXf block = residual * random_signs(snapshots.cols(), size, random_);
      orthonormalise(block, modes_, q);
      const MatrixXf coefficients = block.transpose() * residual;
      residual.noalias() -= block * coefficients;
      append_columns(q, block);
      append_rows(b, coefficients);
    }
    sort_by_energy(q, b);

    const auto error_with = [&](Index rank) {
      const Index rest = q.cols() - rank;
      MatrixXf error = residual.middleCols(first, count);
      error.noalias() += q.rightCols(rest) * b.bottomRows(rest).middleCols(first, count);
      return largest_at_a_point(error);
    };
    Index too_few = 0;
    Index enough = q.cols();
    while (enough - too_few > 1) {
      const Index middle = (too_few + enough) / 2;
      (error_with(middle) > kTruncationShare * limit ? too_few : enough) = middle;
    }
    append_columns(modes_, q.leftCols(enough));
    append_rows(fit.coefficients, b.topRows(enough));
    // The errors are those of what is stored.
    residual = snapshots;
    residual.noalias() -= modes_ * fit.coefficients;
  }
  const double rounding = kSinglePrecision * scale;
  fit.displacement_error = largest_at_a_point(residual.leftCols(n)) + rounding;
  fit.sensitivity_error = largest_at_a_point(residual.rightCols(3 * n)) + rounding;
  const double checked = moves ? fit.displacement_error : fit.sensitivity_error;
  if (checked > bound_ * scale) {
    throw BackendError("The basis of the surface displacement keeps " +
                       std::to_string(checked / scale) + " of the bound " + std::to_string(bound_) +
                       ". Give a larger bound.");
  }
  return fit;
}

}  // namespace palpate
