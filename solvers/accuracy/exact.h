// SPDX-License-Identifier: BSD-3-Clause
// Exact equilibria at test points, found on all ranks. A point is reached from rest by way of its
// anchor (draw.h); points with the same anchor share it and its factor. If the anchor, or the state
// that is reached from it, is not regular, the point is reached straight from rest. A point on a
// walk is reached from the one before it.
//
// Of a space of several bodies, the displacement of the surface is kept for the first body alone,
// whose surface is shown.
//
// A rigid tool is pressed in along the normal from where it touches nothing, as configurations are
// reached. On a slide it comes from the point before. At ridges, a slide may lead to another branch
// than a press, so each point of a slide is pressed too. If the two forces differ, the branch
// depends on the path of the tool, and the point has flags::near_fold: it does not measure the
// space, which has one branch.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "exploration/precompute.h"
#include "state_space/test_point.h"

namespace palpate {

struct ExactOptions {
  /// The number of test points of each active node, or of the rigid tool.
  int test_points = 500;
  std::int64_t seed = 1;
  /// The file in which the points are kept, and from which known ones are read: a state-space file
  /// of the scene, such as that of the space itself; empty: they are in memory only.
  std::filesystem::path file;
  /// For rigid tools, on rank 0: whether a place of the tool is in a tool space; test points are
  /// drawn only there. Empty: every place is.
  std::function<bool(const ToolSpaceKey& tool_space, const Vec3& q)> holds;
  EquilibriumOptions equilibrium;
};

/// @throws InputError a field out of its range, by name.
void validate(const ExactOptions& options);

struct ExactResult {
  /// The points of each tool space, in the order of operator<, on rank 0; empty elsewhere.
  std::vector<std::vector<TestPoint>> points;
  /// On rank 0, the numbers of points that all ranks have solved in this run, and that the file
  /// had; 0 elsewhere.
  std::int64_t num_solved = 0;
  std::int64_t num_reused = 0;
  /// The run was not aborted; the same on every rank.
  bool complete = false;
};

/// Solves at the test points of each tool space.
/// @param scenes Those of the bodies, in the order of their numbers; the same on every rank.
/// @param tool_spaces The same on every rank.
/// @param progress Called now and then; false ends the run, and what was found until then is in the
///   file.
/// @note Collective
/// @throws InputError the file is of another scene or tolerance, or as draw_contact_points().
[[nodiscard]] ExactResult solve_test_points(const std::vector<std::shared_ptr<const Scene>>& scenes,
                                            const std::vector<ToolSpaceSetup>& tool_spaces,
                                            const ExactOptions& options, Communicator& communicator,
                                            const Progress& progress);

}  // namespace palpate
