// SPDX-License-Identifier: BSD-3-Clause
// The error of the forces of a reduced model, compared with those of the whole body.
#pragma once

#include <string>
#include <vector>

#include "dynamics/dynamic_solver.h"
#include "equilibrium/equilibrium.h"
#include "reduced/reduced_body.h"

namespace palpate {

/// Errors of the force on a tool, as shares of the largest force of the path.
struct PathError {
  double mean = 0;
  double rms = 0;
  double max = 0;
  /// The largest force of the path, N.
  double largest_force = 0;
  /// The largest ReducedState::trust of the path.
  double largest_trust = 0;
  /// The number of places or steps that were compared, and of those at which the reduced body did
  /// not converge.
  int num_compared = 0;
  int num_failed = 0;
};

/// Compares equilibria with the tools at places [d × places], m, each reached from rest. Places
/// that the whole body does not reach are left out.
[[nodiscard]] PathError measure_equilibria(const ReducedModel& model, EquilibriumSolver& whole,
                                           const Eigen::MatrixXd& places);

/// Compares the motion along a path until a time, s, with both bodies in steps of the options'
/// length. If the whole body halves a step, the reduced body still takes it as one.
/// @throws BackendError the whole body does not reach the end.
[[nodiscard]] PathError measure_motion(const ReducedModel& model, DynamicSolver& whole,
                                       const ToolPath& path, double until,
                                       const ReducedBodyOptions& options);

}  // namespace palpate
