// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/layered_grid.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

namespace palpate {
namespace {

/// A failed step is tried from this many starts in all. More seldom helps where three failed.
constexpr int kMaxStarts = 3;

std::int32_t layer_of(const CheckPoint& p) {
  return std::max({std::abs(p[0]), std::abs(p[1]), std::abs(p[2])});
}

/// Calls f(q) for every check-point q of a layer that touches p, in their order.
template <class F>
void for_each_neighbour(const CheckPoint& p, std::int32_t layer, F&& f) {
  for (std::int32_t i = p[0] - 1; i <= p[0] + 1; ++i) {
    for (std::int32_t j = p[1] - 1; j <= p[1] + 1; ++j) {
      for (std::int32_t k = p[2] - 1; k <= p[2] + 1; ++k) {
        const CheckPoint q{i, j, k};
        if (layer_of(q) == layer) f(q);
      }
    }
  }
}

/// Squared distance of layer · p from (layer − 1) · target: how far a start p lies off the straight
/// way from rest to the target, times the layer so that it stays whole.
std::int64_t detour(const CheckPoint& p, const CheckPoint& target, std::int64_t layer) {
  std::int64_t sum = 0;
  for (int i = 0; i < 3; ++i) {
    const std::int64_t off = layer * p[i] - (layer - 1) * target[i];
    sum += off * off;
  }
  return sum;
}

/// Where a target other than rest may be reached from, the best first.
std::vector<CheckPoint> candidates(const CheckPoint& target) {
  const std::int32_t layer = layer_of(target);
  std::vector<CheckPoint> starts;
  for_each_neighbour(target, layer - 1, [&](const CheckPoint& p) { starts.push_back(p); });
  std::sort(starts.begin(), starts.end(), [&](const CheckPoint& a, const CheckPoint& b) {
    const auto detour_a = detour(a, target, layer);
    const auto detour_b = detour(b, target, layer);
    return detour_a != detour_b ? detour_a < detour_b : a < b;
  });
  return starts;
}

}  // namespace

LayeredGrid::SiteGrid::SiteGrid(const Site& site)
    : reach(site.reach()),
      status(static_cast<std::size_t>(site.resolution) * site.resolution * site.resolution,
             Status::open) {}

std::size_t LayeredGrid::SiteGrid::index(const CheckPoint& p) const {
  const std::size_t n = 2 * static_cast<std::size_t>(reach) + 1;
  return ((p[0] + reach) * n + (p[1] + reach)) * n + (p[2] + reach);
}

LayeredGrid::LayeredGrid(const std::vector<Site>& sites) {
  for (const Site& site : sites) grids_.emplace(site.active_node, site);
}

std::int64_t LayeredGrid::num_expected() const {
  std::int64_t sum = 0;
  for (const auto& [node, grid] : grids_) sum += static_cast<std::int64_t>(grid.status.size());
  return sum;
}

std::vector<Transition> LayeredGrid::next() {
  std::vector<Transition> transitions;
  for (auto& [node, grid] : grids_) {
    const std::size_t first = transitions.size();
    for (std::int32_t layer = 0; layer <= grid.reach; ++layer) {
      add_layer(node, grid, layer, transitions);
    }
    // The order of the targets within those of one start stays.
    std::stable_sort(
        transitions.begin() + static_cast<std::ptrdiff_t>(first), transitions.end(),
        [](const Transition& a, const Transition& b) { return a.start < b.start; });
  }
  return transitions;
}

void LayeredGrid::add_layer(Index active_node, SiteGrid& grid, std::int32_t layer,
                            std::vector<Transition>& transitions) {
  const auto visit = [&](const CheckPoint& target) {
    Status& status = grid.at(target);
    if (status != Status::open) return;
    const auto failed = grid.failed_from.find(target);
    const bool is_new = failed == grid.failed_from.end();
    if (layer == 0 && is_new) {
      transitions.push_back({active_node, target, target});
      return;
    }
    int num_starts = 0;
    bool tried = !is_new;
    if (layer > 0) {
      for (const CheckPoint& start : candidates(target)) {
        if (grid.at(start) == Status::open) return;  // a better one may come of it
        if (grid.at(start) != Status::start) continue;
        if (++num_starts > kMaxStarts) break;
        if (!tried) {
          transitions.push_back({active_node, target, start});
          return;
        }
        if (start == failed->second) tried = false;
      }
    }
    status = Status::no_start;
  };
  for (std::int32_t i = -layer; i <= layer; ++i) {
    for (std::int32_t j = -layer; j <= layer; ++j) {
      // Inside the layer's shell only its two faces.
      const bool face = std::max(std::abs(i), std::abs(j)) == layer;
      for (std::int32_t k = -layer; k <= layer; k += face || layer == 0 ? 1 : 2 * layer) {
        visit({i, j, k});
      }
    }
  }
}

std::vector<CheckPoint> LayeredGrid::following(const SiteGrid& grid, const CheckPoint& start) {
  std::vector<CheckPoint> targets;
  const std::int32_t layer = layer_of(start) + 1;
  if (layer > grid.reach) return targets;
  for_each_neighbour(start, layer, [&](const CheckPoint& target) {
    if (grid.at(target) != Status::open) return;
    const std::vector<CheckPoint> starts = candidates(target);
    const auto best = std::find_if(starts.begin(), starts.end(), [&](const CheckPoint& p) {
      return grid.at(p) != Status::no_start;
    });
    if (best != starts.end() && *best == start) targets.push_back(target);
  });
  return targets;
}

std::vector<Transition> LayeredGrid::following(Index active_node,
                                               const ConfigurationSummary& found) const {
  std::vector<Transition> transitions;
  if (!found.usable() || (found.flags & flags::beyond_force_limit) != 0) return transitions;
  for (const CheckPoint& target : following(grids_.at(active_node), found.check_point)) {
    transitions.push_back({active_node, target, found.check_point});
  }
  return transitions;
}

std::int64_t LayeredGrid::num_following(const SiteGrid& grid, const CheckPoint& start) {
  std::int64_t sum = 1;
  for (const CheckPoint& target : following(grid, start)) sum += num_following(grid, target);
  return sum;
}

std::int64_t LayeredGrid::num_following(const Transition& transition) const {
  return num_following(grids_.at(transition.active_node), transition.target);
}

void LayeredGrid::accept(Index active_node, const ConfigurationSummary& found) {
  SiteGrid& grid = grids_.at(active_node);
  if (found.usable()) {
    const bool expands = (found.flags & flags::beyond_force_limit) == 0;
    grid.at(found.check_point) = expands ? Status::start : Status::no_start;
  } else {
    grid.failed_from[found.check_point] = found.parent;
  }
}

bool LayeredGrid::is_settled(Index active_node, const CheckPoint& target) const {
  return grids_.at(active_node).at(target) != Status::open;
}

}  // namespace palpate
