// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/level_search.h"

#include <algorithm>
#include <utility>

namespace palpate {
namespace {

/// Two states at a check-point are the same if their forces and their displacements differ by no
/// more than this: as a share of the larger force, and as a share of the displacement. The error of
/// a solve is below a thousandth of this.
constexpr double kSame = 1e-3;

constexpr Flags kNoStart = flags::inverted | flags::unstable | flags::beyond_force_limit;

bool is_inverted(const ConfigurationSummary& c) { return (c.flags & flags::inverted) != 0; }

}  // namespace

bool LevelSearch::is_start(const ConfigurationSummary& c) {
  return c.usable() && (c.flags & kNoStart) == 0;
}

void LevelSearch::recall(const ConfigurationSummary& found) {
  if (found.level < 0) {
    candidates_[{found.parent, found.parent_level, found.check_point}] = found;
  } else if (found.level > 0) {
    if (levels_[found.check_point].insert_or_assign(found.level, found).second) ++num_levels_;
  } else {
    found_[found.check_point][0] = found;
  }
}

void LevelSearch::recall(const LevelTransition& transition) {
  recalled_[{transition.start, transition.start_level, transition.target}] = transition.reached;
}

void LevelSearch::know(const ConfigurationSummary& found) {
  recall(found);
  found_[found.check_point][found.level] = found;
}

void LevelSearch::know(const LevelTransition& transition) {
  reached_[{transition.start, transition.start_level, transition.target}] = transition.reached;
}

void LevelSearch::accept(const ConfigurationSummary& found) {
  if (found.level < 0) --num_under_way_;
  recall(found);
}

std::vector<Settlement> LevelSearch::settled() { return std::exchange(settled_, {}); }

std::vector<Transition> LevelSearch::next() {
  std::vector<Transition> transitions;
  for (std::set<Key> round = missing(); !round.empty(); round = missing()) {
    // Transitions with the same start are next to each other, as their keys are.
    for (const Key& key : round) {
      if (recalled_.count(key) > 0 || candidates_.count(key) > 0) continue;
      const auto& [start, start_level, target] = key;
      transitions.push_back({target, start, start_level, true});
    }
    if (!transitions.empty()) break;
    for (const Key& key : round) settle(key);
  }
  num_under_way_ = transitions.size();
  return transitions;
}

const ConfigurationSummary* LevelSearch::flat_at(const CheckPoint& p) const {
  const auto here = found_.find(p);
  if (here == found_.end()) return nullptr;
  const auto flat = here->second.find(0);
  return flat != here->second.end() && flat->second.usable() ? &flat->second : nullptr;
}

template <class Wanted>
void LevelSearch::add_transitions(const CheckPoint& from, const CheckPoint& to, Wanted&& is_wanted,
                                  std::set<Key>& all) const {
  const auto here = found_.find(from);
  if (here == found_.end()) return;
  const ConfigurationSummary* flat = flat_at(to);
  // An inverted body is not physical, so that its branches are not told apart.
  if (flat != nullptr && is_inverted(*flat)) return;
  for (const auto& [level, c] : here->second) {
    const Key key{from, level, to};
    if (is_start(c) && reached_.count(key) == 0 && is_wanted(c, to)) all.insert(key);
  }
}

std::set<LevelSearch::Key> LevelSearch::missing() const {
  const auto is_not_flat = [&](const ConfigurationSummary& from, const CheckPoint& to) {
    const ConfigurationSummary* flat = flat_at(to);
    // The flat space has made the transition to a configuration from its parent.
    return from.level != 0 || flat == nullptr || flat->parent != from.check_point;
  };
  std::set<Key> all;
  for (const auto& [p, q] : suspects_) {
    add_transitions(p, q, is_not_flat, all);
    add_transitions(q, p, is_not_flat, all);
  }
  const auto is_wanted = [&](const ConfigurationSummary& from, const CheckPoint& to) {
    return setting_.is_smooth ? tells(from, to) : is_not_flat(from, to);
  };
  std::set<Key> beside_levels;
  for (const auto& [p, levels] : found_) {
    if (levels.rbegin()->first <= 0) continue;
    for (const CheckPoint& q : setting_.neighbours(p)) {
      add_transitions(p, q, is_wanted, beside_levels);
      add_transitions(q, p, is_wanted, beside_levels);
    }
  }
  if (setting_.is_smooth) beside_levels = first_to_make(beside_levels);
  all.merge(beside_levels);
  return all;
}

std::set<LevelSearch::Key> LevelSearch::first_to_make(const std::set<Key>& telling) {
  std::set<Key> first;
  std::set<CheckPoint> targets;
  std::set<std::pair<CheckPoint, CheckPoint>> ways;
  for (const Key& key : telling) {
    const auto& [from, level, to] = key;
    if (ways.count({to, from}) > 0 || !targets.insert(to).second) continue;
    ways.emplace(from, to);
    first.insert(key);
  }
  return first;
}

bool LevelSearch::tells(const ConfigurationSummary& from, const CheckPoint& to) const {
  const CheckPoint& p = from.check_point;
  const auto there = found_.find(to);
  if (there == found_.end()) return true;
  const Levels& here = found_.at(p);
  const auto num_fitting = [&](const Levels& levels, const ConfigurationSummary& to_fit) {
    return std::count_if(levels.begin(), levels.end(), [&](const auto& level) {
      return level.second.usable() && setting_.is_smooth(level.second, to_fit);
    });
  };
  int num_connected = 0;
  for (const auto& [level, c] : there->second) {
    if (!c.usable() || !setting_.is_smooth(from, c)) continue;
    const auto back = reached_.find({to, level, p});
    const bool has_come = back != reached_.end() && back->second == from.level;
    const bool is_only = num_fitting(there->second, from) == 1 && num_fitting(here, c) == 1;
    if (has_come || is_only) ++num_connected;
  }
  return num_connected != 1;
}

void LevelSearch::settle(const Key& key) {
  const auto& [start, start_level, target] = key;
  Settlement settlement{{start, start_level, target, failed_to_reach}, false, false};
  std::int32_t& reached = settlement.transition.reached;
  const auto recalled = recalled_.find(key);
  const auto candidate = candidates_.find(key);
  if (recalled != recalled_.end()) {
    reached = recalled->second;
  } else if (candidate->second.usable() && !is_inverted(candidate->second)) {
    reached = level_of(candidate->second);
  }
  auto& levels = levels_[target];
  settlement.has_candidate = candidate != candidates_.end() && candidate->second.usable();
  if (reached > 0 && levels.count(reached) == 0 && settlement.has_candidate) {
    settlement.is_new = true;
    ConfigurationSummary found = candidate->second;
    found.level = reached;
    levels[reached] = found;
    ++num_levels_;
  }
  if (const auto level = levels.find(reached); level != levels.end()) {
    found_[target].insert(*level);
  }
  if (settlement.has_candidate || recalled == recalled_.end()) settled_.push_back(settlement);
  reached_[key] = reached;
  candidates_.erase(key);
}

std::int32_t LevelSearch::level_of(const ConfigurationSummary& found) const {
  const double length = setting_.displacement(found);
  const auto is_same = [&](const ConfigurationSummary& other) {
    const double force = std::max(found.force.norm(), other.force.norm());
    return (found.force - other.force).norm() <=
               kSame * std::max(force, other.stiffness.norm() * setting_.spacing) &&
           (found.signature - other.signature).norm() <= kSame * length;
  };
  const ConfigurationSummary* flat = flat_at(found.check_point);
  if (flat != nullptr && is_same(*flat)) return 0;
  std::int32_t free = 1;
  if (const auto levels = levels_.find(found.check_point); levels != levels_.end()) {
    for (const auto& [level, other] : levels->second) {
      if (is_same(other)) return level;
      if (level == free) ++free;
    }
  }
  return free < kMostLevels ? free : beyond_most_levels;
}

}  // namespace palpate
