// SPDX-License-Identifier: BSD-3-Clause
// An exploration strategy decides which transitions are made in a tool space, as far as its plan
// leaves this open; the engine makes them, and its queue decides in which order. The strategy knows
// neither the mechanics nor the ranks.
//
// The start of a target depends on what was found, never on when it was found, so that any number
// of ranks finds the same space. Targets that follow from a configuration in any case are named by
// the plan of the tool space, which all ranks have (exploration_plan.h). The rank that finds the
// configuration goes on with them depth first and asks nobody, while the start still has its
// factor. All other transitions are decided on the rank that owns the target.
#pragma once

#include <cstdint>
#include <vector>

#include "state_space/tool_space.h"

namespace palpate {

/// A step from a known configuration to one that is sought.
struct Transition {
  CheckPoint target{};
  /// Where the transition begins. A target that needs no start, such as rest, is its own start.
  CheckPoint start{};
  std::int32_t start_level = 0;
  /// The configuration that is reached from this start is sought, even if another is known at the
  /// target. It may turn out to be the same: until then it is a candidate, see candidate_level().
  bool finds_candidate = false;

  [[nodiscard]] bool needs_no_start() const { return start == target; }
};
/// The level of what a transition finds, which may be that of a candidate.
[[nodiscard]] inline std::int32_t level_of(const Transition& transition) {
  if (!transition.finds_candidate) return 0;
  return candidate_level(transition.start, transition.start_level, transition.target);
}

/// The result of a transition between levels.
struct Settlement {
  LevelTransition transition;
  /// The transition has found a configuration that was not known; it gets the level that was
  /// reached.
  bool is_new = false;
  /// There is a candidate, which gets this level or is removed.
  bool has_candidate = false;
};

class ExplorationStrategy {
 public:
  virtual ~ExplorationStrategy() = default;
  ExplorationStrategy(const ExplorationStrategy&) = delete;
  ExplorationStrategy& operator=(const ExplorationStrategy&) = delete;

  /// Takes in a configuration of an earlier run, before the first next().
  virtual void recall(const ConfigurationSummary& found) = 0;
  virtual void recall(const LevelTransition& /*transition*/) {}

  /// Takes in the result of a transition. If it is usable, the rank that found it already goes on
  /// with what follows; if it failed, the strategy may try another start.
  virtual void accept(const ConfigurationSummary& found) = 0;

  /// Says that the start which was asked for, or which the target follows from, leads nowhere.
  /// @param beyond_limit The reason is that the start is beyond the force limit.
  virtual void refuse(const CheckPoint& /*target*/, const CheckPoint& /*start*/,
                      bool /*beyond_limit*/) {}
  /// Says that an earlier run has found a start from which the target follows.
  virtual void offer(const CheckPoint& /*target*/, const CheckPoint& /*start*/) {}

  /// New transitions to be made, but for those that follow from an accepted configuration.
  /// Transitions with the same start are next to each other.
  [[nodiscard]] virtual std::vector<Transition> next() = 0;

  /// The targets that were given up since the last call: no start is left that may lead there.
  [[nodiscard]] virtual std::vector<CheckPoint> given_up() = 0;

  /// Whether a target was given up because its starts are beyond the force limit.
  [[nodiscard]] virtual bool is_beyond_limit(const CheckPoint& /*given_up*/) const { return false; }

  /// The results of transitions between levels since the last call. They come before any transition
  /// that starts from what they have found.
  [[nodiscard]] virtual std::vector<Settlement> settled() { return {}; }

  /// The largest number of configurations that the exploration can find, as far as is known now.
  [[nodiscard]] virtual std::int64_t num_expected() const = 0;

 protected:
  ExplorationStrategy() = default;
};

}  // namespace palpate
