// SPDX-License-Identifier: BSD-3-Clause
// From a scene to a state space: all ranks make the transitions that the strategies ask for, and
// record what they find.
//
// [P08] Peterlík & Matyska, Haptic Interaction with Soft Tissues Based on State-Space
// Approximation, EuroHaptics 2008.
#pragma once

#include <memory>
#include <vector>

#include "exploration/exploration_session.h"
#include "exploration/precompute_options.h"

namespace palpate {

/// Begins the exploration of the rigid tool or of the active nodes that the options name, on ranks
/// that solve alone. precompute() runs it from its begin to its end.
/// @param options They do not name both a rigid tool and active nodes.
/// @throws InputError as precompute() does.
/// @note Collective
[[nodiscard]] std::unique_ptr<ExplorationSession> begin_exploration(
    const std::vector<BodyOfRun>& bodies, const PrecomputeOptions& options,
    Communicator& communicator, const Progress& progress, TakeChunk take_chunk = {});

/// Computes the space of the rigid tool and of the active nodes that are named.
/// @param bodies The same on every rank, see ExplorationSession.
/// @throws InputError an active node at which the tip cannot be placed, see BondedPatches::around;
///   an option out of its range; more ranks for a solve than there are; bodies of several organs; a
///   file of another scene, or of a space with other settings, see StateSpaceFile::add_tool_space.
/// @note Collective
[[nodiscard]] PrecomputeResult precompute(const std::vector<BodyOfRun>& bodies,
                                          const PrecomputeOptions& options,
                                          Communicator& communicator, const Progress& progress);
/// Does the same for one body, whose scene it copies.
[[nodiscard]] PrecomputeResult precompute(const Scene& scene, const PrecomputeOptions& options,
                                          Communicator& communicator, const Progress& progress);

}  // namespace palpate
