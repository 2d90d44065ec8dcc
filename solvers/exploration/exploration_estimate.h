// SPDX-License-Identifier: BSD-3-Clause
// The expected cost of an exploration, which is estimated before it begins.
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
  /// Equilibria that are solved for. With a tolerance, a force limit or levels this is a guess:
  /// with a tolerance of 0.1 %, a liver under a sphere took three times as many as without.
  std::int64_t num_configurations = 0;
  /// Check-points at which a rigid tool touches nothing; they need no solve.
  std::int64_t num_free = 0;
  /// Wall time on all ranks, s; the memory of a rank beside ParaView's, bytes; and the size of the
  /// file, bytes.
  double seconds = 0;
  double bytes_per_rank = 0;
  double file_bytes = 0;

  /// The estimate of both together, for bodies whose solvers are in memory at the same time.
  [[nodiscard]] friend ExplorationEstimate operator+(ExplorationEstimate a,
                                                     const ExplorationEstimate& b) {
    a.num_unknowns += b.num_unknowns;
    a.num_configurations += b.num_configurations;
    a.num_free += b.num_free;
    a.seconds += b.seconds;
    a.bytes_per_rank += b.bytes_per_rank;
    a.file_bytes += b.file_bytes;
    return a;
  }
};

/// The estimate of both, one after the other, so that their solvers need not be in memory together.
[[nodiscard]] ExplorationEstimate followed_by(ExplorationEstimate first,
                                              const ExplorationEstimate& next);

/// @param spaces The spaces that plan_spaces() has made for these options.
[[nodiscard]] ExplorationEstimate estimate_exploration(const PrecomputeOptions& options,
                                                       const std::vector<PlannedSpace>& spaces,
                                                       const SolveCost& cost, int num_ranks);

/// The estimate of all that the options ask for: a rigid tool, active nodes, or both.
/// @param scene A scene that check() accepts.
/// @throws InputError what precompute() would refuse too.
[[nodiscard]] ExplorationEstimate estimate_exploration(const Scene& scene,
                                                       const PrecomputeOptions& options,
                                                       const SolveCost& cost, int num_ranks);

/// The mean work of a configuration, of a rigid tool or of an active node.
[[nodiscard]] WorkCount work_of_configuration(bool is_rigid);

/// @throws InputError the space of a rigid tool would have more configurations than the options
///   allow.
void require_few_enough(const PrecomputeOptions& options, const std::vector<PlannedSpace>& spaces);

}  // namespace palpate
