// SPDX-License-Identifier: BSD-3-Clause
// Exact equilibria at test points, found on all ranks. A point is reached from rest by way of its
// anchor (draw.h), which the points around it share, with its factor. Where the anchor, or what is
// found from there, is not regular, the point is reached straight from rest. A point on a walk is
// reached from the one before it.
//
// A rigid tool is pressed in along the normal from where it touches nothing, as configurations are
// reached. On a slide it comes from the point before. At ridges it may be on another branch then
// than after a press: to tell, each point of a slide is pressed too. Where the two forces differ,
// the way decides on which branch the body is, and the slide has flags::near_fold there: it is no
// measure of the space, which has one branch.
#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "exploration/precompute.h"
#include "state_space/test_point.h"

namespace palpate {

struct ExactOptions {
  /// The number of test points of each active node, or of the rigid tool.
  int test_points = 500;
  std::int64_t seed = 1;
  /// The file in which the points are kept, and from which known ones are taken: a state-space file
  /// of the scene, such as that of the space itself; empty: in memory alone.
  std::filesystem::path file;
  /// Of a rigid tool, on rank 0: whether a place of the tool is in the space; test points are there
  /// alone. Empty: every place is.
  std::function<bool(const Vec3& q)> holds;
  EquilibriumOptions equilibrium;
};

/// @throws InputError a field out of its range, by name.
void validate(const ExactOptions& options);

struct ExactResult {
  /// The points of each tool space, in the order of operator<; whole on rank 0, empty elsewhere.
  std::vector<std::vector<TestPoint>> points;
  /// Points that were solved in this run, on all ranks, and that were taken from the file; 0 on
  /// other ranks than 0.
  std::int64_t num_solved = 0;
  std::int64_t num_reused = 0;
  /// The run was not aborted; the same on every rank.
  bool complete = false;
};

/// Solves at the test points of each tool space.
/// @param scene The same on every rank.
/// @param tool spaces The same on every rank.
/// @param progress It is called now and then; false ends the run, and what was found until then is
///   in the file.
/// @note Collective
/// @throws InputError the file is of another scene or tolerance, or as draw_contact_points().
[[nodiscard]] ExactResult solve_test_points(const Scene& scene,
                                            const std::vector<ToolSpaceSetup>& tool_spaces,
                                            const ExactOptions& options, Communicator& communicator,
                                            const Progress& progress);

}  // namespace palpate
