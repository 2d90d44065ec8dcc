// SPDX-License-Identifier: BSD-3-Clause
// The way from one equilibrium to another of which only the end matters: a load is put on, or tools
// are brought to where a motion begins.
#pragma once

#include <functional>
#include <string>

#include "equilibrium/condensed_system.h"
#include "equilibrium/corrector.h"
#include "equilibrium/options.h"

namespace palpate {

struct Ramp {
  /// Prepares a share of the way, from 0 to 1, and gives the coordinates of the tools there [d].
  std::function<Eigen::VectorXd(double share)> at;
  /// The longest increment of the share that is tried.
  double longest_increment = 1;
};

struct RampEnd {
  Outcome outcome = Outcome::not_converged;
  /// What is beyond the end is an equilibrium that is not stable and has cells inside out.
  bool is_unstable = false;
  /// Largest component of the residual, see EquilibriumOptions::tolerance.
  double residual = 0;
  int iterations = 0;
  /// How far it has come: to 1 where it has converged.
  double share = 0;
};

/// How far a ramp that did not converge has come, and what is beyond: "with a share of 0.5 …".
[[nodiscard]] std::string describe(const RampEnd& end);

/// Goes from the equilibrium x at the share 0 to that at 1, in increments that are halved where one
/// does not converge, and doubled where two have. x is the last equilibrium on the way. A corner
/// that is inside out ends nothing: where the equilibrium is stable, it is for flags::inverted.
[[nodiscard]] RampEnd follow_ramp(CondensedSystem& system, const EquilibriumOptions& options,
                                  const Interruption& interruption, const Ramp& ramp,
                                  NodalVector& x);

}  // namespace palpate
