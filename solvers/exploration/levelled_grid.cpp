// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/levelled_grid.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "interpolation/branch_test.h"

namespace palpate {
namespace {

/// Two states at a check-point are the same if their forces and their displacements differ by no
/// more than this: as a share of the larger force, and as a share of the displacement of the
/// check-point. The error of a solve is below a thousandth of this.
constexpr double kSame = 1e-3;

/// If an edge is halved, its energy residual falls to 1/32 where the force is smooth and the edge
/// is short enough, and to 1/2 where the force jumps. This bound lies in between.
constexpr double kShrinks = 0.25;
/// A residual counts only beyond this share of the work along the edge.
constexpr double kCounts = 2e-3;

constexpr Flags kNoStart = flags::inverted | flags::unstable | flags::beyond_force_limit;

/// Whether transitions between levels may start from a configuration.
bool is_start(const ConfigurationSummary& c) { return c.usable() && (c.flags & kNoStart) == 0; }

bool is_inverted(const ConfigurationSummary& c) { return (c.flags & flags::inverted) != 0; }

}  // namespace

LevelledGrid::LevelledGrid(const ToolSpaceSetup& setup) : setup_(setup), flat_(setup.grid) {}

void LevelledGrid::recall(const ConfigurationSummary& found) {
  if (found.level < 0) {
    candidates_[{found.parent, found.parent_level, found.check_point}] = found;
  } else if (found.level > 0) {
    levels_[found.check_point][found.level] = found;
    ++num_levels_;
  } else {
    flat_.recall(found);
    found_[found.check_point][0] = found;
  }
}

void LevelledGrid::recall(const LevelTransition& transition) {
  recalled_[{transition.start, transition.start_level, transition.target}] = transition.reached;
}

void LevelledGrid::accept(const ConfigurationSummary& found) {
  if (found.level < 0) {
    candidates_[{found.parent, found.parent_level, found.check_point}] = found;
    --num_under_way_;
  } else {
    flat_.accept(found);
    found_[found.check_point][0] = found;
  }
}

std::int64_t LevelledGrid::num_expected() const {
  return flat_.num_expected() + num_levels_ + static_cast<std::int64_t>(num_under_way_);
}

std::vector<Settlement> LevelledGrid::settled() { return std::exchange(settled_, {}); }

std::vector<Transition> LevelledGrid::next() {
  std::vector<Transition> transitions = flat_.next();
  if (!transitions.empty() || !flat_.is_complete() || num_under_way_ > 0) return transitions;
  if (!std::exchange(has_suspects_, true)) find_suspects();
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

bool LevelledGrid::is_in_box(const CheckPoint& p) const {
  return std::all_of(p.begin(), p.end(),
                     [&](std::int32_t x) { return std::abs(x) <= setup_.grid.reach(); });
}

const ConfigurationSummary* LevelledGrid::flat_at(const CheckPoint& p) const {
  const auto here = found_.find(p);
  if (here == found_.end()) return nullptr;
  const auto flat = here->second.find(0);
  return flat != here->second.end() && flat->second.usable() ? &flat->second : nullptr;
}

bool LevelledGrid::is_across(const ConfigurationSummary& found, int axis) const {
  const Vec3 edge = setup_.grid.spacing() * Vec3::Unit(axis);
  const auto moved = [&](int steps) {
    CheckPoint p = found.check_point;
    p[axis] += steps;
    return flat_at(p);
  };
  const ConfigurationSummary* next = moved(1);
  if (next == nullptr) return false;
  const double residual = edge_residual(found, *next, edge);
  const double work = 0.5 * edge.norm() * (found.force.norm() + next->force.norm());
  if (!(residual > kCounts * work)) return false;
  // The residual of this edge is compared with those of edges twice as long that contain it.
  const ConfigurationSummary* before = moved(-1);
  const ConfigurationSummary* after = moved(2);
  double of_long = -1;
  if (before != nullptr) of_long = std::max(of_long, edge_residual(*before, *next, 2 * edge));
  if (after != nullptr) of_long = std::max(of_long, edge_residual(found, *after, 2 * edge));
  return of_long >= 0 && residual > kShrinks * of_long;
}

bool LevelledGrid::is_suspect(const ConfigurationSummary& found) const {
  if (found.usable()) return (found.flags & (flags::near_fold | flags::unstable)) != 0;
  // The target was not reached, though its start is sound.
  const ConfigurationSummary* parent = flat_at(found.parent);
  return parent != nullptr && is_start(*parent);
}

void LevelledGrid::find_suspects() {
  const bool all = setup_.policy.history == History::levels;
  for (const auto& [p, levels] : found_) {
    const ConfigurationSummary& found = levels.begin()->second;
    constexpr Flags kNoQuestion = flags::inverted | flags::beyond_force_limit;
    if (found.usable() && (found.flags & kNoQuestion) != 0) continue;
    if (all || is_suspect(found)) {
      suspects_.insert(p);
      suspects_.insert(found.parent);
    }
    if (all || !found.usable()) continue;
    for (int axis = 0; axis < 3; ++axis) {
      CheckPoint next = p;
      ++next[axis];
      const ConfigurationSummary* other = flat_at(next);
      if (other == nullptr || (other->flags & kNoQuestion) != 0 || !is_across(found, axis))
        continue;
      suspects_.insert(p);
      suspects_.insert(next);
    }
  }
}

std::set<LevelledGrid::Key> LevelledGrid::missing() const {
  std::set<CheckPoint> suspects = suspects_;
  for (const auto& [p, levels] : found_) {
    if (levels.rbegin()->first > 0) suspects.insert(p);
  }
  std::set<Key> all;
  for (const CheckPoint& p : suspects) {
    for (int number = 0; number < num_neighbours; ++number) {
      const CheckPoint q = neighbour(p, number);
      if (q == p || !is_in_box(q)) continue;
      add_transitions(p, q, all);
      add_transitions(q, p, all);
    }
  }
  return all;
}

void LevelledGrid::add_transitions(const CheckPoint& from, const CheckPoint& to,
                                   std::set<Key>& all) const {
  const auto here = found_.find(from);
  if (here == found_.end()) return;
  const ConfigurationSummary* flat = flat_at(to);
  // An inverted body is not physical, so that its branches are not told apart.
  if (flat != nullptr && is_inverted(*flat)) return;
  for (const auto& [level, c] : here->second) {
    // The flat space has made this transition.
    if (level == 0 && flat != nullptr && flat->parent == from) continue;
    const Key key{from, level, to};
    if (is_start(c) && reached_.count(key) == 0) all.insert(key);
  }
}

void LevelledGrid::settle(const Key& key) {
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

std::int32_t LevelledGrid::level_of(const ConfigurationSummary& found) const {
  const double length = std::max(found.t.norm(), setup_.grid.spacing());
  const auto is_same = [&](const ConfigurationSummary& other) {
    const double force = std::max(found.force.norm(), other.force.norm());
    return (found.force - other.force).norm() <=
               kSame * std::max(force, other.stiffness.norm() * setup_.grid.spacing()) &&
           (found.signature - other.signature).norm() <= kSame * length;
  };
  const ConfigurationSummary* flat = flat_at(found.check_point);
  if (flat != nullptr && is_same(*flat)) return 0;
  std::int32_t last = 0;
  if (const auto levels = levels_.find(found.check_point); levels != levels_.end()) {
    for (const auto& [level, other] : levels->second) {
      if (is_same(other)) return level;
      last = level;
    }
  }
  return last + 1 < kMostLevels ? last + 1 : beyond_most_levels;
}

}  // namespace palpate
