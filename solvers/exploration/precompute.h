// SPDX-License-Identifier: BSD-3-Clause
// From a scene to a state space: all ranks make the transitions that the strategies ask for, and
// record what they find.
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
  /// Unknowns, without those that the tool of the first tool space prescribes.
  Index num_unknowns = 0;
  /// Configurations that were solved in this run, and those that the file had.
  std::int64_t num_solved = 0;
  std::int64_t num_reused = 0;
  /// These configurations by outcome and by flag; one with several flags counts for each.
  std::map<Outcome, std::int64_t> num_by_outcome;
  std::map<Flags, std::int64_t> num_by_flag;
  /// The largest number of configurations that the strategies can find.
  std::int64_t num_expected = 0;
  /// Check-points that no usable configuration within the force limit leads to.
  std::int64_t num_not_reached = 0;
  /// Transitions between levels that were made in this run, and new levels that they have found.
  std::int64_t num_transitions = 0;
  std::int64_t num_levels = 0;
  /// Transitions, of this run or an earlier one, that have found one more level than the
  /// kMostLevels of a check-point; that level is not kept.
  std::int64_t num_beyond_most_levels = 0;
  std::int64_t iterations = 0;
  /// States that went to another rank, as starts of targets that it took over; that rank factorises
  /// them again.
  std::int64_t num_states_given = 0;
  /// Rounds in which cells of a rigid tool's space were halved.
  int num_rounds = 0;
  /// Intermediate states that were solved for in this run; those among them that did not converge;
  /// and their time, summed over all ranks, s. They do not count as configurations.
  std::int64_t num_intermediate_states = 0;
  std::int64_t num_intermediate_states_failed = 0;
  double intermediate_seconds = 0;
  /// Wall time of the slowest rank, s: of the exploration, and of the reduction and the writing
  /// after it.
  double exploration_seconds = 0;
  double finishing_seconds = 0;
  /// The work of all ranks together.
  Work work;
  ScheduleReport schedule;
  /// The whole space was explored; false: the run was aborted.
  bool complete = false;
};

struct PrecomputeResult {
  /// The space on rank 0; empty elsewhere.
  TouchSpace space;
  /// The equilibrium of the body under its load, see Scene::settled.
  SettledBody settled;
  /// The report is equal on every rank.
  PrecomputeReport report;
  /// On rank 0: damaged parts of the file, which were removed when the run went on from it, see
  /// StateSpaceFile::left_out().
  std::vector<std::string> damaged;
};

struct ProgressState {
  /// Configurations that are known, and the expected number of all, as far as is known now.
  std::int64_t num_done = 0;
  std::int64_t num_expected = 0;
  /// Configurations that were solved for in this run.
  std::int64_t num_solved = 0;
  /// Time since the start, and the expected time to the end, s; below zero: it is not known.
  double seconds = 0;
  double seconds_left = -1;

  [[nodiscard]] double share() const {
    return num_expected > 0 ? static_cast<double>(num_done) / static_cast<double>(num_expected) : 0;
  }
};

/// Called now and then on every rank: on rank 0 with the progress of all ranks, elsewhere with that
/// of the rank alone. If it returns false on any rank, the exploration ends, and what was found
/// until then is kept.
using Progress = std::function<bool(const ProgressState&)>;

/// Computes the space of the rigid tool and of the active nodes that the options name.
/// @param scene The same on every rank.
/// @throws InputError an active node at which the tip cannot be placed, see BondedPatches::around;
///   an option out of its range; more ranks for a solve than there are; a file of another scene, or
///   of a space with other settings, see StateSpaceFile::add_tool_space.
/// @note Collective
[[nodiscard]] PrecomputeResult precompute(const Scene& scene, const PrecomputeOptions& options,
                                          Communicator& communicator, const Progress& progress);

}  // namespace palpate
