// SPDX-License-Identifier: BSD-3-Clause
// How wrong the forces of a reduced model are, beside those of the whole body.
#pragma once

#include <string>
#include <vector>

#include "dynamics/dynamic_solver.h"
#include "equilibrium/equilibrium.h"
#include "reduced/reduced_body.h"

namespace palpate {

/// Of the force of a tool, as shares of the largest force of the path.
struct PathError {
  double mean = 0;
  double rms = 0;
  double max = 0;
  /// N.
  double largest_force = 0;
  /// The largest one of the path, see ReducedState::trust.
  double largest_trust = 0;
  /// Places or steps that were compared, and those where the reduced body did not converge.
  int num_compared = 0;
  int num_failed = 0;
};

/// Equilibria with the tools at places [d × places], m, each from rest; those that the whole body
/// does not reach are left out.
[[nodiscard]] PathError measure_equilibria(const ReducedModel& model, EquilibriumSolver& whole,
                                           const Eigen::MatrixXd& places);

/// The motion along a path until a time, both in steps of the options' length; those that the whole
/// body halves are one step of the reduced body all the same.
/// @throws BackendError the whole body does not reach the end.
[[nodiscard]] PathError measure_motion(const ReducedModel& model, DynamicSolver& whole,
                                       const ToolPath& path, double until,
                                       const ReducedBodyOptions& options);

}  // namespace palpate
