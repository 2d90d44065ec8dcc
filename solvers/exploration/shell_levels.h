// SPDX-License-Identifier: BSD-3-Clause
// Where the space of a rigid tool may have levels: at the edges of cells along which the energy
// does not fit the forces, and around configurations to which the body has jumped or that were not
// reached. At a ridge the body gives way to one side or to the other, and its flat space, which is
// reached along the normals, has the one side beside the other.
#pragma once

#include <functional>
#include <vector>

#include "exploration/level_search.h"
#include "interpolation/branch_test.h"
#include "state_space/tool_space.h"

namespace palpate {

/// Begins the search for levels in the space of a rigid tool, and suspects its edges.
/// @param flat The configurations of the flat space, or of the part of it that is known, in the
///   order of operator<.
/// @param fit That of the whole space.
/// @param within The check-points between which levels are searched for; empty: all.
[[nodiscard]] LevelSearch begin_level_search(
    const ToolSpaceSetup& setup, const std::vector<ConfigurationSummary>& flat, const EdgeFit& fit,
    const std::function<bool(const CheckPoint&)>& within = {});

}  // namespace palpate
