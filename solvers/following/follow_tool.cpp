// SPDX-License-Identifier: BSD-3-Clause
#include "following/follow_tool.h"

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <tuple>
#include <utility>

#include "interpolation/error_estimate.h"

namespace palpate {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
/// The error of a cell that the hand may be in is estimated from the check-points around it, up to
/// this number of root cells aside.
constexpr int kAsideOfCell = 3;
/// What follows coarse cells is planned anew when the hand has moved by this share of their side.
constexpr double kStaysWithin = 0.25;

}  // namespace

bool FollowTool::Due::operator<(const Due& other) const {
  return std::tie(need, depth, check_point) < std::tie(other.need, other.depth, other.check_point);
}

FollowTool::FollowTool(const ToolSpaceSetup& setup, std::shared_ptr<const ToolClearance> clearance,
                       std::vector<char> touchable, ShellOptions options)
    : setup_(setup),
      clearance_(std::move(clearance)),
      touchable_(std::move(touchable)),
      options_(std::move(options)),
      cells_(*clearance_, setup_.grid, touchable_, options_),
      halvings_(setup_.grid.reach()),
      levels_(setup_) {}

void FollowTool::recall(const ConfigurationSummary& found) {
  if (found.level == 0) return take_in(found);
  if (setup_.policy.history != History::flat) levels_.recall(found);
}

void FollowTool::recall(const LevelTransition& transition) {
  if (setup_.policy.history != History::flat) levels_.recall(transition);
}

void FollowTool::follow(const HandPrediction& hand) {
  hand_ = hand;
  const double way = (hand.hand().place - planned_at_).norm();
  const bool stays = way < kStaysWithin * cells_.side();
  if (!stays) {
    levels_.leave();
    has_levels_ = LevelsIn::nowhere;
  }
  is_current_ = is_current_ && stays;
  plan_coarse();
}

std::optional<Transition> FollowTool::next() {
  for (const bool may_wait : {true, false}) {
    if (auto first = take_first(coarse_, may_wait)) return first;
  }
  if (auto first = next_between_levels(LevelsIn::near)) return first;
  if (is_current_) {
    if (auto first = take_first(fine_, true)) return first;
    if (auto first = take_first(around_, true)) return first;
    if (!has_found_) return next_between_levels(LevelsIn::everywhere);
  }
  plan_fine();
  plan_around();
  if (auto first = take_first(fine_, true)) return first;
  if (auto first = take_first(around_, true)) return first;
  return next_between_levels(LevelsIn::everywhere);
}

void FollowTool::accept(const ConfigurationSummary& found) {
  if (found.level < 0) {
    levels_.accept(found);
    has_levels_ = LevelsIn::nowhere;
    return;
  }
  const CheckPoint& p = found.check_point;
  Target& target = this->target(p);
  target.is_under_way = false;
  if (found.usable()) return take_in(found);
  target.was_tried_without = target.was_tried_without || found.parent == p;
  const auto tried = std::find(target.starts.begin(), target.starts.end(), found.parent);
  if (tried != target.starts.end()) target.starts.erase(tried);
}

void FollowTool::lose(const Transition& transition) {
  if (transition.finds_candidate) {
    levels_.lose(transition);
    has_levels_ = LevelsIn::nowhere;
    return;
  }
  target(transition.target).is_under_way = false;
}

std::vector<CheckPoint> FollowTool::given_up() { return std::exchange(given_up_, {}); }

FollowTool::Coverage FollowTool::coverage() const {
  Coverage coverage;
  coverage.time_left = kNever;
  for (const Needed& needed : needed_) {
    ++coverage.needed;
    if (is_complete(needed.numbers)) {
      ++coverage.known;
    } else {
      coverage.time_left = std::min(coverage.time_left, needed.time);
    }
  }
  return coverage;
}

bool FollowTool::is_complete(const CheckPoint& numbers) const {
  const Cell cell = cells_.root(numbers);
  for (int corner = 0; corner < 8; ++corner) {
    if (!is_done(corner_of(cell, corner))) return false;
  }
  return true;
}

void FollowTool::plan_coarse() {
  needed_.clear();
  coarse_.clear();
  const Eigen::AlignedBox3d box = hand_->box();
  const CheckPoint first = cells_.numbers_of(box.min());
  const CheckPoint last = cells_.numbers_of(box.max());
  for (std::int32_t i = first[0]; i <= last[0]; ++i) {
    for (std::int32_t j = first[1]; j <= last[1]; ++j) {
      for (std::int32_t k = first[2]; k <= last[2]; ++k) {
        const CheckPoint numbers{i, j, k};
        const double time = hand_->time_until(cells_.box(cells_.root(numbers)));
        if (time == kNever || !cells_.holds(numbers)) continue;
        needed_.push_back({numbers, time});
        add_corners(numbers, time, coarse_);
      }
    }
  }
  std::sort(coarse_.begin(), coarse_.end());
}

void FollowTool::add_corners(const CheckPoint& numbers, double need, std::vector<Due>& due) {
  const Cell cell = cells_.root(numbers);
  for (int corner = 0; corner < 8; ++corner) {
    const CheckPoint p = corner_of(cell, corner);
    if (!is_done(p)) due.push_back({need, cells_.node(p).approach.depth, p});
  }
}

void FollowTool::plan_fine() {
  fine_.clear();
  if (!(setup_.policy.tolerance > 0) || needed_.empty()) return;
  const double side = cells_.side();
  Eigen::AlignedBox3d box = hand_->box();
  box.extend(Vec3(box.min() - Vec3::Constant(kAsideOfCell * side)));
  box.extend(Vec3(box.max() + Vec3::Constant(kAsideOfCell * side)));
  std::map<CheckPoint, ConfigurationSummary> near;
  std::vector<ConfigurationSummary> all;
  std::vector<ConfigurationSummary> found;
  for (const auto& [p, c] : known_) {
    all.push_back(c);
    if (!box.contains(setup_.grid.place(p))) continue;
    near.emplace(p, c);
    found.push_back(c);
  }
  const double tolerance = force_tolerance(setup_.policy, all);
  if (!(tolerance > 0)) return;
  const CellRefinement refinement = halvings_.plan(setup_.grid, found, tolerance, *clearance_);
  std::vector<Cell> to_split;
  for (const Cell& cell : refinement.to_split) {
    if (hand_->time_until(cells_.box(cell)) < kNever) to_split.push_back(cell);
  }
  for (StartGraph::Target& added :
       refined_targets(*clearance_, setup_.grid, to_split, near, options_)) {
    const CheckPoint& p = added.check_point;
    const Vec3 place = setup_.grid.place(p);
    fine_.push_back({(place - hand_->hand().place).norm(), cells_.node(p).approach.depth, p});
    targets_.try_emplace(p, Target{std::move(added.starts)});
  }
  std::sort(fine_.begin(), fine_.end());
}

void FollowTool::plan_around() {
  around_.clear();
  if (!hand_) return;
  const Vec3 hand = hand_->hand().place;
  planned_at_ = hand;
  is_current_ = true;
  has_found_ = false;
  const ToolClearance::Approach nearest = clearance_->approach(hand);
  add_to_border(cells_.numbers_of(clearance_->pressed(nearest.touched, nearest.out, 0)));
  if (border_.empty()) add_nearest_to_border(cells_.numbers_of(hand));
  for (const CheckPoint& numbers : border_) {
    add_corners(numbers, cells_.box(cells_.root(numbers)).exteriorDistance(hand), around_);
  }
  std::sort(around_.begin(), around_.end());
}

std::optional<Transition> FollowTool::next_between_levels(LevelsIn where) {
  if (setup_.policy.history == History::flat || !hand_) return std::nullopt;
  if (auto first = levels_.next()) return first;
  if (has_levels_ >= where || !levels_.is_round_complete()) return std::nullopt;
  has_levels_ = where;
  const auto around_hand = [&](int cells) {
    const Eigen::AlignedBox3d box = hand_->box();
    const Vec3 margin = Vec3::Constant(cells * cells_.side());
    return Eigen::AlignedBox3d(Vec3(box.min() - margin), Vec3(box.max() + margin));
  };
  if (where == LevelsIn::near) searched_ = around_hand(1);
  const Eigen::AlignedBox3d looked_at = around_hand(kAsideOfCell);
  const auto is_in = [&](const Eigen::AlignedBox3d& box, const CheckPoint& p) {
    return where == LevelsIn::everywhere || box.contains(setup_.grid.place(p));
  };
  std::vector<ConfigurationSummary> all;
  std::vector<ConfigurationSummary> near;
  for (const auto& [p, c] : known_) {
    // Where no start has led, there is nothing to be found.
    if (!c.usable() && (c.flags & flags::beyond_force_limit) != 0) continue;
    all.push_back(c);
    if (is_in(looked_at, p)) near.push_back(c);
  }
  levels_.plan(all, near, hand_->hand().place,
               [&](const CheckPoint& p) { return is_in(searched_, p); });
  return levels_.next();
}

void FollowTool::add_to_border(const CheckPoint& middle) {
  for (int n = 0; n < num_neighbours; ++n) {
    const CheckPoint numbers = neighbour(middle, n);
    if (cells_.holds(numbers) && !is_complete(numbers)) border_.insert(numbers);
  }
}

void FollowTool::add_nearest_to_border(const CheckPoint& middle) {
  for (std::int32_t ring = 1; ring <= cells_.num_roots() && border_.empty(); ++ring) {
    for (std::int32_t i = -ring; i <= ring; ++i) {
      for (std::int32_t j = -ring; j <= ring; ++j) {
        const bool is_side = std::abs(i) == ring || std::abs(j) == ring;
        for (std::int32_t k = -ring; k <= ring; k += is_side ? 1 : 2 * ring) {
          const CheckPoint numbers{middle[0] + i, middle[1] + j, middle[2] + k};
          if (cells_.holds(numbers) && !is_complete(numbers)) border_.insert(numbers);
        }
      }
    }
  }
}

std::optional<Transition> FollowTool::take_first(const std::vector<Due>& due, bool may_wait) {
  for (const Due& first : due) {
    if (is_done(first.check_point)) continue;
    if (auto transition = choose(first.check_point, may_wait)) return transition;
  }
  return std::nullopt;
}

std::optional<Transition> FollowTool::choose(const CheckPoint& p, bool may_wait) {
  Target& target = this->target(p);
  if (target.is_under_way) return std::nullopt;
  const auto go = [&](const CheckPoint& start) {
    target.is_under_way = true;
    return Transition{p, start};
  };
  std::optional<CheckPoint> before;
  for (auto start = target.starts.begin(); start != target.starts.end();) {
    const auto known = known_.find(*start);
    if (*start == p || (known != known_.end() && known->second.leads_on())) return go(*start);
    if (known != known_.end()) {
      target.is_beyond_limit = target.is_beyond_limit || known->second.usable();
      start = target.starts.erase(start);
      continue;
    }
    if (!before) before = *start;
    ++start;
  }
  if (before) {
    if (!this->target(*before).is_under_way) return choose(*before, may_wait);
    if (may_wait) return std::nullopt;
    return go(p);
  }
  if (target.was_tried_without || target.is_beyond_limit) {
    give_up(p);
    return std::nullopt;
  }
  return go(p);
}

bool FollowTool::leads_on(const CheckPoint& p) {
  if (!cells_.is_corner(p)) return false;
  return options_.depth <= 0 || cells_.node(p).approach.depth <= options_.depth;
}

FollowTool::Target& FollowTool::target(const CheckPoint& p) {
  const auto [here, is_new] = targets_.try_emplace(p);
  if (is_new) {
    here->second.starts =
        cells_.starts(p, [&](const CheckPoint& q) { return cells_.is_corner(q); });
  }
  return here->second;
}

void FollowTool::give_up(const CheckPoint& p) {
  given_up_.push_back(p);
  ConfigurationSummary none;
  none.check_point = p;
  if (targets_.at(p).is_beyond_limit) none.flags |= flags::beyond_force_limit;
  take_in(none);
}

void FollowTool::take_in(const ConfigurationSummary& found) {
  const CheckPoint& p = found.check_point;
  known_[p] = found;
  has_found_ = true;
  const bool is_near = searched_.contains(setup_.grid.place(p));
  has_levels_ = is_near ? LevelsIn::nowhere : std::min(has_levels_, LevelsIn::near);
  for (const CheckPoint& numbers : cells_.around(p)) {
    if (!is_complete(numbers)) continue;
    border_.erase(numbers);
    add_to_border(numbers);
  }
}

}  // namespace palpate
