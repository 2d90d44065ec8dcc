// SPDX-License-Identifier: BSD-3-Clause
// What an exploration has found since the last chunk, for whoever touches the space while it grows.
#pragma once

#include <cstdint>
#include <vector>

#include "fields/reduced_fields.h"
#include "state_space/tool_space.h"
#include "state_space/touch_space.h"

namespace palpate {

struct ToolSpaceChunk {
  ToolSpaceSetup setup;
  Clearance clearance;
  /// Configurations in the order of operator<. Each replaces the one with its key, if there is one.
  std::vector<ConfigurationSummary> configurations;
  /// Intermediate states in the order of operator<.
  std::vector<IntermediateState> intermediate_states;
  /// The transitions between levels. All that they connect is in this chunk or in an earlier one.
  std::vector<LevelTransition> transitions;
  /// Modes that are added to those of earlier chunks [3 × points that are shown, number added], and
  /// their errors, see TouchSpace.
  Eigen::MatrixXf modes;
  double largest_displacement = 0;
  double displacement_error = 0;
  double sensitivity_error = 0;
  /// The fields of each configuration by the modes of all chunks up to this one. The configurations
  /// of a rigid tool, and those that are not usable, have none.
  std::vector<ReducedFields> fields;

  /// Those of the configurations, in their order.
  [[nodiscard]] std::vector<CheckPoint> check_points() const {
    std::vector<CheckPoint> all;
    for (const ConfigurationSummary& c : configurations) all.push_back(c.check_point);
    return all;
  }
};

struct SpaceChunk {
  /// The chunks of an exploration are numbered from 1, and are to be taken in their order.
  std::int64_t number = 0;
  /// The tool spaces in which something was found, in the order of their keys.
  std::vector<ToolSpaceChunk> tool_spaces;
};

/// Adds a chunk to a space that has taken all earlier ones. The result is the same as if the space
/// were made from all chunks at once.
void take(const SpaceChunk& chunk, TouchSpace& space);

}  // namespace palpate
