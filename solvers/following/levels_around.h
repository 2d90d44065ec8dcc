// SPDX-License-Identifier: BSD-3-Clause
// Searches for the levels of a rigid tool's space (shell_levels.h) in the part of it that a hand is
// near. The rounds are those of LevelSearch, each of them within the part that was asked for when
// it began. What a round leaves when the hand goes elsewhere is made when the hand comes back.
//
// The levels of a check-point have the numbers in which they were found, so that they depend on the
// way of the hand; the equilibria do not.
#pragma once

#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "exploration/level_search.h"
#include "state_space/tool_space.h"

namespace palpate {

class LevelsAround {
 public:
  /// @param setup It must outlive the object.
  explicit LevelsAround(const ToolSpaceSetup& setup) : setup_(setup) {}

  /// Takes in what an earlier run has found: a configuration of a level above 0, a candidate, or
  /// what a transition has reached.
  void recall(const ConfigurationSummary& found);
  void recall(const LevelTransition& transition) { transitions_.push_back(transition); }

  /// Whether plan() is to be called: the round is complete.
  [[nodiscard]] bool is_round_complete() const { return due_.empty() && under_way_.empty(); }
  /// Leaves what the round has not begun.
  void leave() { due_.clear(); }
  /// Begins the next round.
  /// @param flat The configurations of level 0 that are known, in the order of operator<.
  /// @param near Those of them that are near, in that order.
  /// @param hand The transitions nearest to it come first, m.
  /// @param within The check-points between which levels are searched for.
  void plan(const std::vector<ConfigurationSummary>& flat,
            const std::vector<ConfigurationSummary>& near, const Vec3& hand,
            const std::function<bool(const CheckPoint&)>& within);
  /// The next transition of the round, which is under way until its result is accepted, or it is
  /// lost; nothing: all of them have begun.
  [[nodiscard]] std::optional<Transition> next();
  /// Takes in the result of a transition that is under way.
  void accept(const ConfigurationSummary& found);
  void lose(const Transition& transition) { under_way_.erase(key_of(transition)); }
  /// What transitions have reached since the last call.
  [[nodiscard]] std::vector<Settlement> settled() { return std::exchange(settled_, {}); }

 private:
  [[nodiscard]] static LevelSearch::Key key_of(const Transition& t) {
    return {t.start, t.start_level, t.target};
  }
  void take(const Settlement& settlement);

  const ToolSpaceSetup& setup_;
  /// The configurations of levels above 0, by their check-points.
  std::map<CheckPoint, LevelSearch::Levels> levels_;
  /// What transitions have found that are not settled.
  std::map<LevelSearch::Key, ConfigurationSummary> candidates_;
  std::vector<LevelTransition> transitions_;
  std::deque<Transition> due_;
  std::set<LevelSearch::Key> under_way_;
  std::vector<Settlement> settled_;
};

}  // namespace palpate
