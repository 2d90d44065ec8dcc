// SPDX-License-Identifier: BSD-3-Clause
// From a predicted state to the equilibrium near it, the sites held.
#pragma once

#include <functional>
#include <memory>

#include "base/outcome.h"
#include "equilibrium/held_body.h"
#include "equilibrium/options.h"
#include "equilibrium/quasi_newton.h"

namespace palpate {

/// Outcome::converged as long as there is no reason to stop.
using Interruption = std::function<Outcome()>;

struct Correction {
  Outcome outcome = Outcome::not_converged;
  /// Largest component of the residual, see EquilibriumOptions::tolerance.
  double residual = 0;
  int iterations = 0;
  /// The last factor, and the steps since: together an approximation of the inverse of the tangent
  /// at the end. Null where it was of no more use; good until the next factorisation.
  TangentFactor* factor = nullptr;
  std::unique_ptr<QuasiNewton> quasi_newton;
};

/// Quasi-Newton from `state`, whose sites are at t, with the factor at `start` as long as that
/// contracts, and line search: on the energy, which is a minimum at a stable equilibrium, or with
/// pressures, where it is a saddle, on the norm of the residual. A trial state that inverts a cell
/// of a law with a barrier has infinite energy and is drawn back.
[[nodiscard]] Correction correct(HeldBody& body, const EquilibriumOptions& options,
                                 const Interruption& interruption, const NodalVector& start,
                                 const Eigen::VectorXd& t, NodalVector& state);

}  // namespace palpate
