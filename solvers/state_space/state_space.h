// SPDX-License-Identifier: BSD-3-Clause
// A state space: the configurations of a scene, site by site [P07, 3.2].
//
// [P07] Peterlík & Matyska, An Algorithm of State-Space Precomputation…, World Haptics 2007.
#pragma once

#include <string>
#include <vector>

#include "assembly/scene.h"
#include "state_space/configuration.h"

namespace palpate {

/// What was found around one active site.
struct SiteSpace {
  Site site;
  /// The frontier was exhausted: a run has nothing to add.
  bool complete = false;
  /// These are in the order of operator<.
  std::vector<Configuration> configurations;
  /// These are in the order of operator<; empty where the site has none.
  std::vector<IntermediateState> intermediate_states;

  /// The configuration at a check-point, or nullptr.
  [[nodiscard]] const Configuration* find(const CheckPoint& check_point,
                                          std::int32_t level = 0) const;
};

struct StateSpace {
  Scene scene;
  /// The result of hash(scene).
  std::string scene_hash;
  /// Tolerance of the equilibria, without unit: see ConfigurationSummary::residual.
  double solver_tolerance = 0;
  /// The sites in the order of their active nodes.
  std::vector<SiteSpace> sites;

  /// The space around an active node, or nullptr.
  [[nodiscard]] const SiteSpace* find(Index active_node) const;
};

/// Brings sites, configurations and intermediate states of a space into their order.
void sort(StateSpace& space);

}  // namespace palpate
