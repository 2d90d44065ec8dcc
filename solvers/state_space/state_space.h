// SPDX-License-Identifier: BSD-3-Clause
// A state space: the configurations of an organ, tool space by tool space [P07, 3.2].
//
// [P07] Peterlík & Matyska, An Algorithm of State-Space Precomputation…, World Haptics 2007.
#pragma once

#include <string>
#include <vector>

#include "state_space/space_body.h"
#include "state_space/tool_space.h"

namespace palpate {

/// A tool space with what was found in it.
struct ToolSpace {
  ToolSpaceSetup setup;
  /// Whether nothing is left to explore, so that a run has nothing to add.
  bool complete = false;
  /// These are in the order of operator<.
  std::vector<Configuration> configurations;
  /// These are in the order of operator<; empty where the tool space has none.
  std::vector<IntermediateState> intermediate_states;

  /// The configuration at a check-point, or nullptr.
  [[nodiscard]] const Configuration* find(const CheckPoint& check_point,
                                          std::int32_t level = 0) const;
};

/// Makes the fields of a configuration count from the body at rest, or from its mesh, as whole
/// fields do. Nothing changes if the body has no load, or the configuration no fields.
void count_from_rest(const SettledBody& settled, Configuration& configuration);
void count_from_mesh(const SettledBody& settled, Configuration& configuration);

struct StateSpace {
  /// The bodies in the order of their numbers, one at least.
  std::vector<SpaceBody> bodies;
  /// Tolerance of the equilibria, without unit: see ConfigurationSummary::residual.
  double solver_tolerance = 0;
  /// The tool spaces in the order of their keys.
  std::vector<ToolSpace> tool_spaces;

  [[nodiscard]] const SpaceBody& body(BodyId number = kFirstBody) const {
    return find_body(bodies, number);
  }
  /// The tool space with this key, or nullptr.
  [[nodiscard]] const ToolSpace* find(const ToolSpaceKey& key) const;
};

/// "(1, 0, -1)"
[[nodiscard]] std::string describe(const CheckPoint& check_point);
/// "configuration (1, 0, -1) of active node 8", which is the tool space's name.
[[nodiscard]] std::string describe(const ConfigurationSummary& summary,
                                   const std::string& tool_space);

/// Brings tool spaces, configurations and intermediate states of a space into their order.
void sort(StateSpace& space);

}  // namespace palpate
