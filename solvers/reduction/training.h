// SPDX-License-Identifier: BSD-3-Clause
// The states of the whole body from which a reduced model is made.
#pragma once

#include <cstdint>
#include <vector>

#include "dynamics/dynamic_solver.h"
#include "equilibrium/equilibrium.h"
#include "materials/rheology.h"

namespace palpate {

/// The columns of both matrices; one without columns may have any number of rows.
[[nodiscard]] Eigen::MatrixXd side_by_side(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

struct TrainingStates {
  /// Displacement of every point [3 num_points × states], m.
  Eigen::MatrixXd u;
  /// Coordinates of the tools [d × states], m.
  Eigen::MatrixXd tools;
  /// States that were left out because there was no equilibrium.
  int num_left_out = 0;

  void append(const TrainingStates& others);
};

/// Places with one tool moved: the 26 other points of a 3 × 3 × 3 grid around its place at rest, at
/// half the reach and at the full reach.
/// @returns [d × places], m.
[[nodiscard]] Eigen::MatrixXd one_tool_places(int num_tools, double reach);
/// Random places with all tools moved [d × places], m. In every second one, a coordinate of a tool
/// has the full reach.
[[nodiscard]] Eigen::MatrixXd random_places(int num_tools, double reach, int count,
                                            std::uint64_t seed);

/// Finds the equilibria with the tools at each of the places.
[[nodiscard]] TrainingStates find_equilibria(EquilibriumSolver& solver,
                                             const Eigen::MatrixXd& places);

/// Takes states of the motion along each of the paths.
/// @param every The number of steps from one state to the next. A path that the body does not
///   follow to its end counts as a state that was left out.
[[nodiscard]] TrainingStates move_body(DynamicSolver& solver, const std::vector<ToolPath>& paths,
                                       int every);

}  // namespace palpate
