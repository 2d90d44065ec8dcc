// SPDX-License-Identifier: BSD-3-Clause
// An exploration on ranks that are not there: the engine, its strategies and the scheduler are
// those that run under MPI; what a recorded space says of its configurations, and how long each
// took, stands in for the mechanics.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "exploration/precompute.h"
#include "exploration/steering.h"
#include "solvers/support/simulation.h"

namespace palpate::test {

/// A flat tool space, whole.
struct Recording {
  ToolSpaceSetup setup;
  /// With the time that each took.
  std::vector<ConfigurationSummary> configurations;
};

struct ReplayOptions {
  Machine machine;
  ScheduleOptions schedule;
  /// A busy rank polls so often: the length of a factorisation, s.
  double poll_interval = 25e-3;
  /// The fields of a configuration.
  std::size_t state_bytes = 200'000;
  /// Of the tangent at a start, on a rank that does not keep its factor, s.
  double factorisation_seconds = 25e-3;
  /// Of each tool space, configurations that an earlier run has left.
  std::size_t num_known = 0;
  /// Changes a message before the engine gets it; empty: none is changed.
  std::function<void(Bytes&)> damage;
  /// Steers on a rank before its tasks, by the rank and the number of the task, from 1; empty, or
  /// where it gives nothing: nobody does.
  std::function<std::optional<Steering>(int rank, int task)> steer;
};

struct Replay {
  /// s
  double makespan = 0;
  /// Of all ranks.
  PrecomputeReport report;
  /// Starts whose factor another rank had made already.
  std::int64_t num_factorised_again = 0;
  UnderWay most_under_way;
};

/// @param recording_of_tool_space Of each tool space, index into recordings: what it behaves as.
/// @throws InputError a recording of a space that is not whole, or that has levels.
[[nodiscard]] Replay replay(const std::vector<Recording>& recordings,
                            const std::vector<int>& recording_of_tool_space, int num_ranks,
                            const ReplayOptions& options = {});

}  // namespace palpate::test
