// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/adaptive_grid.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "interpolation/error_estimate.h"

namespace palpate {
namespace {

/// The number of corners from which a point is tried in all.
constexpr std::size_t kMaxStarts = 3;

}  // namespace

AdaptiveGrid::AdaptiveGrid(const ToolSpaceSetup& setup) : setup_(setup), coarse_(setup.grid) {}

void AdaptiveGrid::recall(const ConfigurationSummary& found) {
  if (coarse_.holds(found.check_point)) {
    coarse_.recall(found);
    found_[found.check_point] = found;
  } else {
    recalled_[found.check_point] = found;
  }
}

void AdaptiveGrid::accept(const ConfigurationSummary& found) {
  if (coarse_.holds(found.check_point)) {
    coarse_.accept(found);
    found_[found.check_point] = found;
    return;
  }
  const auto here = under_way_.find(found.check_point);
  if (here == under_way_.end()) return;  // an earlier run has found it
  std::vector<CheckPoint>& left = here->second;
  if (!found.usable() && !left.empty()) {
    pending_.push_back({found.check_point, left.front()});
    left.erase(left.begin());
    return;
  }
  if (!found.usable()) given_up_.push_back(found.check_point);
  found_[found.check_point] = found;
  under_way_.erase(here);
}

std::vector<Transition> AdaptiveGrid::next() {
  std::vector<Transition> transitions = coarse_.next();
  if (coarse_.is_complete() && transitions.empty() && pending_.empty() && under_way_.empty())
    plan_round();
  std::stable_sort(pending_.begin(), pending_.end(), [](const Transition& a, const Transition& b) {
    return std::tie(a.start, a.target) < std::tie(b.start, b.target);
  });
  transitions.insert(transitions.end(), pending_.begin(), pending_.end());
  pending_.clear();
  return transitions;
}

std::vector<CheckPoint> AdaptiveGrid::given_up() {
  std::vector<CheckPoint> all = coarse_.given_up();
  all.insert(all.end(), given_up_.begin(), given_up_.end());
  given_up_.clear();
  return all;
}

void AdaptiveGrid::plan_round() {
  // Points that an earlier run has found need no transition. If it has found all points of a round,
  // the next round is planned at once.
  for (bool goes_on = true; goes_on && under_way_.empty();) {
    goes_on = false;
    std::vector<ConfigurationSummary> found;
    for (const auto& [check_point, c] : found_) found.push_back(c);
    const std::vector<Cell> cells =
        cells_to_split(setup_.grid, found, force_tolerance(setup_.policy, found));
    const auto is_known = [&](const CheckPoint& p) { return found_.count(p) > 0; };
    for (const auto& [target, corners] : corners_of_new_points(cells, is_known)) {
      goes_on = true;
      ++num_refined_;
      if (const auto recalled = recalled_.find(target); recalled != recalled_.end()) {
        found_.insert(recalled_.extract(recalled));
        continue;
      }
      std::vector<CheckPoint> tried = starts(corners, target);
      if (tried.empty()) {
        found_[target].check_point = target;  // No start leads there: the point counts as failed.
        continue;
      }
      pending_.push_back({target, tried.front()});
      tried.erase(tried.begin());
      under_way_.emplace(target, std::move(tried));
    }
  }
}

std::vector<CheckPoint> AdaptiveGrid::starts(const std::vector<CheckPoint>& corners,
                                             const CheckPoint& target) const {
  std::vector<CheckPoint> usable;
  for (const CheckPoint& corner : corners) {
    const auto found = found_.find(corner);
    if (found != found_.end() && found->second.leads_on()) usable.push_back(corner);
  }
  std::sort(usable.begin(), usable.end(), [&](const CheckPoint& a, const CheckPoint& b) {
    const auto rank = [&](const CheckPoint& p) {
      return std::tuple(squared_distance(p, target), squared_distance(p, {}), p);
    };
    return rank(a) < rank(b);
  });
  if (usable.size() > kMaxStarts) usable.resize(kMaxStarts);
  return usable;
}

}  // namespace palpate
