// SPDX-License-Identifier: BSD-3-Clause
#include "equilibrium/krylov_tangent.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace palpate {
namespace {

/// The largest number of iterations is kMostTimesUnknowns over the number of unknowns, within two
/// bounds. For a body of a hundred thousand unknowns, the lower bound of iterations takes as long
/// as a factorisation. Smaller bodies are allowed more, since their iterations take at most a
/// quarter of a second in all, and may be needed: a coarse shell with 1 400 unknowns takes 850.
constexpr int kUsualMostIterations = 300;
constexpr int kMostIterations = 3000;
constexpr int kMostTimesUnknowns = 3'000'000;
/// A preconditioner is made anew if it needs this many times the iterations of its first solve;
/// making it costs about as much as five iterations.
constexpr double kMuchWorse = 1.5;
/// Shares of the tangent at rest that are added to an indefinite tangent. The first sum that is
/// definite gives the nearest preconditioner.
constexpr double kSharesOfRest[] = {0.1, 0.3, 1};
/// The largest number of negative eigenvalues; an elastic body in a state of interest has fewer.
constexpr int kMostTurned = 12;

}  // namespace

KrylovTangent::KrylovTangent(const TetMesh& mesh, const Assembly& assembly,
                             const SymmetricPattern& pattern,
                             const std::vector<double>& rest_values)
    : levels_(make_node_levels(mesh, assembly.unknown_of_point())), rest_values_(rest_values) {
  if (assembly.num_pressures() > 0) {
    throw InputError(
        "The body has mixed cells, of a nearly incompressible material, whose tangent conjugate "
        "gradients cannot solve for. Choose the linear solver MUMPS, or Displacement as the "
        "Formulation of the material.");
  }
  pattern_ = std::make_shared<const BlockPattern>(make_block_pattern(pattern));
  max_iterations_ = std::clamp(kMostTimesUnknowns / std::max(pattern.size, 1), kUsualMostIterations,
                               kMostIterations);
  held_.assign(static_cast<std::size_t>(pattern_->num_nodes), 0);
}

void KrylovTangent::hold(const std::vector<char>& held) {
  if (held == held_) return;
  held_ = held;
  preconditioner_.reset();
  begin_solve();
  values_ = nullptr;
}

void KrylovTangent::begin_solve() {
  is_stale_ = true;
  is_of_this_solve_ = false;
}

void KrylovTangent::take(const std::vector<double>& values) {
  values_ = &values;
  operator_ = std::make_unique<Operator>(pattern_, values);
  setup_ = {};
}

void KrylovTangent::prepare() {
  if (!is_stale_) return;
  is_stale_ = false;
  first_rate_ = 0;
  if (preconditioner_ == nullptr) {
    preconditioner_ = make_preconditioner(pattern_, without(levels_, held_));
  }
  setup_ = preconditioner_->refresh(*values_);
  if (setup_.status == SetupStatus::ok) {
    is_of_this_solve_ = true;
  } else if (!is_of_this_solve_) {
    refresh_with_rest();
  }
}

void KrylovTangent::refresh_with_rest() {
  // The rows of held nodes do no harm.
  std::vector<double> mixture(rest_values_.size());
  for (const double share : kSharesOfRest) {
    std::transform(values_->begin(), values_->end(), rest_values_.begin(), mixture.begin(),
                   [share](double here, double at_rest) { return here + share * at_rest; });
    if (preconditioner_->refresh(mixture).status == SetupStatus::ok) return;
  }
  (void)preconditioner_->refresh(rest_values_);
}

SolveSummary KrylovTangent::solve(Eigen::Ref<Eigen::MatrixXd> columns, double tolerance) {
  prepare();
  solver_.set_options({tolerance, max_iterations_});
  const Eigen::MatrixXd right_hand_sides = columns;
  SolveSummary summary = solver_.solve(*operator_, *preconditioner_, columns);
  while (summary.status == SolveStatus::negative_curvature &&
         operator_->num_turned() < kMostTurned) {
    const int turned = operator_->num_turned();
    operator_->turn(summary.direction);
    if (operator_->num_turned() == turned) break;
    columns = right_hand_sides;
    const int before = summary.iterations;
    summary = solver_.solve(*operator_, *preconditioner_, columns);
    summary.iterations += before;
  }
  operator_->turn_back(right_hand_sides, columns);
  take_rate(summary);
  return summary;
}

SolveSummary KrylovTangent::descend(Eigen::Ref<Eigen::MatrixXd> column, double tolerance) {
  prepare();
  solver_.set_options({tolerance, max_iterations_});
  const Eigen::VectorXd right_hand_side = column.col(0);
  SolveSummary summary = solver_.solve(*operator_, *preconditioner_, column);
  if (summary.status == SolveStatus::negative_curvature && column.isZero(0)) {
    column = std::copysign(1.0, summary.direction.dot(right_hand_side)) * summary.direction;
  }
  // What ends early says nothing of how fast the rest would be.
  if (summary.status != SolveStatus::negative_curvature) take_rate(summary);
  return summary;
}

void KrylovTangent::take_rate(const SolveSummary& summary) {
  if (summary.iterations > 0 && summary.residual > 0 && summary.residual < 1) {
    const double rate = summary.iterations / -std::log10(summary.residual);
    if (first_rate_ == 0) first_rate_ = rate;
    is_stale_ = rate > kMuchWorse * first_rate_;
  }
}

Inertia KrylovTangent::inertia() {
  prepare();
  const Operator plain(pattern_, *values_);
  EigenOptions options;
  options.max_iterations = options.max_solve_iterations = max_iterations_;
  Inertia inertia = inertia_of(find_lowest_eigenvalue(plain, *preconditioner_, options), setup_);
  if (operator_->num_turned() > 0) {
    inertia.knowledge = Inertia::Knowledge::at_least;
    inertia.num_negative = std::max(inertia.num_negative, operator_->num_turned());
    inertia.lowest_eigenvalue = std::fmin(inertia.lowest_eigenvalue, operator_->least_turned());
  }
  return inertia;
}

}  // namespace palpate
