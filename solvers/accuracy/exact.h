// SPDX-License-Identifier: BSD-3-Clause
// Exact equilibria at test points, found on all ranks. A point is reached from rest by way of its
// anchor (draw.h), which the points around it share, with its factor; where the anchor or what is
// found from there is not regular, straight from rest. One on a walk is reached from the one before
// it.
#pragma once

#include <filesystem>
#include <vector>

#include "exploration/precompute.h"
#include "state_space/test_point.h"

namespace palpate {

struct ExactOptions {
  /// Points of each active node.
  int test_points = 500;
  std::int64_t seed = 1;
  /// Where they are kept, and taken from: a state-space file of the scene, such as that of the
  /// space itself; empty: in memory alone.
  std::filesystem::path file;
  EquilibriumOptions equilibrium;
};

/// @throws InputError a field out of its range, by name.
void validate(const ExactOptions& options);

struct ExactResult {
  /// Of each site, in the order of draw_test_points(); whole on rank 0, empty elsewhere.
  std::vector<std::vector<TestPoint>> points;
  /// Solved in this run, on all ranks, and taken from the file; on rank 0.
  std::int64_t num_solved = 0;
  std::int64_t num_reused = 0;
  /// It was not aborted; the same on every rank.
  bool complete = false;
};

/// @param scene The same on every rank.
/// @param sites The same on every rank.
/// @param progress Called now and then; false ends it, and what was found until then is in the
/// file.
/// @note Collective
/// @throws InputError a file of another scene or tolerance.
[[nodiscard]] ExactResult solve_test_points(const Scene& scene, const std::vector<Site>& sites,
                                            const ExactOptions& options, Communicator& communicator,
                                            const Progress& progress);

}  // namespace palpate
