// SPDX-License-Identifier: BSD-3-Clause
// The tool spaces that an exploration is asked for, with their grids and the plans of their
// exploration.
#pragma once

#include <vector>

#include "exploration/exploration_plan.h"
#include "exploration/precompute_options.h"
#include "interaction/interaction_spec.h"
#include "state_space/space_body.h"

namespace palpate {

/// The space of the rigid tool on a body if there is one, else those of the active nodes.
/// @throws InputError as plan_shell() and plan_grids() do.
[[nodiscard]] std::vector<PlannedSpace> plan_spaces(const SpaceBody& body,
                                                    const PrecomputeOptions& options,
                                                    InteractionFactory& tools);

/// A space for each active node.
/// @throws InputError the tool cannot be placed at a node.
[[nodiscard]] std::vector<PlannedSpace> plan_grids(const SpaceBody& body,
                                                   const PrecomputeOptions& options);

/// The space of the rigid tool. Its plan is a StartGraph.
/// @throws InputError the tool has no valid shape, or there is nothing to press.
[[nodiscard]] std::vector<PlannedSpace> plan_shell(const SpaceBody& body,
                                                   const PrecomputeOptions& options,
                                                   InteractionFactory& tools);

/// Whether the file has a rigid tool with the contact layer that earlier versions of this program
/// chose by default. Such a run is resumed with that layer, since another layer would make it
/// another tool.
/// @param options They must have a rigid tool.
/// @throws InputError, BackendError the file cannot be read.
/// @note Call this on one rank only: opening the file recovers what a killed run has left in it.
[[nodiscard]] bool has_earlier_layer(const Scene& scene, const PrecomputeOptions& options);

/// The rigid tool with the default layer of earlier versions.
[[nodiscard]] RigidTool with_earlier_layer(RigidTool tool, const Scene& scene);

}  // namespace palpate
