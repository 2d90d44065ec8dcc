// SPDX-License-Identifier: BSD-3-Clause
// The forces at test points on meshes whose cells are all divided into eight. By them the error
// that a mesh makes is measured, and not only estimated.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "equilibrium/equilibrium.h"
#include "exploration/precompute.h"
#include "state_space/test_point.h"
#include "state_space/tool_space.h"

namespace palpate {

struct FinerForces {
  /// The force at each point of each tool space, less the error that the finer mesh still makes
  /// where its estimate is reliable, N, on rank 0; empty elsewhere. Nothing: the point is not
  /// regular, or there is no equilibrium on the finer mesh.
  std::vector<std::vector<std::optional<Vec3>>> forces;
  /// The run was not aborted; the same on every rank.
  bool complete = true;
};

/// @param scenes, tool_spaces As in solve_test_points().
/// @param points Solved points of each tool space, on rank 0; ignored elsewhere.
/// @param progress Called on rank 0 now and then; false ends the run.
/// @note Collective
[[nodiscard]] FinerForces solve_on_finer_meshes(
    const std::vector<std::shared_ptr<const Scene>>& scenes,
    const std::vector<ToolSpaceSetup>& tool_spaces,
    const std::vector<std::vector<TestPoint>>& points, const EquilibriumOptions& options,
    Communicator& communicator, const Progress& progress);

}  // namespace palpate
