// SPDX-License-Identifier: BSD-3-Clause
#include "fields/pod.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "base/error.h"
#include "base/quantity.h"

namespace palpate {
namespace {

using Eigen::MatrixXf;

/// Directions taken at a time: enough for products of matrices to be fast, few enough not to
/// overshoot the rank by much.
constexpr Eigen::Index kBlock = 32;

/// The range finder goes to this share of the limit, to leave the rest to truncation.
constexpr double kRangeShare = 0.25;

/// Truncation goes to this share, and leaves the rest to rounding. With half of it a file had a
/// tenth less for each mode, but a third more modes.
constexpr double kTruncationShare = 0.7;

/// The number of fields that are made from modes at a time.
constexpr Eigen::Index kColumnsAtATime = 256;

/// ±1 at random, the same on every machine.
MatrixXf random_signs(Eigen::Index rows, Eigen::Index cols, std::mt19937_64& random) {
  MatrixXf signs(rows, cols);
  for (Eigen::Index i = 0; i < signs.size(); ++i)
    signs.data()[i] = (random() >> 63) != 0 ? 1.F : -1.F;
  return signs;
}

void append_columns(MatrixXf& matrix, const Eigen::Ref<const MatrixXf>& columns) {
  matrix.conservativeResize(Eigen::NoChange, matrix.cols() + columns.cols());
  matrix.rightCols(columns.cols()) = columns;
}

/// Makes the columns orthonormal, and orthogonal to a basis. Twice: what one projection leaves by
/// rounding is removed by the second.
void orthonormalise(MatrixXf& block, const MatrixXf& basis) {
  for (int pass = 0; pass < 2; ++pass) {
    if (basis.cols() > 0) {
      const MatrixXf coefficients = basis.transpose() * block;
      block.noalias() -= basis * coefficients;
    }
    const Eigen::HouseholderQR<MatrixXf> qr(block);
    block = qr.householderQ() * MatrixXf::Identity(block.rows(), block.cols());
  }
}

}  // namespace

void validate_pod_bound(double bound) {
  if (!(bound >= kLeastPodBound && bound < 1)) {
    throw InputError("The bound on the error of the surface displacement is " + quantity(bound) +
                     "; give one from " + quantity(kLeastPodBound) + " to below 1.");
  }
}

double largest_at_a_point(const Eigen::Ref<const MatrixXf>& fields, int components) {
  float largest = 0;
  for (Eigen::Index c = 0; c < fields.cols(); ++c) {
    for (Eigen::Index i = 0; i < fields.rows(); i += components) {
      largest = std::max(largest, fields.col(c).segment(i, components).squaredNorm());
    }
  }
  return std::sqrt(static_cast<double>(largest));
}

double largest_product_at_a_point(const Eigen::Ref<const MatrixXf>& modes,
                                  const Eigen::Ref<const MatrixXf>& coefficients, int components) {
  double largest = 0;
  for (Eigen::Index first = 0; first < coefficients.cols(); first += kColumnsAtATime) {
    const Eigen::Index count = std::min(kColumnsAtATime, coefficients.cols() - first);
    const MatrixXf fields = modes * coefficients.middleCols(first, count);
    largest = std::max(largest, largest_at_a_point(fields, components));
  }
  return largest;
}

PodBasis::PodBasis(Eigen::Index num_rows, int components, double limit, MatrixXf begin)
    : components_(components), limit_(limit), begin_(std::move(begin)), modes_(num_rows, 0) {
  if (begin_.cols() == 0) {
    begin_.resize(num_rows, 0);
    return;
  }
  modes_ = begin_;
  orthonormalise(modes_, MatrixXf(num_rows, 0));
}

void PodBasis::add(const MatrixXf& bound, const MatrixXf& following) {
  Batch& batch = batches_.emplace_back();
  batch.bound = modes_.transpose() * bound;
  batch.following = modes_.transpose() * following;
  MatrixXf rest(bound.rows(), bound.cols() + following.cols());
  rest << bound, following;
  rest.leftCols(bound.cols()).noalias() -= modes_ * batch.bound;
  rest.rightCols(following.cols()).noalias() -= modes_ * batch.following;
  const auto error_of_bound = [&] {
    return largest_at_a_point(rest.leftCols(bound.cols()), components_);
  };
  double error = error_of_bound();
  if (error > kTruncationShare * limit_) {
    // The block may have more columns than there are fields, since few random signs may be
    // dependent.
    while (modes_.cols() < modes_.rows() && error > kRangeShare * limit_) {
      const Eigen::Index size = std::min(kBlock, modes_.rows() - modes_.cols());
      MatrixXf block = rest * random_signs(rest.cols(), size, random_);
      orthonormalise(block, modes_);
      const MatrixXf coefficients = block.transpose() * rest;
      rest.noalias() -= block * coefficients;
      append_columns(modes_, block);
      const auto append = [&](MatrixXf& to, const Eigen::Ref<const MatrixXf>& rows) {
        to.conservativeResize(to.rows() + rows.rows(), Eigen::NoChange);
        to.bottomRows(rows.rows()) = rows;
      };
      append(batch.bound, coefficients.leftCols(bound.cols()));
      append(batch.following, coefficients.rightCols(following.cols()));
      error = error_of_bound();
    }
  }
  bound_error_ = std::max(bound_error_, error);
  following_error_ =
      std::max(following_error_, largest_at_a_point(rest.rightCols(following.cols()), components_));
}

/// Modes that came with later batches have the coefficient 0 in earlier ones.
MatrixXf PodBasis::all_of(MatrixXf Batch::*columns) const {
  Eigen::Index count = 0;
  for (const Batch& batch : batches_) count += (batch.*columns).cols();
  MatrixXf all = MatrixXf::Zero(modes_.cols(), count);
  Eigen::Index at = 0;
  for (const Batch& batch : batches_) {
    const MatrixXf& part = batch.*columns;
    all.block(0, at, part.rows(), part.cols()) = part;
    at += part.cols();
  }
  return all;
}

double PodBasis::error_without(Eigen::Index dropped, const MatrixXf& modes,
                               const MatrixXf& coefficients) const {
  return largest_product_at_a_point(modes.rightCols(dropped), coefficients.bottomRows(dropped),
                                    components_);
}

Eigen::Index PodBasis::sufficient(const MatrixXf& modes, const MatrixXf& coefficients) const {
  const double allowed = kTruncationShare * limit_ - bound_error_;
  Eigen::Index too_few = -1;
  Eigen::Index enough = modes.cols();
  while (enough - too_few > 1) {
    const Eigen::Index middle = (too_few + enough) / 2;
    const bool keeps = error_without(modes.cols() - middle, modes, coefficients) <= allowed;
    (keeps ? enough : too_few) = middle;
  }
  return enough;
}

PodFit PodBasis::finish() {
  PodFit fit;
  fit.bound = all_of(&Batch::bound);
  fit.following = all_of(&Batch::following);
  const Eigen::Index given = begin_.cols();
  const Eigen::Index found = modes_.cols() - given;
  MatrixXf added = modes_.rightCols(found);
  if (found > 0) {
    // Order the modes by the energy of what they represent.
    const Eigen::MatrixXd b = fit.bound.bottomRows(found).cast<double>();
    const Eigen::MatrixXd f = fit.following.bottomRows(found).cast<double>();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(b * b.transpose() +
                                                               f * f.transpose());
    const MatrixXf w = eigen.eigenvectors().rowwise().reverse().cast<float>();
    added = (added * w).eval();
    fit.bound.bottomRows(found) = (w.transpose() * fit.bound.bottomRows(found)).eval();
    fit.following.bottomRows(found) = (w.transpose() * fit.following.bottomRows(found)).eval();
    const Eigen::Index kept = sufficient(added, fit.bound.bottomRows(found));
    bound_error_ += error_without(found - kept, added, fit.bound);
    following_error_ += error_without(found - kept, added, fit.following);
    added.conservativeResize(Eigen::NoChange, kept);
    fit.bound.conservativeResize(given + kept, Eigen::NoChange);
    fit.following.conservativeResize(given + kept, Eigen::NoChange);
  }
  if (given > 0) {
    // The modes that were given are not those that were made orthonormal of them: U = begin T.
    const MatrixXf t = begin_.householderQr().solve(MatrixXf(modes_.leftCols(given)));
    fit.bound.topRows(given) = (t * fit.bound.topRows(given)).eval();
    fit.following.topRows(given) = (t * fit.following.topRows(given)).eval();
  }
  fit.modes.resize(begin_.rows(), given + added.cols());
  fit.modes << begin_, added;
  fit.bound_error = bound_error_;
  fit.following_error = following_error_;
  return fit;
}

}  // namespace palpate
