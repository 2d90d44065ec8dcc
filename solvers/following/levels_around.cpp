// SPDX-License-Identifier: BSD-3-Clause
#include "following/levels_around.h"

#include <algorithm>

#include "exploration/shell_levels.h"

namespace palpate {

void LevelsAround::recall(const ConfigurationSummary& found) {
  if (found.level < 0) {
    candidates_[{found.parent, found.parent_level, found.check_point}] = found;
  } else {
    levels_[found.check_point][found.level] = found;
  }
}

void LevelsAround::plan(const std::vector<ConfigurationSummary>& flat,
                        const std::vector<ConfigurationSummary>& near, const Vec3& hand,
                        const std::function<bool(const CheckPoint&)>& within) {
  LevelSearch search = begin_level_search(setup_, near, EdgeFit(flat), within);
  for (const auto& [p, levels] : levels_) {
    for (const auto& [level, c] : levels) search.know(c);
  }
  for (const LevelTransition& transition : transitions_) search.know(transition);
  for (const auto& [key, c] : candidates_) search.recall(c);
  const std::vector<Transition> round = search.next();
  for (const Settlement& settlement : search.settled()) take(settlement);
  due_.clear();
  for (const Transition& transition : round) {
    if (under_way_.count(key_of(transition)) == 0) due_.push_back(transition);
  }
  const auto far = [&](const Transition& t) { return (setup_.grid.place(t.target) - hand).norm(); };
  std::stable_sort(due_.begin(), due_.end(),
                   [&](const Transition& a, const Transition& b) { return far(a) < far(b); });
}

std::optional<Transition> LevelsAround::next() {
  if (due_.empty()) return std::nullopt;
  const Transition first = due_.front();
  due_.pop_front();
  under_way_.insert(key_of(first));
  return first;
}

void LevelsAround::accept(const ConfigurationSummary& found) {
  const LevelSearch::Key key{found.parent, found.parent_level, found.check_point};
  under_way_.erase(key);
  candidates_[key] = found;
}

void LevelsAround::take(const Settlement& settlement) {
  const LevelTransition& transition = settlement.transition;
  transitions_.push_back(transition);
  const auto candidate =
      candidates_.find({transition.start, transition.start_level, transition.target});
  if (candidate != candidates_.end()) {
    if (settlement.is_new) {
      ConfigurationSummary found = candidate->second;
      found.level = transition.reached;
      levels_[transition.target][transition.reached] = found;
    }
    candidates_.erase(candidate);
  }
  settled_.push_back(settlement);
}

}  // namespace palpate
