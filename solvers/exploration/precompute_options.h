// SPDX-License-Identifier: BSD-3-Clause
// What is explored, and how.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "equilibrium/options.h"
#include "exploration/contact_shell.h"
#include "exploration/exploration_estimate.h"
#include "interaction/rigid_tool.h"
#include "state_space/tool_space.h"
#include "state_space/touch_space.h"

namespace palpate {

/// A rigid tool that presses the body anywhere.
struct ContactOptions {
  /// With 0 for the thickness and stiffness that suit it and the body.
  RigidTool tool;
  /// Side of the coarsest cells, m; 0: two fifths of the tool's radius.
  double spacing = 0;
  ShellOptions shell;
  /// The exploration does not begin where more configurations are to be expected.
  std::int64_t most_configurations = 100'000;
};

struct PrecomputeOptions {
  /// A rigid tool. The active nodes that are named besides are explored after it.
  std::optional<ContactOptions> contact;
  /// Hears on rank 0 what the exploration is expected to take, before it begins: of a rigid tool,
  /// and then of the active nodes. Empty: nothing is measured to say so.
  std::function<void(const ExplorationEstimate&)> expects;

  /// The points of the mesh that are touched; empty: with a rigid tool none, else all that the
  /// scene says are touchable.
  std::vector<Index> active_nodes;
  /// The surface patch within this distance of a node moves with it, see
  /// interaction/bonded_patch.h, m; 0: the node alone.
  double tip_radius = 0;
  /// Half the side of the box of check-points, m.
  double half_width = 0.01;
  /// Check-points along an axis; odd. With a tolerance these are the corners of the coarsest cells.
  int resolution = 7;
  /// The error of the force that is asked for, N, or as a share of the largest force within the
  /// limit. Cells are refined until it is reached, at most to 1/64 of their side. 0: the grid is
  /// uniform.
  double tolerance = 0;
  bool tolerance_is_relative = true;
  /// The force limit of the device, N; 0: there is none.
  double force_limit = 0;
  /// With a tolerance, automatic means flat.
  History history = History::automatic;
  /// Equilibria at equal parts of the straight way to each configuration of level 0, as more places
  /// at which the force is known [P08]; each costs about 60 % of a configuration.
  int intermediate_states = 0;
  /// The file in which the space is kept and from which it is resumed; empty: in memory alone.
  std::filesystem::path file;
  /// Largest error of the displacement that is carried for touching, as a share of the largest. A
  /// file that keeps it with a larger error cannot do better again.
  double touch_bound = kDefaultTouchBound;
  /// What of the fields a file keeps of a space that is complete. Until then all is kept. A file
  /// that keeps less cannot keep more again.
  Keep keep = Keep::surface;
  /// Options of each solve. The number of kept factors follows from the resolution; with
  /// third_derivatives, each configuration has its third derivative.
  EquilibriumOptions equilibrium;
  /// One of tangent_solver_names(); empty: the one that suits the body.
  std::string linear_solver;
  /// Neighbouring ranks that factorise and solve together, with MUMPS, for bodies that are too
  /// large for the memory of one. The first of each group explores, the others serve it and are not
  /// asked for progress; ranks that fill no group are of the last one. The sums within a group
  /// depend on who is first, so that the space is the same to the solver's tolerance, not to the
  /// bit.
  int ranks_per_solve = 1;
};

/// @throws InputError a field out of its range, by name.
void validate(const PrecomputeOptions& options);

/// Layers of check-points in the shell around a body that a rigid tool presses, about.
inline constexpr int kShellLayers = 6;

/// The number of factors that a rank keeps: those of the starts on the way down through so many
/// layers, depth first, and that of a step.
[[nodiscard]] constexpr int num_kept_factors(int num_layers) { return num_layers + 2; }

}  // namespace palpate
