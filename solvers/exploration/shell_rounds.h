// SPDX-License-Identifier: BSD-3-Clause
// The rounds in which cells of a rigid tool's space are halved. Every rank plans the same rounds.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <set>

#include "exploration/contact_shell.h"
#include "exploration/engine.h"
#include "exploration/halving_history.h"
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
  void take(const StartGraph& graph);
  /// @note Collective
  void gather_known(const Engine& engine, Communicator& communicator);

  PlannedSpace& space_;
  std::shared_ptr<const ToolClearance> clearance_;
  ShellOptions options_;
  /// The check-points that the rounds so far have asked for.
  std::set<CheckPoint> asked_;
  std::map<CheckPoint, ConfigurationSummary> known_;
  HalvingHistory halvings_;
  std::size_t num_told_ = 0;
  int num_rounds_ = 0;
};

}  // namespace palpate
