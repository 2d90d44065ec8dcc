// SPDX-License-Identifier: BSD-3-Clause
// From a scene to a state space: the transitions that a strategy asks for are made on all ranks,
// and what they find is recorded.
//
// [P08] Peterlík & Matyska, Haptic Interaction with Soft Tissues Based on State-Space
// Approximation, EuroHaptics 2008.
#pragma once

#include <functional>
#include <map>
#include <vector>

#include "equilibrium/work.h"
#include "exploration/precompute_options.h"
#include "schedule/scheduler.h"
#include "state_space/touch_space.h"

namespace palpate {

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
  /// Where the body is at rest, see Scene::settled.
  SettledBody settled;
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
