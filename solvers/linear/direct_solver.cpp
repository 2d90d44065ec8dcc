// SPDX-License-Identifier: BSD-3-Clause
#include "linear/direct_solver.h"

#include "linear/singularity_test.h"

namespace palpate {
namespace {

/// If all pivots are above this share of the greatest, the lowest mode is beyond doubt. Bodies of
/// one material have 0.01 and more. With a smaller share, one or two solves decide.
constexpr double kDoubt = 1e-3;

/// A mode whose stiffness has a larger relative error than this counts as having none.
constexpr double kLostDigits = 0.15;

}  // namespace

void DirectSolver::analyse(const SymmetricPattern& pattern) {
  pattern_ = std::make_shared<const SymmetricPattern>(pattern);
  single_.reset();
  if (pattern.size > 0) backend_->analyse(pattern_);
}

std::unique_ptr<LinearSolver> DirectSolver::another() const {
  auto other = std::make_unique<DirectSolver>(backend_->another());
  other->pattern_ = pattern_;
  return other;
}

FactorStatus DirectSolver::factorise(const std::vector<double>& values, Precision precision) {
  negative_pivots_ = 0;
  is_single_ = false;
  if (pattern_->size == 0) return FactorStatus::ok;  // everything is fixed
  if (!scaling_.scale(*pattern_, values)) return FactorStatus::singular;
  if (precision == Precision::single_if_safe && factorise_in_single_precision()) {
    is_single_ = true;
    return FactorStatus::ok;
  }
  const Backend::Pivots pivots = backend_->factorise(scaling_.values());
  if (!(pivots.least > 0)) return FactorStatus::singular;
  if (pivots.least < kDoubt * pivots.greatest) {
    const auto solve = [&](Eigen::Ref<Eigen::MatrixXd> columns) { backend_->solve(columns); };
    if (lowest_mode_error(*pattern_, scaling_.values(), solve) > kLostDigits) {
      return FactorStatus::singular;
    }
  }
  negative_pivots_ = pivots.negative;
  return FactorStatus::ok;
}

bool DirectSolver::factorise_in_single_precision() {
  if (single_ == nullptr) single_ = backend_->in_single_precision();
  if (single_ == nullptr) return false;
  const Backend::Pivots pivots = single_->factorise(scaling_.values());
  if (!(pivots.least > 0 && pivots.least >= kDoubt * pivots.greatest)) return false;
  negative_pivots_ = pivots.negative;
  return true;
}

void DirectSolver::solve(Eigen::Ref<Eigen::MatrixXd> columns) {
  if (pattern_->size == 0) return;
  scaling_.before_solve(columns);
  used().solve(columns);
  scaling_.after_solve(columns);
}

}  // namespace palpate
