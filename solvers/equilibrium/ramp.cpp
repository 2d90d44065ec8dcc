// SPDX-License-Identifier: BSD-3-Clause
#include "equilibrium/ramp.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace palpate {
namespace {

/// The largest number of times that the first increment is halved.
constexpr int kMostHalvings = 8;
/// After a halving, the number of increments that must converge before the increment is doubled.
constexpr int kIncrementsBeforeDoubling = 2;

/// The state from which the corrector starts.
LinearisedState state_at(const CondensedSystem& system, const Eigen::VectorXd& q,
                         const NodalVector& x) {
  LinearisedState state;
  state.t = q;
  state.u = x.head(3 * Eigen::Index{system.assembly().num_points()});
  state.p = x.tail(system.assembly().num_pressures()).cwiseProduct(system.pressure_scale());
  return state;
}

/// Whether the equilibrium x is stable.
bool is_stable(CondensedSystem& system, const Eigen::VectorXd& q, const NodalVector& x) {
  if (system.is_iterative()) {
    return system.find_inertia(*system.tangent(q, x)).num_negative == 0;
  }
  const TangentFactor* factor = system.factorise(q, x);
  return factor != nullptr && system.negative_pivots(*factor) == 0;
}

}  // namespace

std::string describe(const RampEnd& end) {
  std::ostringstream text;
  text << "with a share of " << end.share << " of it the solve has converged, and beyond that "
       << (end.is_unstable ? "the equilibrium is not stable" : "it is " + to_string(end.outcome));
  return text.str();
}

RampEnd follow_ramp(CondensedSystem& system, const EquilibriumOptions& options,
                    const Interruption& interruption, const Ramp& ramp, NodalVector& x) {
  RampEnd end;
  LinearisedState start = state_at(system, ramp.at(0), x);
  double increment = ramp.longest_increment;
  const double least_increment = std::ldexp(increment, -kMostHalvings);
  int good_increments = 0;
  // The change of x per unit of the share.
  NodalVector slope = NodalVector::Zero(x.size());
  while (end.share < 1) {
    const double next = std::min(1.0, end.share + increment);
    const Eigen::VectorXd q = ramp.at(next);
    NodalVector trial = x + (next - end.share) * slope;
    system.prescribe(q, trial);
    if (!system.evaluate(q, trial).is_finite()) {
      trial = x;
      system.prescribe(q, trial);
    }
    const Correction correction =
        system.is_iterative() ? correct_by_iteration(system, options, interruption, q, trial)
                              : correct(system, options, interruption, start, q, trial);
    end.iterations += correction.iterations;
    end.residual = correction.residual;
    end.outcome = correction.outcome;
    // An increment that is too long may end on another branch, which has inverted cells and is not
    // stable. An inverted corner in a stable equilibrium has another cause.
    end.is_unstable = end.outcome == Outcome::converged &&
                      system.assembly().minimum_det_f(trial).value <= 0 &&
                      !is_stable(system, q, trial);
    if (end.is_unstable) end.outcome = Outcome::not_converged;
    if (end.outcome == Outcome::converged) {
      if (!system.interaction().has_potential()) slope = (trial - x) / (next - end.share);
      end.share = next;
      x = trial;
      start = state_at(system, q, x);
      if (++good_increments == kIncrementsBeforeDoubling) {
        good_increments = 0;
        increment = std::min(2 * increment, ramp.longest_increment);
      }
      continue;
    }
    const bool is_told_to =
        end.outcome == Outcome::aborted || end.outcome == Outcome::budget_used_up;
    if (is_told_to || increment <= least_increment) break;
    increment /= 2;
    good_increments = 0;
  }
  return end;
}

}  // namespace palpate
