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
/// If the slope at the trial that was accepted is more than this share of the first one, a longer
/// trial that was refused shows where the energy is less. Two further trials at the most.
constexpr double kStillSteep = 0.3;
constexpr int kMostRefinements = 2;
/// Trials that are not finite are halved this often, and quartered after that.
constexpr int kHalvedTrials = 2;
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

/// A point of a line search: its length, the energy there and its slope.
struct OnLine {
  double length = 0;
  double energy = 0;
  double slope = 0;
};

/// The minimum of the cubic through the energies and the slopes of two points, well within them
/// (Nocedal & Wright, 3.5).
double between(const OnLine& low, const OnLine& high) {
  const double way = high.length - low.length;
  const double d = low.slope + high.slope - 3 * (high.energy - low.energy) / way;
  const double root = std::sqrt(std::max(0.0, d * d - low.slope * high.slope));
  const double share = 1 - (high.slope + root - d) / (high.slope - low.slope + 2 * root);
  constexpr double kMargin = 0.1;
  // Of a slope that does not change, there is no share.
  return low.length + way * (share > kMargin ? std::min(share, 1 - kMargin) : kMargin);
}

/// Whether a trial decreases the energy enough.
/// @param slope That of the energy at the start of the line.
/// @param at_rest CondensedSystem::energies_at_rest().
bool accept_by_energy(const Iterate& old, const Iterate& trial, double slope, double at_rest,
                      double length) {
  const double change = trial.energy - old.energy;
  if (change <= kSufficientDecrease * length * slope) return true;
  const bool level = std::abs(change) <=
                     kEnergyRounding * (std::abs(old.energy) + std::abs(trial.energy) + at_rest);
  return level && trial.norm < old.norm;
}

bool accept_by_residual(const CondensedSystem& system, const Iterate& old, const Iterate& trial,
                        double length) {
  return system.euclidean_norm(trial.r) <=
         (1 - kSufficientDecrease * length) * system.euclidean_norm(old.r);
}

/// Line search: moves along `step` until a trial is good enough. Without a factor a trial costs far
/// less than the next step. So if a longer one was too long there, as where the tool reaches
/// further points, the least energy between the two is searched for.
/// @returns the accepted length of the step; 0: none was accepted.
double search(CondensedSystem& system, const Eigen::VectorXd& q, const Eigen::VectorXd& step,
              double slope, Iterate& iterate) {
  const NodalVector direction = system.as_state(step);
  const bool by_residual = system.is_saddle();
  const bool is_iterative = system.is_iterative();
  const Iterate old = iterate;
  Iterate trial;
  double length = 1;
  const double longest = system.longest_step();
  if (std::isfinite(longest)) {
    const Eigen::Index displacements = 3 * Eigen::Index{system.assembly().num_points()};
    length = std::min(1.0, longest / direction.head(displacements).lpNorm<Eigen::Infinity>());
  }
  length = std::min(length, system.longest_share(old.state, direction));
  OnLine low{0, old.energy, slope};
  std::optional<OnLine> high;
  int refinements = 0;
  for (int i = 0; i < kMaxBacktracks; ++i) {
    trial.state = old.state + length * direction;
    const bool is_finite = evaluate(system, q, trial);
    const OnLine here{length, trial.energy, is_finite ? step.dot(trial.r) : 0};
    const bool accepted =
        is_finite &&
        (by_residual ? accept_by_residual(system, old, trial, length)
                     : accept_by_energy(old, trial, slope, system.energies_at_rest(), length) &&
                           (low.length == 0 || trial.energy <= low.energy));
    if (accepted) {
      std::swap(iterate, trial);
      low = here;
      const bool may_gain = high && low.slope < kStillSteep * slope;
      if (!may_gain || ++refinements > kMostRefinements) return low.length;
      length = between(low, *high);
      continue;
    }
    if (low.length > 0) return low.length;
    if (!is_finite || by_residual) {
      length *= is_finite || (is_iterative && i < kHalvedTrials) ? 0.5 : 0.25;
    } else if (is_iterative) {
      high = here;
      length = std::min(between(low, here), 0.5 * length);
    } else {
      // With a factor a step costs little more than a trial: the minimum of the parabola through
      // the energy, its slope and the trial energy will do.
      const double change = trial.energy - old.energy;
      const double best = -slope * length * length / (2 * (change - slope * length));
      length = std::clamp(best, 0.1 * length, 0.5 * length);
    }
  }
  return low.length;
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
    const SolveSummary summary = system.descend(*system.tangent(t, iterate.state), step, forcing);
    const bool is_of_use =
        summary.residual <= kUseless || summary.status == SolveStatus::negative_curvature;
    if (!is_of_use) return end(Outcome::tangent_not_solved);
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
