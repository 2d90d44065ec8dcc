// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/levelled_grid.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "interpolation/branch_test.h"

namespace palpate {
namespace {

/// If an edge is halved, its energy residual falls to 1/32 where the force is smooth and the edge
/// is short enough, and to 1/2 where the force jumps. This bound lies in between.
constexpr double kShrinks = 0.25;
/// A residual counts only beyond this share of the work along the edge.
constexpr double kCounts = 2e-3;

}  // namespace

LevelledGrid::LevelledGrid(const ToolSpaceSetup& setup)
    : setup_(setup),
      flat_(setup.grid),
      search_({[this](const CheckPoint& p) { return neighbours(p); },
               [spacing = setup.grid.spacing()](const ConfigurationSummary& found) {
                 return std::max(found.t.norm(), spacing);
               },
               setup.grid.spacing()}) {}

void LevelledGrid::recall(const ConfigurationSummary& found) {
  search_.recall(found);
  if (found.level == 0) flat_.recall(found);
}

void LevelledGrid::recall(const LevelTransition& transition) { search_.recall(transition); }

void LevelledGrid::accept(const ConfigurationSummary& found) {
  search_.accept(found);
  if (found.level == 0) flat_.accept(found);
}

std::int64_t LevelledGrid::num_expected() const {
  return flat_.num_expected() + search_.num_more();
}

std::vector<Settlement> LevelledGrid::settled() { return search_.settled(); }

std::vector<Transition> LevelledGrid::next() {
  std::vector<Transition> transitions = flat_.next();
  if (!transitions.empty() || !flat_.is_complete() || search_.is_under_way()) return transitions;
  if (!std::exchange(has_suspects_, true)) find_suspects();
  return search_.next();
}

std::vector<CheckPoint> LevelledGrid::neighbours(const CheckPoint& p) const {
  std::vector<CheckPoint> all;
  for (int number = 0; number < num_neighbours; ++number) {
    const CheckPoint q = neighbour(p, number);
    const bool is_in_box = std::all_of(
        q.begin(), q.end(), [&](std::int32_t x) { return std::abs(x) <= setup_.grid.reach(); });
    if (q != p && is_in_box) all.push_back(q);
  }
  return all;
}

void LevelledGrid::suspect(const CheckPoint& p) {
  for (const CheckPoint& q : neighbours(p)) search_.suspect(p, q);
}

bool LevelledGrid::is_across(const ConfigurationSummary& found, int axis) const {
  const Vec3 edge = setup_.grid.spacing() * Vec3::Unit(axis);
  const auto moved = [&](int steps) {
    CheckPoint p = found.check_point;
    p[axis] += steps;
    return search_.flat_at(p);
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
  const ConfigurationSummary* parent = search_.flat_at(found.parent);
  return parent != nullptr && LevelSearch::is_start(*parent);
}

void LevelledGrid::find_suspects() {
  const bool all = setup_.policy.history == History::levels;
  for (const auto& [p, levels] : search_.found()) {
    const ConfigurationSummary& found = levels.begin()->second;
    constexpr Flags kNoQuestion = flags::inverted | flags::beyond_force_limit;
    if (found.usable() && (found.flags & kNoQuestion) != 0) continue;
    if (all || is_suspect(found)) {
      suspect(p);
      suspect(found.parent);
    }
    if (all || !found.usable()) continue;
    for (int axis = 0; axis < 3; ++axis) {
      CheckPoint next = p;
      ++next[axis];
      const ConfigurationSummary* other = search_.flat_at(next);
      if (other == nullptr || (other->flags & kNoQuestion) != 0 || !is_across(found, axis))
        continue;
      suspect(p);
      suspect(next);
    }
  }
}

}  // namespace palpate
