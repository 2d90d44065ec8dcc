// SPDX-License-Identifier: BSD-3-Clause
// What an exploration will take, told before it begins.
#pragma once

#include <cstdint>
#include <vector>

#include "base/types.h"
#include "equilibrium/solve_cost.h"

namespace palpate {

struct PlannedSpace;
struct PrecomputeOptions;

struct ExplorationEstimate {
  Index num_unknowns = 0;
  /// Equilibria that are solved for. With a tolerance, a force limit or levels nobody knows how
  /// many: a tolerance of 0.1 % of a liver under a sphere took three times as many as without.
  std::int64_t num_configurations = 0;
  /// Check-points at which a rigid tool touches nothing, which take no time.
  std::int64_t num_free = 0;
  /// Wall time on all ranks, s; what a rank needs in memory beside ParaView, and the file, bytes.
  double seconds = 0;
  double bytes_per_rank = 0;
  double file_bytes = 0;
};

/// @param spaces What plan_spaces() has planned for these options.
[[nodiscard]] ExplorationEstimate estimate_exploration(const PrecomputeOptions& options,
                                                       const std::vector<PlannedSpace>& spaces,
                                                       const SolveCost& cost, int num_ranks);

/// The same of all that the options ask for: a rigid tool and active nodes.
/// @param scene It was checked, see check().
/// @throws InputError what precompute() would refuse too.
[[nodiscard]] ExplorationEstimate estimate_exploration(const Scene& scene,
                                                       const PrecomputeOptions& options,
                                                       const SolveCost& cost, int num_ranks);

/// A configuration in the mean: of an active node, or of a rigid tool.
[[nodiscard]] WorkCount work_of_configuration(bool is_rigid);

/// @throws InputError the space of a rigid tool would have more configurations than are allowed.
void require_few_enough(const PrecomputeOptions& options, const std::vector<PlannedSpace>& spaces);

}  // namespace palpate
