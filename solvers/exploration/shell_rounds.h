// SPDX-License-Identifier: BSD-3-Clause
// The rounds in which cells of a rigid tool's space are halved, and then those in which levels are
// searched for. Every rank plans the same rounds.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "exploration/contact_shell.h"
#include "exploration/engine.h"
#include "exploration/halving_history.h"
#include "exploration/level_search.h"
#include "exploration/start_graph.h"
#include "interaction/tool_clearance.h"
#include "interpolation/error_estimate.h"

namespace palpate {

class ShellRounds {
 public:
  /// @param space Its plan is a StartGraph, and is replaced by that of each further round. It must
  ///   outlive the object.
  ShellRounds(PlannedSpace& space, std::shared_ptr<const ToolClearance> clearance,
              const ShellOptions& options);

  /// Plans the next round, after a complete one.
  /// @returns false: no further round is needed.
  /// @note Collective
  bool plan(Engine& engine, Communicator& communicator, PrecomputeReport& report);

 private:
  /// Plans a round in which cells are halved. @returns false: none is needed.
  bool halve(Engine& engine, PrecomputeReport& report);
  /// Plans a round of the search for levels. @returns false: none is needed.
  bool search(Engine& engine);
  /// The configurations of level 0 that the rounds so far have asked for. Those of earlier runs
  /// that belong to later rounds do not count yet.
  [[nodiscard]] std::vector<ConfigurationSummary> flat() const;
  void take(const StartGraph& graph);
  /// @note Collective
  void gather_known(const Engine& engine, Communicator& communicator);

  PlannedSpace& space_;
  std::shared_ptr<const ToolClearance> clearance_;
  ShellOptions options_;
  /// The check-points that the rounds so far have asked for.
  std::set<CheckPoint> asked_;
  /// The configurations of level 0 that are known.
  std::map<CheckPoint, ConfigurationSummary> known_;
  /// All others that are known, and what transitions have reached in earlier runs, until the search
  /// takes them.
  std::vector<ConfigurationSummary> of_levels_;
  std::vector<LevelTransition> recalled_;
  HalvingHistory halvings_;
  /// The search for levels, after the last halving.
  std::optional<LevelSearch> search_;
  std::size_t num_told_ = 0;
  std::size_t num_recalled_ = 0;
  int num_rounds_ = 0;
};

}  // namespace palpate
