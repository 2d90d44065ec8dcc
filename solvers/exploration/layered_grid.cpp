// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/layered_grid.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

namespace palpate {
namespace {

/// A failed step is tried from this many starts in all. More seldom helps where three failed.
constexpr std::size_t kMaxStarts = 3;

std::int32_t layer_of(const CheckPoint& p) {
  return std::max({std::abs(p[0]), std::abs(p[1]), std::abs(p[2])});
}

bool touch(const CheckPoint& a, const CheckPoint& b) {
  return layer_of({a[0] - b[0], a[1] - b[1], a[2] - b[2]}) <= 1;
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

std::pair<Index, CheckPoint> first_start(const Transition& transition) {
  return {transition.active_node,
          transition.starts.empty() ? transition.target : transition.starts.front()};
}

}  // namespace

LayeredGrid::LayeredGrid(std::vector<Site> sites, int sites_at_once)
    : sites_(std::move(sites)), sites_at_once_(static_cast<std::size_t>(std::max(1, sites_at_once))) {}

std::int64_t LayeredGrid::num_expected() const {
  std::int64_t sum = 0;
  for (const Site& site : sites_) {
    const std::int64_t n = site.resolution;
    sum += n * n * n;
  }
  return sum;
}

std::vector<Transition> LayeredGrid::next() {
  std::vector<Transition> transitions;
  while (transitions.empty() && first_site_ < sites_.size()) {
    starts_ = std::move(found_);
    found_.clear();
    ++layer_;
    const std::size_t end = std::min(first_site_ + sites_at_once_, sites_.size());
    bool any_site_reaches = false;
    for (std::size_t s = first_site_; s < end; ++s) {
      any_site_reaches = any_site_reaches || layer_ <= sites_[s].reach();
      add_layer(sites_[s], transitions);
    }
    if (!any_site_reaches) {
      first_site_ = end;
      layer_ = -1;
    }
  }
  // The order of the targets within those of one start stays.
  std::stable_sort(transitions.begin(), transitions.end(),
                   [](const Transition& a, const Transition& b) {
                     return first_start(a) < first_start(b);
                   });
  return transitions;
}

void LayeredGrid::add_layer(const Site& site, std::vector<Transition>& transitions) const {
  if (layer_ > site.reach()) return;
  if (layer_ == 0) {
    transitions.push_back({site.active_node, {0, 0, 0}, {}});
    return;
  }
  const auto known = starts_.find(site.active_node);
  if (known == starts_.end()) return;
  for (std::int32_t i = -layer_; i <= layer_; ++i) {
    for (std::int32_t j = -layer_; j <= layer_; ++j) {
      for (std::int32_t k = -layer_; k <= layer_; ++k) {
        const CheckPoint target{i, j, k};
        if (layer_of(target) != layer_) continue;
        std::vector<CheckPoint> starts;
        std::copy_if(known->second.begin(), known->second.end(), std::back_inserter(starts),
                     [&](const CheckPoint& p) { return touch(p, target); });
        if (starts.empty()) continue;
        std::sort(starts.begin(), starts.end(), [&](const CheckPoint& a, const CheckPoint& b) {
          const auto detour_a = detour(a, target, layer_);
          const auto detour_b = detour(b, target, layer_);
          return detour_a != detour_b ? detour_a < detour_b : a < b;
        });
        if (starts.size() > kMaxStarts) starts.resize(kMaxStarts);
        transitions.push_back({site.active_node, target, std::move(starts)});
      }
    }
  }
}

void LayeredGrid::accept(Index active_node, const ConfigurationSummary& found) {
  if (found.usable() && (found.flags & flags::beyond_force_limit) == 0) {
    found_[active_node].push_back(found.check_point);
  }
}

}  // namespace palpate
