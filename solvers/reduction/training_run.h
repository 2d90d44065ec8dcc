// SPDX-License-Identifier: BSD-3-Clause
// Trains a reduced model on all ranks, in independent parts: the result of a part depends neither
// on the rank that computes it, nor on the parts before it. Each result is stored in a file, so
// that a run that was killed can be resumed.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "reduction/training.h"
#include "schedule/communicator.h"
#include "storage/state_space_file.h"

namespace palpate {

struct TrainingPart {
  /// A name that no other part of the training has.
  std::string name;
  /// The length of d.
  Index num_tool_coordinates = 0;
  /// The length of u, 3 num_points.
  Eigen::Index num_body_coordinates = 0;
  /// Bound of the displacement of any point or tool in any direction, m; a stored part that exceeds
  /// it is computed again.
  double farthest = 0;
  std::function<TrainingStates()> compute;
};

/// The ranks that train, and where they keep the results.
struct TrainingRun {
  Communicator& communicator;
  /// The file of rank 0, null on the others; null: nothing is kept.
  StateSpaceFile* file = nullptr;
  /// The key of the model in the file.
  std::string key;
};

/// Computes the parts that the file does not have, each on one rank, and stores them.
/// @param parts The same on every rank.
/// @param abort_requested Called after each part; true ends the run. May be empty.
/// @param states On rank 0 the states of each part, in the order of the parts.
/// @returns False on every rank: an abort was asked for on one. Parts that were found before are
///   kept.
/// @throws The error of the lowest rank that has one, on every rank.
/// @note Collective
[[nodiscard]] bool train(const std::vector<TrainingPart>& parts, const TrainingRun& run,
                         const std::function<bool()>& abort_requested,
                         std::vector<TrainingStates>& states);

}  // namespace palpate
