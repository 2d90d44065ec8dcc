// SPDX-License-Identifier: BSD-3-Clause
// An exploration by a list: check-points that are sought, and of each the starts it may be reached
// from, the best first. A start that is itself sought comes before what is reached from it, so that
// the list is a directed graph without cycles.
//
// Each check-point has an owner of its own. A target follows from its first start if that leads on.
// Where it does not, or the step from it fails, the owner of the target tries the next start: it
// asks the owner of that, who answers once the start is found or given up. A target that is its own
// start is reached from none: from where the tool touches nothing.
//
// A target whose starts all failed is reached from none in the end, unless one of them was beyond
// the force limit: then it is beyond the limit too, and given up.
#pragma once

#include <map>
#include <vector>

#include "exploration/exploration_plan.h"

namespace palpate {

/// A target is reached from so many starts at the most, itself not counted. More seldom helps where
/// three failed.
inline constexpr std::size_t kMostStarts = 3;

class StartGraph final : public ExplorationPlan {
 public:
  struct Target {
    CheckPoint check_point{};
    /// These are sought too, or were found before.
    std::vector<CheckPoint> starts;
    /// The tool touches nothing there: it takes no time to find it.
    bool is_free = false;
    /// See ExplorationPlan::distance(), m.
    double distance = 0;
  };

  StartGraph(ToolSpaceId tool_space, std::vector<Target> targets);

  [[nodiscard]] std::vector<CheckPoint> following(const ConfigurationSummary& found) const override;
  [[nodiscard]] bool is_spread() const override { return true; }
  [[nodiscard]] double distance(const CheckPoint& p) const override;
  [[nodiscard]] std::unique_ptr<ExplorationStrategy> make_strategy(int rank,
                                                                   int num_ranks) const override;

  /// The targets in the order of their check-points.
  [[nodiscard]] const std::vector<Target>& targets() const { return targets_; }
  /// A check-point that is sought; null: it is not.
  [[nodiscard]] const Target* find(const CheckPoint& p) const;

 private:
  ToolSpaceId tool_space_;
  std::vector<Target> targets_;
  /// What follows from a check-point: the places of targets whose first start it is.
  std::map<CheckPoint, std::vector<CheckPoint>> following_;
};

}  // namespace palpate
