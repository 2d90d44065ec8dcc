// SPDX-License-Identifier: BSD-3-Clause
// The tool spaces that an exploration is asked for, with their grids and the order in which they
// are explored.
#pragma once

#include <vector>

#include "exploration/exploration_plan.h"
#include "exploration/precompute_options.h"
#include "interaction/interaction_spec.h"

namespace palpate {

/// The space of the rigid tool, or where there is none those of the active nodes.
/// @throws InputError as both of these.
[[nodiscard]] std::vector<PlannedSpace> plan_spaces(const Scene& scene,
                                                    const PrecomputeOptions& options,
                                                    InteractionFactory& tools);

/// A space for each active node.
/// @throws InputError a node where the tool cannot be.
[[nodiscard]] std::vector<PlannedSpace> plan_grids(const Scene& scene,
                                                   const PrecomputeOptions& options);

/// The space of the rigid tool. Its plan is a StartGraph.
/// @throws InputError a tool that is none, or that there is nothing to press with.
[[nodiscard]] std::vector<PlannedSpace> plan_shell(const Scene& scene,
                                                   const PrecomputeOptions& options,
                                                   InteractionFactory& tools);

/// Whether the file was begun with the layer of contact that earlier versions of this program chose
/// by themselves for the rigid tool: with another one it would be another tool.
/// @param options With a rigid tool. @note Of one rank: what a run that was killed has left of the
///   file is taken up. @throws InputError, BackendError the file cannot be read.
[[nodiscard]] bool has_earlier_layer(const Scene& scene, const PrecomputeOptions& options);

/// A rigid tool with that layer.
[[nodiscard]] RigidTool with_earlier_layer(RigidTool tool, const Scene& scene);

}  // namespace palpate
