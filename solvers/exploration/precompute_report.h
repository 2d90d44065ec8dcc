// SPDX-License-Identifier: BSD-3-Clause
// The figures of an exploration.
#pragma once

#include <cstdint>
#include <map>

#include "base/outcome.h"
#include "base/types.h"
#include "equilibrium/work.h"
#include "schedule/scheduler.h"

namespace palpate {

struct PrecomputeReport {
  int num_ranks = 1;
  Index num_cells = 0;
  /// The number of unknowns of all bodies, without those that the tool of the first tool space
  /// prescribes.
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

/// Combines the reports of all ranks. Ranks that serve others in a solve have empty reports.
/// @note Collective
void combine(PrecomputeReport& report, Communicator& communicator);

/// Adds the figures of an earlier exploration. The later one says whether the space is complete.
void add_earlier(PrecomputeReport& report, const PrecomputeReport& earlier);

}  // namespace palpate
