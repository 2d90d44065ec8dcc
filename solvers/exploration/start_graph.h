// SPDX-License-Identifier: BSD-3-Clause
// An exploration by a list: the check-points that are sought, each with the starts from which it
// may be reached, the best first. A start that is itself sought comes before what is reached from
// it, so that the list is a directed graph without cycles.
//
// Each check-point has an owner rank of its own. A target follows from its first start, if this is
// found and can be a start. If it cannot, or the step from it fails, the owner of the target tries
// the next start: it asks that start's owner, which answers once the start is found or given up. A
// target that is its own start needs none: the tool comes from where it touches nothing.
//
// A target whose starts all failed is tried without a start at last, unless one of them was beyond
// the force limit: then the target is beyond the limit too, and is given up.
#pragma once

#include <map>
#include <vector>

#include "exploration/exploration_plan.h"

namespace palpate {

/// The number of starts from which a target is tried, besides itself. Further starts seldom help
/// where three failed.
inline constexpr std::size_t kMostStarts = 3;

class StartGraph final : public ExplorationPlan {
 public:
  struct Target {
    CheckPoint check_point{};
    /// Starts that are sought too, or were found before.
    std::vector<CheckPoint> starts;
    /// The tool touches nothing at this check-point, so that it needs no solve.
    bool is_free = false;
    /// See ExplorationPlan::distance(), m.
    double distance = 0;
  };

  StartGraph(ToolSpaceKey tool_space, std::vector<Target> targets);

  [[nodiscard]] std::vector<CheckPoint> following(const ConfigurationSummary& found) const override;
  [[nodiscard]] bool is_spread() const override { return true; }
  [[nodiscard]] double distance(const CheckPoint& p) const override;
  [[nodiscard]] std::unique_ptr<ExplorationStrategy> make_strategy(int rank,
                                                                   int num_ranks) const override;

  /// The targets in the order of their check-points.
  [[nodiscard]] const std::vector<Target>& targets() const { return targets_; }
  /// A check-point that is sought; null: it is not sought.
  [[nodiscard]] const Target* find(const CheckPoint& p) const;

 private:
  ToolSpaceKey tool_space_;
  std::vector<Target> targets_;
  /// By start, the targets whose first start it is.
  std::map<CheckPoint, std::vector<CheckPoint>> following_;
};

}  // namespace palpate
