// SPDX-License-Identifier: BSD-3-Clause
#include "equilibrium/ramp.h"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

/// An increment is halved this often at the most.
constexpr int kMostHalvings = 8;

/// What the corrector starts from.
LinearisedState state_at(const CondensedSystem& system, const Eigen::VectorXd& q,
                         const NodalVector& x) {
  LinearisedState state;
  state.t = q;
  state.u = x.head(3 * Eigen::Index{system.assembly().num_points()});
  state.p = x.tail(system.assembly().num_pressures()).cwiseProduct(system.pressure_scale());
  return state;
}

}  // namespace

RampEnd follow_ramp(CondensedSystem& system, const EquilibriumOptions& options,
                    const Interruption& interruption, const Ramp& ramp, NodalVector& x) {
  RampEnd end;
  LinearisedState start = state_at(system, ramp.at(0), x);
  double increment = ramp.longest_increment;
  const double least_increment = std::ldexp(increment, -kMostHalvings);
  while (end.share < 1) {
    const double next = std::min(1.0, end.share + increment);
    const Eigen::VectorXd q = ramp.at(next);
    NodalVector trial = x;
    system.prescribe(q, trial);
    const Correction correction =
        system.is_iterative() ? correct_by_iteration(system, options, interruption, q, trial)
                              : correct(system, options, interruption, start, q, trial);
    end.iterations += correction.iterations;
    end.residual = correction.residual;
    end.outcome = correction.outcome;
    end.inverts =
        end.outcome == Outcome::converged && !(system.assembly().minimum_det_f(trial).value > 0);
    if (end.inverts) end.outcome = Outcome::not_converged;
    if (end.outcome == Outcome::converged) {
      end.share = next;
      x = trial;
      start = state_at(system, q, x);
      continue;
    }
    const bool is_told_to =
        end.outcome == Outcome::aborted || end.outcome == Outcome::budget_used_up;
    if (is_told_to || increment <= least_increment) break;
    increment /= 2;
  }
  return end;
}

}  // namespace palpate
