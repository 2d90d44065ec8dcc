// SPDX-License-Identifier: BSD-3-Clause
// The corrector goes from a predicted state to the equilibrium near it, while the tool is held.
#pragma once

#include <functional>
#include <memory>

#include "base/outcome.h"
#include "equilibrium/condensed_system.h"
#include "equilibrium/options.h"
#include "equilibrium/quasi_newton.h"
#include "equilibrium/state.h"

namespace palpate {

/// Gives Outcome::converged as long as there is no reason to stop, else the reason.
using Interruption = std::function<Outcome()>;

struct Correction {
  Outcome outcome = Outcome::not_converged;
  /// Largest component of the residual, see EquilibriumOptions::tolerance.
  double residual = 0;
  int iterations = 0;
  /// The last factor and the steps since then: together they approximate the inverse of the tangent
  /// at the end. Null where the factor was of no more use; valid until the next factorisation.
  TangentFactor* factor = nullptr;
  /// Where the tool and the body were when it was made, if that was on the way; else empty.
  Eigen::VectorXd factor_t;
  NodalVector factor_state;
  std::unique_ptr<QuasiNewton> quasi_newton;
};

/// Goes by a quasi-Newton method from `x`, with the tool at t, with the factor at `start` as long
/// as that contracts. A line search lessens the energy, which has a minimum at a stable
/// equilibrium, or with pressures, where it has a saddle, the norm of the residual. A trial state
/// that inverts a cell of a law with a barrier has infinite energy and is drawn back.
[[nodiscard]] Correction correct(CondensedSystem& system, const EquilibriumOptions& options,
                                 const Interruption& interruption, const LinearisedState& start,
                                 const Eigen::VectorXd& t, NodalVector& x);

/// Does the same without a factor, by Newton's method with the tangent at each state, for which
/// conjugate gradients solve no better than is of use: the share of the residual that they leave
/// follows how it shrinks (Eisenstat & Walker, Choosing the forcing terms in an inexact Newton
/// method, SIAM J. Sci. Comput. 17, 1996, choice 2).
[[nodiscard]] Correction correct_by_iteration(CondensedSystem& system,
                                              const EquilibriumOptions& options,
                                              const Interruption& interruption,
                                              const Eigen::VectorXd& t, NodalVector& x);

}  // namespace palpate
