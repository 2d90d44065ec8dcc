// SPDX-License-Identifier: BSD-3-Clause
// The states of the whole body that a reduced model is made from.
#pragma once

#include <cstdint>
#include <vector>

#include "dynamics/dynamic_solver.h"
#include "equilibrium/equilibrium.h"
#include "materials/rheology.h"

namespace palpate {

/// The columns of both; one without columns may have any number of rows.
[[nodiscard]] Eigen::MatrixXd side_by_side(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

struct TrainingStates {
  /// Displacement of every point [3 num_points × states], m.
  Eigen::MatrixXd u;
  /// Of the tools [d × states], m.
  Eigen::MatrixXd tools;
  /// States that were left out: there was no equilibrium.
  int num_left_out = 0;

  void append(const TrainingStates& others);
};

/// Places of tools of which one has moved: the 26 of a grid of 3 × 3 × 3 around its place at rest,
/// at half the reach and in full. @returns [d × places], m.
[[nodiscard]] Eigen::MatrixXd one_tool_places(int num_tools, double reach);
/// Random places of tools that all have moved [d × places], m; every second one has some tool at
/// the end of its reach.
[[nodiscard]] Eigen::MatrixXd random_places(int num_tools, double reach, int count,
                                            std::uint64_t seed);

/// Equilibria with the tools at each of the places.
[[nodiscard]] TrainingStates find_equilibria(EquilibriumSolver& solver,
                                             const Eigen::MatrixXd& places);

/// States in motion along each of the paths.
/// @param every Of so many steps one state is taken. A path that the body does not follow to its
///   end counts as a state that was left out.
[[nodiscard]] TrainingStates move_body(DynamicSolver& solver, const std::vector<ToolPath>& paths,
                                       int every);

}  // namespace palpate
