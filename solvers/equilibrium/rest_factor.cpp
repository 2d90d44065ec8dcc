// SPDX-License-Identifier: BSD-3-Clause
#include "equilibrium/rest_factor.h"

#include <Eigen/Eigenvalues>
#include <utility>

namespace palpate {
namespace {

/// A factor that has n numbers per unknown takes as long to make as this value times n solves. With
/// many columns at once, 0.45 to 0.85 was measured for 300 to 45 000 unknowns.
constexpr double kSolvesOfAFactorisation = 0.5;

}  // namespace

Index RestFactor::most_held(const LinearSolver& solver, Index num_unknowns) {
  if (num_unknowns == 0) return 0;
  const double numbers = static_cast<double>(solver.factor_bytes()) / sizeof(double);
  return static_cast<Index>(0.5 * kSolvesOfAFactorisation * numbers / num_unknowns);
}

void RestFactor::hold(std::vector<Index> unknowns) {
  held_ = std::move(unknowns);
  num_negative_ = 0;
  if (held_.empty()) return;
  const auto num_held = static_cast<Eigen::Index>(held_.size());
  Eigen::MatrixXd z = Eigen::MatrixXd::Zero(num_unknowns_, num_held);
  for (Eigen::Index c = 0; c < num_held; ++c) z(held_[c], c) = 1;
  solver_->solve(z);
  const Eigen::MatrixXd inverse = z(held_, Eigen::seqN(0, num_held));
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes(0.5 * (inverse + inverse.transpose()));
  elastic_ = z * modes.eigenvectors() * modes.eigenvalues().cwiseInverse().asDiagonal() *
             modes.eigenvectors().transpose();
  num_negative_ = static_cast<int>((modes.eigenvalues().array() < 0).count());
}

void RestFactor::solve(Eigen::Ref<Eigen::MatrixXd> columns) {
  solver_->solve(columns);
  if (held_.empty()) return;
  const auto all = Eigen::seqN(0, columns.cols());
  const Eigen::MatrixXd at_held = columns(held_, all);
  columns.noalias() -= elastic_ * at_held;
  columns(held_, all).setZero();
}

int RestFactor::negative_pivots() const { return solver_->negative_pivots() - num_negative_; }

}  // namespace palpate
