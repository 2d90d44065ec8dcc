// SPDX-License-Identifier: BSD-3-Clause
// The corrector finds the equilibrium near a predicted state, with the tool held in place.
#pragma once

#include <functional>
#include <memory>

#include "base/outcome.h"
#include "equilibrium/condensed_system.h"
#include "equilibrium/options.h"
#include "equilibrium/quasi_newton.h"
#include "equilibrium/state.h"

namespace palpate {

/// Returns Outcome::converged while the solve may go on, else the reason to stop it.
using Interruption = std::function<Outcome()>;

struct Correction {
  Outcome outcome = Outcome::not_converged;
  /// Largest component of the residual, see EquilibriumOptions::tolerance.
  double residual = 0;
  int iterations = 0;
  /// The last factor. With the steps since it was made it approximates the inverse of the tangent
  /// at the end. It is null if it was of no use any more. It is valid until the next factorisation.
  TangentFactor* factor = nullptr;
  /// The tool and the state that the factor belongs to if it was made within this correction; else
  /// empty.
  Eigen::VectorXd factor_t;
  NodalVector factor_state;
  std::unique_ptr<QuasiNewton> quasi_newton;
};

/// Finds the equilibrium from `x` with the tool at t, by a quasi-Newton method with the factor at
/// `start`, as long as this contracts. A line search decreases the energy, which has a minimum at a
/// stable equilibrium, or for a saddle (with pressures) the norm of the residual. A trial state
/// that inverts a cell of a law with a barrier has infinite energy, and the step is shortened.
[[nodiscard]] Correction correct(CondensedSystem& system, const EquilibriumOptions& options,
                                 const Interruption& interruption, const LinearisedState& start,
                                 const Eigen::VectorXd& t, NodalVector& x);

/// Finds the equilibrium without a factor, by Newton's method with the tangent at each state.
/// Conjugate gradients solve each system only as accurately as is of use: the share of the residual
/// that they leave follows from how it shrinks (Eisenstat & Walker, Choosing the forcing terms in
/// an inexact Newton method, SIAM J. Sci. Comput. 17, 1996, choice 2).
[[nodiscard]] Correction correct_by_iteration(CondensedSystem& system,
                                              const EquilibriumOptions& options,
                                              const Interruption& interruption,
                                              const Eigen::VectorXd& t, NodalVector& x);

}  // namespace palpate
