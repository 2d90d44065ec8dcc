// SPDX-License-Identifier: BSD-3-Clause
// A ramp leads from one equilibrium to another where only the end matters, as when a load is
// applied or when tools are brought to where a motion begins.
#pragma once

#include <functional>
#include <string>

#include "equilibrium/condensed_system.h"
#include "equilibrium/corrector.h"
#include "equilibrium/options.h"

namespace palpate {

struct Ramp {
  /// Prepares a share of the ramp, from 0 to 1, and returns the coordinates of the tools there [d].
  std::function<Eigen::VectorXd(double share)> at;
  /// The longest increment of the share that is tried.
  double longest_increment = 1;
};

struct RampEnd {
  Outcome outcome = Outcome::not_converged;
  /// Whether the ramp ended because the next equilibrium is not stable and has inverted cells.
  bool is_unstable = false;
  /// Largest component of the residual, see EquilibriumOptions::tolerance.
  double residual = 0;
  int iterations = 0;
  /// The share that was reached; 1 if it has converged.
  double share = 0;
};

/// Describes how far a ramp that did not converge has come, and what stopped it: "with a share of
/// 0.5 …".
[[nodiscard]] std::string describe(const RampEnd& end);

/// Goes from the equilibrium x at the share 0 to that at 1, in increments that are halved if one
/// does not converge and doubled after two that do. x becomes the last equilibrium. An inverted
/// corner does not end the ramp if the equilibrium is stable; flags::inverted of the state at the
/// end reports it.
[[nodiscard]] RampEnd follow_ramp(CondensedSystem& system, const EquilibriumOptions& options,
                                  const Interruption& interruption, const Ramp& ramp,
                                  NodalVector& x);

}  // namespace palpate
