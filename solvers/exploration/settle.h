// SPDX-License-Identifier: BSD-3-Clause
// The equilibrium of a body under its load, the same on all ranks and in all runs of a file: the
// displacements of tools, and so their grids, count from there.
#pragma once

#include <filesystem>

#include "assembly/scene.h"
#include "equilibrium/equilibrium.h"
#include "schedule/communicator.h"

namespace palpate {

/// The body at rest; empty for a scene without load.
/// @param solver The solver of the scene, on each rank.
/// @param file If it exists and is of this scene, its rest is taken, so that runs which differ in
///   rounding agree. Empty: there is no file.
/// @throws InputError the body has no equilibrium under its load, or the run was aborted before it
///   was found.
/// @note Collective
[[nodiscard]] SettledBody settle(const Scene& scene, const EquilibriumSolver& solver,
                                 const std::filesystem::path& file, Communicator& communicator);

}  // namespace palpate
