// SPDX-License-Identifier: BSD-3-Clause
// One round of the search for levels in a rigid tool's space. All ranks plan the same round: the
// owner of a start asks for the transitions from it, and the owner of a target settles what the
// round before has reached there.
#pragma once

#include <functional>
#include <vector>

#include "exploration/exploration_plan.h"

namespace palpate {

class LevelRound final : public ExplorationPlan {
 public:
  /// @param transitions Those of this round. Transitions with the same start are next to each
  /// other.
  /// @param settlements Those of the round before.
  /// @param distance See ExplorationPlan::distance().
  LevelRound(ToolSpaceKey tool_space, std::vector<Transition> transitions,
             std::vector<Settlement> settlements,
             std::function<double(const CheckPoint&)> distance);

  [[nodiscard]] std::vector<CheckPoint> following(
      const ConfigurationSummary& /*found*/) const override {
    return {};
  }
  [[nodiscard]] bool is_spread() const override { return true; }
  [[nodiscard]] double distance(const CheckPoint& p) const override { return distance_(p); }
  [[nodiscard]] std::unique_ptr<ExplorationStrategy> make_strategy(int rank,
                                                                   int num_ranks) const override;

 private:
  ToolSpaceKey tool_space_;
  std::vector<Transition> transitions_;
  std::vector<Settlement> settlements_;
  std::function<double(const CheckPoint&)> distance_;
};

}  // namespace palpate
