// SPDX-License-Identifier: BSD-3-Clause
// The factors of a condensed system: which of them are kept, shared and replaced, and solves with
// them or by iteration.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "base/error.h"
#include "equilibrium/condensed_system.h"
#include "linear/condition.h"
#include "linear/product.h"

namespace palpate {
namespace {

/// The factor at rest serves a tool only if its solutions have a relative error below this, which
/// one step of refinement removes.
constexpr double kRefinable = 1e-8;
/// A body that keeps fewer factors than this does not share the factor at rest: it would have none
/// left for a state of a solve.
constexpr std::size_t kLeastFactorsToShare = 3;

}  // namespace

void CondensedSystem::take_solver(std::unique_ptr<LinearSolver> solver) {
  if (!assembly_.multipliers().empty() && !assembly_.has_stabilised_pressures() &&
      !solver->pivots()) {
    throw InputError(std::string("The linear solver ") + solver->name() +
                     " cannot solve for an incompressible law, whose tangent is indefinite. Use "
                     "MUMPS, or a law with a bulk modulus.");
  }
  {
    const Timer timer(work_.analysis_seconds);
    ++work_.analyses;
    solver->analyse(pattern());
  }
  if (assembly_.is_linear() || kept_factors_ >= kLeastFactorsToShare) {
    most_shared_ = RestFactor::most_held(*solver, pattern().size);
  }
  spare_solver_ = std::move(solver);
}

TangentFactor* CondensedSystem::find_factor(const Eigen::VectorXd& q, const NodalVector& state) {
  if (is_shared_ == true && is_as_at_rest(q, state)) return rest_factor_.get();
  return find_kept_factor(q, state);
}

CondensedSystem::KeptFactor* CondensedSystem::find_kept_factor(const Eigen::VectorXd& q,
                                                               const NodalVector& state) {
  const auto found = std::find_if(factors_.begin(), factors_.end(), [&](const KeptFactor& f) {
    if (f.state.size() == 0) return false;
    return is_linear() || (f.state == state && (!has_potential() || f.q == q));
  });
  if (found == factors_.end()) return nullptr;
  found->last_use = ++uses_;
  return &*found;
}

void CondensedSystem::forget(const Eigen::VectorXd& q, const NodalVector& state) {
  if (is_linear()) return;  // all states share its factor
  if (KeptFactor* factor = find_kept_factor(q, state)) factor->state.resize(0);
}

LinearSolver& CondensedSystem::any_solver() {
  return rest_factor_ != nullptr ? rest_factor_->solver() : *factors_.front().solver;
}

LinearSolver* CondensedSystem::analysed_solver() {
  if (rest_factor_ != nullptr && pattern_age_of_rest_factor_ == pattern_age_) {
    return &rest_factor_->solver();
  }
  const auto found = std::find_if(factors_.begin(), factors_.end(), [&](const KeptFactor& factor) {
    return factor.pattern_age == pattern_age_;
  });
  return found != factors_.end() ? found->solver.get() : nullptr;
}

LinearSolver& CondensedSystem::spare_solver() {
  if (spare_solver_ == nullptr) {
    if (const LinearSolver* other = analysed_solver()) {
      const Timer timer(work_.analysis_seconds);
      spare_solver_ = other->another();
    } else {
      take_solver(any_solver().another());
    }
  }
  return *spare_solver_;
}

CondensedSystem::KeptFactor& CondensedSystem::factor_to_replace() {
  const auto empty = std::find_if(factors_.begin(), factors_.end(),
                                  [](const KeptFactor& f) { return f.state.size() == 0; });
  if (empty != factors_.end()) return *empty;
  const std::size_t others = is_shared_ == true ? 1 : 0;
  if (factors_.size() + others < kept_factors_) {
    (void)spare_solver();
    return factors_.emplace_back(std::move(spare_solver_), pattern_age_);
  }
  return *std::min_element(
      factors_.begin(), factors_.end(),
      [](const KeptFactor& a, const KeptFactor& b) { return a.last_use < b.last_use; });
}

bool CondensedSystem::shares_rest_factor(const CondensedTangent& at_rest) {
  if (is_shared_) return *is_shared_;
  is_shared_ = false;
  std::vector<Index> held;
  for (std::size_t i = 0; i < coordinate_of_unknown_.size(); ++i) {
    if (coordinate_of_unknown_[i] != kFree) held.push_back(static_cast<Index>(i));
  }
  const auto num_held = static_cast<Index>(held.size());
  if (body_floats_ || num_held > most_shared_ || !idle_diagonal_.empty()) return false;
  if (rest_factor_ == nullptr) make_rest_factor();
  if (rest_factor_ == nullptr) return false;
  {
    const Timer timer(work_.solve_seconds);
    work_.right_hand_sides += num_held;
    rest_factor_->hold(std::move(held));
  }
  is_shared_ = error_of_rest_factor(at_rest) <= kRefinable;
  return *is_shared_;
}

void CondensedSystem::make_rest_factor() {
  std::vector<double> with_terms;
  if (!terms_.empty()) {
    assemble(rest_, with_terms);
    constraints_.constrain(with_terms);
  }
  LinearSolver& solver = spare_solver();
  const Timer timer(work_.factorisation_seconds);
  ++work_.factorisations;
  body_floats_ = solver.factorise(terms_.empty() ? undeformed_ : with_terms) != FactorStatus::ok;
  if (body_floats_) return;
  rest_factor_ = std::make_unique<RestFactor>(std::move(spare_solver_), pattern().size);
  pattern_age_of_rest_factor_ = pattern_age_;
}

void CondensedSystem::drop_rest_factor() {
  is_shared_.reset();
  body_floats_ = false;
  if (rest_factor_ == nullptr) return;
  const bool is_current = pattern_age_of_rest_factor_ == pattern_age_;
  if (spare_solver_ == nullptr && is_current) spare_solver_ = rest_factor_->release();
  rest_factor_.reset();
}

double CondensedSystem::error_of_rest_factor(const CondensedTangent& at_rest) {
  Eigen::VectorXd x(pattern().size);
  for (Index i = 0; i < x.size(); ++i) {
    x[i] = coordinate_of_unknown_[i] != kFree ? 0 : (i % 2 == 0 ? 1 : -1);
  }
  constraints_.project(x);
  Eigen::VectorXd found = product(pattern(), at_rest.values, x);
  solve(*rest_factor_, found);
  const double error = (found - x).norm() / x.norm();
  return std::isfinite(error) ? error : std::numeric_limits<double>::infinity();
}

TangentFactor* CondensedSystem::factorise(const CondensedTangent& tangent) {
  if (is_as_at_rest(tangent.q, tangent.state) && shares_rest_factor(tangent)) {
    return rest_factor_.get();
  }
  const Precision usual = usual_precision();
  KeptFactor* factor = factorise_alone(tangent, single_fails_ ? Precision::full : usual);
  if (usual == Precision::full) return factor;
  if (factor != nullptr) factor->is_provisional = single_fails_;
  single_fails_ = factor == nullptr || !factor->solver->is_single();
  return factor;
}

void CondensedSystem::begin_solve() {
  if (krylov_ != nullptr) krylov_->begin_solve();
  single_fails_ = false;
  for (KeptFactor& factor : factors_) {
    if (factor.is_provisional) factor.state.resize(0);
  }
}

TangentFactor* CondensedSystem::factorise_accurately(const CondensedTangent& tangent) {
  KeptFactor* factor = factorise_alone(tangent, Precision::full);
  // A later solve must find the usual factor of this state, not one in full precision that was made
  // only for this call.
  const bool is_usual = is_linear() || usual_precision() == Precision::full;
  if (factor != nullptr && !is_usual) factor->state.resize(0);
  return factor;
}

/// If the tangent at rest is not safe in single precision, as with parts of very different
/// stiffness, later tangents are not either.
Precision CondensedSystem::usual_precision() {
  if (precision_ == Precision::full) return precision_;
  if (!rest_is_safe_) {
    LinearSolver& solver = spare_solver();
    const Timer timer(work_.factorisation_seconds);
    ++work_.factorisations;
    rest_is_safe_ =
        solver.factorise(undeformed_, precision_) == FactorStatus::ok && solver.is_single();
  }
  return *rest_is_safe_ ? precision_ : Precision::full;
}

CondensedSystem::KeptFactor* CondensedSystem::factorise_alone(const CondensedTangent& tangent,
                                                              Precision precision) {
  if (is_linear()) {
    KeptFactor* factor = find_kept_factor(tangent.q, tangent.state);
    if (factor != nullptr && (precision != Precision::full || !factor->is_rough())) return factor;
  }
  KeptFactor& factor = factor_to_replace();
  factor.state.resize(0);
  factor.is_provisional = false;
  if (factor.pattern_age != pattern_age_) {
    (void)spare_solver();
    factor.solver = std::move(spare_solver_);
    factor.pattern_age = pattern_age_;
  }
  const Timer timer(work_.factorisation_seconds);
  ++work_.factorisations;
  if (factor.solver->factorise(tangent.values, precision) != FactorStatus::ok) return nullptr;
  factor.q = tangent.q;
  factor.state = tangent.state;
  factor.last_use = ++uses_;
  return &factor;
}

void CondensedSystem::solve(TangentFactor& factor, Eigen::Ref<Eigen::MatrixXd> columns) {
  const Timer timer(work_.solve_seconds);
  work_.right_hand_sides += columns.cols();
  factor.solve(columns);
  constraints_.project(columns);
}

SolveSummary CondensedSystem::solve(const CondensedTangent& tangent,
                                    Eigen::Ref<Eigen::MatrixXd> columns, double tolerance) {
  return iterate(tangent, columns, tolerance, &KrylovTangent::solve);
}

SolveSummary CondensedSystem::descend(const CondensedTangent& tangent,
                                      Eigen::Ref<Eigen::MatrixXd> column, double tolerance) {
  return iterate(tangent, column, tolerance, &KrylovTangent::descend);
}

SolveSummary CondensedSystem::iterate(
    const CondensedTangent& tangent, Eigen::Ref<Eigen::MatrixXd> columns, double tolerance,
    SolveSummary (KrylovTangent::*way)(Eigen::Ref<Eigen::MatrixXd>, double)) {
  const Timer timer(work_.solve_seconds);
  work_.right_hand_sides += columns.cols();
  if (!krylov_->has(tangent.values)) krylov_->take(tangent.values);
  const SolveSummary summary = (krylov_.get()->*way)(columns, tolerance);
  work_.krylov_iterations += summary.iterations;
  constraints_.project(columns);
  return summary;
}

Inertia CondensedSystem::find_inertia(const CondensedTangent& tangent) {
  const Timer timer(work_.solve_seconds);
  if (!krylov_->has(tangent.values)) krylov_->take(tangent.values);
  return krylov_->inertia();
}

int CondensedSystem::negative_pivots(const TangentFactor& factor) const {
  return factor.negative_pivots() - assembly_.num_unknown_pressures();
}

double CondensedSystem::condition(const CondensedTangent& tangent, TangentFactor& factor) const {
  return condition_estimate(pattern(), tangent.values,
                            [&](auto columns) { factor.solve(columns); });
}

}  // namespace palpate
