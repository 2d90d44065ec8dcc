// SPDX-License-Identifier: BSD-3-Clause
// A transition is made: from the state of its start to the configuration at its target.
#pragma once

#include <cstdint>

#include "exploration/exploration_strategy.h"
#include "exploration/state_solver.h"
#include "state_space/configuration.h"

namespace palpate {

/// Solves for the configuration at the target of a transition. Its outcome says whether it was
/// found.
/// @param start The state of the start; null if the transition needs none.
/// @param level The level that the configuration gets.
/// @throws InputError as StateSolver::begin() does.
[[nodiscard]] Configuration make_configuration(StateSolver& solver, const ToolSpaceSetup& setup,
                                               const Transition& transition,
                                               const Equilibrium* start, std::int32_t level,
                                               Tangent tangent);

}  // namespace palpate
