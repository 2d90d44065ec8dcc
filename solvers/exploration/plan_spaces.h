// SPDX-License-Identifier: BSD-3-Clause
// The tool spaces that an exploration is asked for, with their grids and the plans of their
// exploration.
#pragma once

#include <optional>
#include <vector>

#include "exploration/exploration_plan.h"
#include "exploration/precompute_options.h"
#include "interaction/interaction_spec.h"
#include "state_space/space_body.h"

namespace palpate {

/// The space of the rigid tool on a body if there is one, else those of the active nodes.
/// @param region The region that the body is for; nothing: the whole organ.
/// @throws InputError as plan_shell() and plan_grids() do.
[[nodiscard]] std::vector<PlannedSpace> plan_spaces(const SpaceBody& body,
                                                    const PrecomputeOptions& options,
                                                    InteractionFactory& tools,
                                                    const std::optional<MeshRegion>& region = {});

/// A space for each active node.
/// @param region That of the node whose mesh the body is; nothing: the body is for any node.
/// @throws InputError the tool cannot be placed at a node.
[[nodiscard]] std::vector<PlannedSpace> plan_grids(const SpaceBody& body,
                                                   const PrecomputeOptions& options,
                                                   const std::optional<MeshRegion>& region = {});

/// What the space of the rigid tool is of, without its targets.
/// @throws InputError the tool has no valid shape.
[[nodiscard]] ToolSpaceSetup plan_tool(const SpaceBody& body, const PrecomputeOptions& options,
                                       InteractionFactory& tools,
                                       const std::optional<MeshRegion>& region = {});

/// The space of the rigid tool. Its plan is a StartGraph.
/// @param region The region that the body is for; nothing: the whole organ.
/// @returns Nothing if there is nothing to press in the region.
/// @throws InputError the tool has no valid shape, or there is nothing to press on the whole organ.
[[nodiscard]] std::vector<PlannedSpace> plan_shell(const SpaceBody& body,
                                                   const PrecomputeOptions& options,
                                                   InteractionFactory& tools,
                                                   const std::optional<MeshRegion>& region = {});

[[noreturn]] void throw_nothing_to_press(const PrecomputeOptions& options);

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
