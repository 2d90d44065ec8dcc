// SPDX-License-Identifier: BSD-3-Clause
#include "equilibrium/corrector.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace palpate {
namespace {

/// Sufficient decrease with the usual constant (Nocedal & Wright, 3.4).
constexpr double kSufficientDecrease = 1e-4;
constexpr int kMaxBacktracks = 15;
/// If the line search shortens a step below this share, the factor belongs to a state too far away:
/// where a stiff part has turned since, the factor takes a stretch of it for a soft mode.
constexpr double kShortStep = 0.02;
/// The number of steps after which the contraction of a factor is judged.
constexpr int kStepsBeforeJudging = 8;
/// The largest and the smallest share of a residual that conjugate gradients may leave.
constexpr double kLargestForcing = 0.1;
constexpr double kLeastForcing = 1e-7;
/// A solve that leaves more than this share of its residual is useless.
constexpr double kUseless = 0.9;

/// A state of the iteration with its residual.
struct Iterate {
  NodalVector state;
  Eigen::VectorXd r;
  double energy = 0;
  /// CondensedSystem::norm of r.
  double norm = 0;
};

bool evaluate(CondensedSystem& system, const Eigen::VectorXd& q, Iterate& iterate) {
  const Evaluation at = system.evaluate(q, iterate.state);
  iterate.energy = at.energy;
  if (!at.is_finite()) return false;
  iterate.r = system.residual(at);
  iterate.norm = system.norm(iterate.r);
  return std::isfinite(iterate.norm);
}

/// Whether a trial at `length` of the step decreases the energy enough. If not, `length` becomes
/// the one to try next.
/// @param at_rest CondensedSystem::energies_at_rest().
bool accept_by_energy(const Iterate& old, const Iterate& trial, double slope, double at_rest,
                      double& length) {
  const double change = trial.energy - old.energy;
  if (change <= kSufficientDecrease * length * slope) return true;
  const bool level = std::abs(change) <=
                     kEnergyRounding * (std::abs(old.energy) + std::abs(trial.energy) + at_rest);
  if (level && trial.norm < old.norm) return true;
  // Minimum of the parabola through the energy, its slope and the trial energy.
  const double best = -slope * length * length / (2 * (change - slope * length));
  length = std::clamp(best, 0.1 * length, 0.5 * length);
  return false;
}

bool accept_by_residual(const CondensedSystem& system, const Iterate& old, const Iterate& trial,
                        double& length) {
  if (system.euclidean_norm(trial.r) <=
      (1 - kSufficientDecrease * length) * system.euclidean_norm(old.r)) {
    return true;
  }
  length *= 0.5;
  return false;
}

/// Line search: moves along `step` until a trial is good enough.
/// @returns the accepted length of the step; 0: none was accepted.
double search(CondensedSystem& system, const Eigen::VectorXd& q, const Eigen::VectorXd& step,
              double slope, Iterate& iterate) {
  const NodalVector direction = system.as_state(step);
  Iterate trial;
  double length = 1;
  const double longest = system.longest_step();
  if (std::isfinite(longest)) {
    const Eigen::Index displacements = 3 * Eigen::Index{system.assembly().num_points()};
    length = std::min(1.0, longest / direction.head(displacements).lpNorm<Eigen::Infinity>());
  }
  for (int i = 0; i < kMaxBacktracks; ++i) {
    trial.state = iterate.state + length * direction;
    if (!evaluate(system, q, trial)) {
      length *= 0.25;
      continue;
    }
    const double tried = length;
    const bool accepted = system.is_saddle() ? accept_by_residual(system, iterate, trial, length)
                                             : accept_by_energy(iterate, trial, slope,
                                                                system.energies_at_rest(), length);
    if (!accepted) continue;
    std::swap(iterate, trial);
    return tried;
  }
  return 0;
}

/// The outcome with which the iteration ends; nothing: it goes on.
std::optional<Outcome> reason_to_end(const Correction& so_far, const EquilibriumOptions& options,
                                     const Interruption& interruption) {
  if (so_far.residual <= options.tolerance) return Outcome::converged;
  if (so_far.iterations == options.max_iterations) return Outcome::not_converged;
  const Outcome interrupted = interruption();
  if (interrupted != Outcome::converged) return interrupted;
  return std::nullopt;
}

/// Sets x to a state in equilibrium, unless the tool has passed through the surface of the body.
Outcome arrive(const CondensedSystem& system, const Eigen::VectorXd& t, const NodalVector& found,
               NodalVector& x) {
  if (system.tool_is_inside(t, found)) return Outcome::tool_inside;
  x = found;
  return Outcome::converged;
}

}  // namespace

Correction correct(CondensedSystem& system, const EquilibriumOptions& options,
                   const Interruption& interruption, const LinearisedState& start,
                   const Eigen::VectorXd& t, NodalVector& x) {
  Correction result;
  const auto end = [&result](Outcome outcome) {
    result.outcome = outcome;
    return std::move(result);
  };
  const double scale = system.displacement_scale(t);
  Iterate iterate;
  iterate.state = x;
  if (!evaluate(system, t, iterate))
    return end(Outcome::not_converged);  // the predictor inverts a cell
  result.quasi_newton = system.is_saddle() ? make_broyden() : make_bfgs();
  QuasiNewton& quasi_newton = *result.quasi_newton;
  TangentFactor*& factor = result.factor;
  bool fresh = false;  // the factor is that of the tangent at the iterate
  double first_step = 0;
  int num_steps = 0;  // since the factor was made
  const auto use = [&](TangentFactor* other) {
    factor = other;
    quasi_newton.clear();
    num_steps = 0;
  };
  for (;;) {
    result.residual = iterate.norm / scale;
    if (const auto reason = reason_to_end(result, options, interruption)) {
      return end(*reason == Outcome::converged ? arrive(system, t, iterate.state, x) : *reason);
    }

    if (result.iterations == 0) {
      const NodalVector start_x = system.vector_of(start);
      use(system.find_factor(start.t, start_x));
      if (factor == nullptr) use(system.factorise(start.t, start_x));
      // A body that can move freely at rest has no equilibrium once it is pushed.
      if (factor == nullptr && system.feels_nothing(start.t, start_x)) {
        return end(Outcome::tangent_not_factorised);
      }
    }
    if (factor == nullptr) {
      use(system.factorise(t, iterate.state));
      result.factor_t = t;
      result.factor_state = iterate.state;
      if (factor == nullptr) return end(Outcome::tangent_not_factorised);
      fresh = true;
    }
    ++result.iterations;
    Eigen::VectorXd step =
        quasi_newton.direction(iterate.r, [&](auto columns) { system.solve(*factor, columns); });
    const double step_norm = step.lpNorm<Eigen::Infinity>();
    if (num_steps == 0) first_step = step_norm;
    if (num_steps >= kStepsBeforeJudging &&
        std::pow(step_norm / first_step, 1.0 / num_steps) > options.contraction) {
      factor = nullptr;
      continue;
    }
    ++num_steps;
    double slope = step.dot(iterate.r);
    if (slope > 0 && !system.is_saddle()) {
      // The tangent is indefinite. The energy falls along the opposite direction.
      step = -step;
      slope = -slope;
    }
    const Eigen::VectorXd old_r = iterate.r;
    const double length = step.allFinite() ? search(system, t, step, slope, iterate) : 0;
    if (length == 0) {
      if (fresh) return end(Outcome::not_converged);
      factor = nullptr;
    } else {
      quasi_newton.update(length * step, iterate.r - old_r);
      if (length < kShortStep && !fresh) factor = nullptr;
    }
    fresh = false;
  }
}

Correction correct_by_iteration(CondensedSystem& system, const EquilibriumOptions& options,
                                const Interruption& interruption, const Eigen::VectorXd& t,
                                NodalVector& x) {
  Correction result;
  const auto end = [&result](Outcome outcome) {
    result.outcome = outcome;
    return std::move(result);
  };
  const double scale = system.displacement_scale(t);
  Iterate iterate;
  iterate.state = x;
  if (!evaluate(system, t, iterate)) return end(Outcome::not_converged);
  double forcing = kLargestForcing;
  double last_norm = 0;
  for (;;) {
    result.residual = iterate.norm / scale;
    if (const auto reason = reason_to_end(result, options, interruption)) {
      return end(*reason == Outcome::converged ? arrive(system, t, iterate.state, x) : *reason);
    }
    ++result.iterations;

    if (last_norm > 0) {
      const double ratio = iterate.norm / last_norm;
      // Solve no more accurately than the tolerance at the end requires. (The safeguard of the
      // method is only needed for larger shares.)
      forcing = std::max(0.9 * ratio * ratio, 0.5 * options.tolerance / result.residual);
      forcing = std::clamp(forcing, kLeastForcing, kLargestForcing);
    }
    last_norm = iterate.norm;
    Eigen::MatrixXd step = -iterate.r;
    const SolveSummary summary = system.solve(*system.tangent(t, iterate.state), step, forcing);
    if (!(summary.residual <= kUseless)) return end(Outcome::tangent_not_solved);
    Eigen::VectorXd direction = step.col(0);
    double slope = direction.dot(iterate.r);
    if (slope > 0) {
      direction = -direction;
      slope = -slope;
    }
    if (search(system, t, direction, slope, iterate) == 0) return end(Outcome::not_converged);
  }
}

}  // namespace palpate
