// SPDX-License-Identifier: BSD-3-Clause
// The training of a reduced model on ranks, in parts that each start for themselves: what a part
// finds does not depend on the rank that computes it, or on what was computed before it. A part
// that was found is kept in a file, so that a run that was killed goes on from there.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "reduction/training.h"
#include "schedule/communicator.h"
#include "state_space/state_space_file.h"

namespace palpate {

struct TrainingPart {
  /// No other part of the training has it.
  std::string name;
  /// The length of d.
  Index num_tool_coordinates = 0;
  /// The length of u, 3 num_points.
  Eigen::Index num_body_coordinates = 0;
  /// No point and no tool is displaced further in any direction, m.
  double farthest = 0;
  std::function<TrainingStates()> compute;
};

/// The ranks that train, and where they keep what they find.
struct TrainingRun {
  Communicator& communicator;
  /// Only rank 0 has it; null: nothing is kept.
  StateSpaceFile* file = nullptr;
  /// That of the model in the file.
  std::string key;
};

/// Computes the parts that the file has not, each on one rank, and keeps them.
/// @param parts The same on every rank.
/// @param abort_requested Is asked after each part; true ends the run. May be empty.
/// @param states On rank 0 those of each part, in the order of the parts.
/// @returns False on every rank where one has asked for an end. Parts that were found before are
///   kept.
/// @throws The error of the lowest rank that has one, on every rank.
/// @note Collective
[[nodiscard]] bool train(const std::vector<TrainingPart>& parts, const TrainingRun& run,
                         const std::function<bool()>& abort_requested,
                         std::vector<TrainingStates>& states);

}  // namespace palpate
