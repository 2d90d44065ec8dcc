// SPDX-License-Identifier: BSD-3-Clause
// Where a body with a load is at rest, the same for all ranks and all runs of a file: the
// places of tools, and so their grids, count from there.
#pragma once

#include <filesystem>
#include <optional>

#include "assembly/scene.h"
#include "equilibrium/equilibrium.h"
#include "schedule/communicator.h"

namespace palpate {

/// The scene with its body at rest: that which is given, where it has no load.
/// @param solver Of the scene, on each rank.
/// @param file If it is there and of this scene, the rest is that of the file: runs that differ in
///   rounding agree on it. Empty: there is none.
/// @param settled Holds the scene, where it has a load.
/// @throws InputError the body finds no rest, or was aborted before it had found it.
/// @note Collective
[[nodiscard]] const Scene& settle(const Scene& scene, const EquilibriumSolver& solver,
                                  const std::filesystem::path& file, Communicator& communicator,
                                  std::optional<Scene>& settled);

}  // namespace palpate
