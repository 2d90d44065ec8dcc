// SPDX-License-Identifier: BSD-3-Clause
// The options of an exploration.
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
#include "fields/reduced_fields.h"
#include "interaction/rigid_tool.h"
#include "state_space/tool_space.h"
#include "state_space/touch_space.h"

namespace palpate {

/// The step of the orientations of a tool that is turned, rad.
inline constexpr double kUsualTurnSpacing = 15 * M_PI / 180;
inline constexpr double kLargestTurnSpacing = 45 * M_PI / 180;

/// A rigid tool that presses the body anywhere.
struct ContactOptions {
  /// Its thickness and stiffness may be 0, for values that suit the tool and the body.
  RigidTool tool;
  /// Side of the coarsest cells, m; 0: two fifths of the tool's radius.
  double spacing = 0;
  ShellOptions shell;
  /// Of a tool that is turned: the step of its orientations at most, rad; 0: kUsualTurnSpacing.
  double turn_spacing = 0;
  /// The exploration is refused if more configurations than these are expected.
  std::int64_t most_configurations = 100'000;
};

struct PrecomputeOptions {
  /// A rigid tool. If active nodes are named too, they are explored after it.
  std::optional<ContactOptions> contact;
  /// Called on rank 0 with the expected cost before the exploration begins: of the rigid tool
  /// first, then of the active nodes. Empty: the cost is not measured.
  std::function<void(const ExplorationEstimate&)> expects;

  /// In a run of one body, the points of its mesh that are touched. If it is empty, none with a
  /// rigid tool, else every touchable point.
  std::vector<Index> active_nodes;
  /// The surface within this distance of a node moves with it, see interaction/bonded_patch.h, m;
  /// 0: the node alone.
  double tip_radius = 0;
  /// Half the side of the box of check-points, m.
  double half_width = 0.01;
  /// Check-points along an axis; odd. With a tolerance these are the corners of the coarsest cells.
  int resolution = 7;
  /// The tolerance of the force, N, or as a share of the largest force within the limit. Cells are
  /// refined until it is reached, down to 1/64 of their side. 0: the grid is uniform.
  double tolerance = 0;
  bool tolerance_is_relative = true;
  /// The force limit of the device, N; 0: there is none.
  double force_limit = 0;
  /// With a tolerance, automatic means flat.
  History history = History::automatic;
  /// Equilibria at equal steps of the straight line to each configuration of level 0, as further
  /// places where the force is known [P08]. Each takes about 60 % of the time of a configuration.
  int intermediate_states = 0;
  /// Whether the error of the mesh is estimated at each configuration. Those that an earlier run
  /// has found without it stay without it.
  bool estimate_mesh_error = false;
  /// The file of the space, from which an exploration is resumed; empty: the space is in memory
  /// only.
  std::filesystem::path file;
  /// Largest error of the displacement that is kept for touching, as a share of the largest
  /// displacement. A file that was written with a larger error cannot be made better.
  double touch_bound = kDefaultTouchBound;
  /// The part of the fields that the file of a complete space keeps. All is kept until then. A file
  /// that keeps less cannot keep more later.
  Keep keep = Keep::surface;
  /// Options of each solve. The number of kept factors follows from the resolution. With
  /// third_derivatives, each configuration has its third derivative.
  EquilibriumOptions equilibrium;
  /// One of tangent_solver_names(); empty: the one that suits the body.
  std::string linear_solver;
  /// The number of neighbouring ranks that share each factorisation and solve, with MUMPS, for
  /// bodies that do not fit the memory of one rank. The first rank of each group explores. The
  /// others serve it, and their progress function is not called. Ranks that fill no group join the
  /// last one. Sums within a group depend on the group, so that the space is the same to the
  /// solver's tolerance and not to the bit.
  int ranks_per_solve = 1;
};

/// @throws InputError a field out of its range, by name.
void validate(const PrecomputeOptions& options);

/// The number of layers of check-points in the shell of a rigid tool, about.
inline constexpr int kShellLayers = 6;

/// The number of factors that a rank keeps: one for each layer on the depth-first path, and that of
/// a step.
[[nodiscard]] constexpr int num_kept_factors(int num_layers) { return num_layers + 2; }

/// The options of the solvers of an exploration.
[[nodiscard]] EquilibriumOptions exploring(const PrecomputeOptions& options);

}  // namespace palpate
