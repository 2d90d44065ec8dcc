// SPDX-License-Identifier: BSD-3-Clause
// From a scene to a state space: the transitions that a strategy asks for are made on all ranks,
// and what they find is recorded.
//
// [P08] Peterlík & Matyska, Haptic Interaction with Soft Tissues Based on State-Space
// Approximation, EuroHaptics 2008.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "equilibrium/equilibrium.h"
#include "exploration/contact_shell.h"
#include "schedule/scheduler.h"
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

/// What an exploration is expected to take.
struct ExplorationEstimate {
  /// Equilibria that are solved for, and check-points at which the tool touches nothing.
  std::int64_t num_configurations = 0;
  std::int64_t num_free = 0;
  /// Wall time on all ranks, s; what a rank needs in memory, and the file, bytes.
  double seconds = 0;
  double bytes_per_rank = 0;
  double file_bytes = 0;
};

struct PrecomputeOptions {
  /// A rigid tool. The active nodes that are named besides are explored after it.
  std::optional<ContactOptions> contact;
  /// Hears what a space of a rigid tool is expected to take, on rank 0, before it is explored. Some
  /// configurations are solved for to say so; empty: they are not.
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
  /// Largest error of the displacement that is carried for touching, as a share of the largest.
  double touch_bound = kDefaultTouchBound;
  /// Options of each solve. The number of kept factors follows from the resolution; with
  /// third_derivatives, each configuration has its third derivative.
  EquilibriumOptions equilibrium;
  /// Name of a linear solver; empty: the default.
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

struct PrecomputeReport {
  int num_ranks = 1;
  Index num_cells = 0;
  /// Number of unknowns without those of the first active node and of the patch that moves with it.
  Index num_unknowns = 0;
  /// Configurations solved in this run, and taken from the file.
  std::int64_t num_solved = 0;
  std::int64_t num_reused = 0;
  /// All these configurations by outcome, and by flag.
  std::map<Outcome, std::int64_t> num_by_outcome;
  std::map<Flags, std::int64_t> num_by_flag;
  /// Configurations that all strategies can lead to.
  std::int64_t num_expected = 0;
  /// Check-points that no usable configuration within the force limit leads to.
  std::int64_t num_not_reached = 0;
  /// Transitions between levels that were made in this run, and the configurations that were found
  /// by them.
  std::int64_t num_transitions = 0;
  std::int64_t num_levels = 0;
  /// Transitions, of this run or an earlier one, that have found a configuration beyond the
  /// kMostLevels of its check-point: it is not kept.
  std::int64_t num_beyond_most_levels = 0;
  std::int64_t iterations = 0;
  /// Starts whose states went to another rank with a share of the targets that follow from them;
  /// that rank makes their factors again.
  std::int64_t num_states_given = 0;
  /// Rounds in which cells of a rigid tool's space were halved.
  int num_rounds = 0;
  /// Intermediate states that were solved for in this run, those of them that did not converge, and
  /// the time of all ranks that they took, s; they count as no configurations.
  std::int64_t num_intermediate_states = 0;
  std::int64_t num_intermediate_states_failed = 0;
  double intermediate_seconds = 0;
  /// Wall time, s, of the slowest rank: for the exploration, and for the POD and the rest after it.
  double exploration_seconds = 0;
  double finishing_seconds = 0;
  /// The work of all ranks together.
  Work work;
  ScheduleReport schedule;
  /// The whole space was explored: the run was not aborted.
  bool complete = false;
};

struct PrecomputeResult {
  /// Whole on rank 0, empty elsewhere.
  TouchSpace space;
  /// The same on every rank.
  PrecomputeReport report;
  /// What was damaged in the file that the run went on from, and was removed from it, see
  /// StateSpaceFile::left_out(); on rank 0.
  std::vector<std::string> damaged;
};

struct ProgressState {
  /// Configurations that are known, and that are expected in all as far as can be said now.
  std::int64_t num_done = 0;
  std::int64_t num_expected = 0;
  /// Configurations that were solved for in this run.
  std::int64_t num_solved = 0;
  /// Time since the begin, and until the end as it looks now, s; below zero: nothing can be said.
  double seconds = 0;
  double seconds_left = -1;

  [[nodiscard]] double share() const {
    return num_expected > 0 ? static_cast<double>(num_done) / static_cast<double>(num_expected) : 0;
  }
};

/// This is called on every rank now and then, on rank 0 with the state of all ranks, elsewhere with
/// that of the rank alone. Where it returns false on any rank the exploration ends, and what was
/// found until then is kept.
using Progress = std::function<bool(const ProgressState&)>;

/// Computes the space around each active node.
/// @param scene The same on every rank.
/// @note Collective
/// @throws InputError an active node that the tip cannot be put on, see BondedPatches::around; an
/// option out of
///   its range; more ranks a solve than there are; a file of another scene, or of a space that
///   holds other things, see StateSpaceFile::add_site.
[[nodiscard]] PrecomputeResult precompute(const Scene& scene, const PrecomputeOptions& options,
                                          Communicator& communicator, const Progress& progress);

}  // namespace palpate
