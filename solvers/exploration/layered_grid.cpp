// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/layered_grid.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

namespace palpate {
namespace {

/// The number of starts from which a target is tried. Further starts seldom help where three
/// failed.
constexpr int kMaxLayerStarts = 3;

std::int32_t layer_of(const CheckPoint& p) {
  return std::max({std::abs(p[0]), std::abs(p[1]), std::abs(p[2])});
}

CheckPoint scaled(const CheckPoint& p, std::int32_t step) {
  return {p[0] * step, p[1] * step, p[2] * step};
}

bool is_on_grid(const CheckPoint& p, std::int32_t step) {
  return p[0] % step == 0 && p[1] % step == 0 && p[2] % step == 0;
}

CheckPoint on_grid(const CheckPoint& p, std::int32_t step) {
  return {p[0] / step, p[1] / step, p[2] / step};
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

/// How far a start p lies off the straight line from rest to the target: the squared distance of
/// layer · p from (layer − 1) · target, which is a whole number.
std::int64_t detour(const CheckPoint& p, const CheckPoint& target, std::int64_t layer) {
  std::int64_t sum = 0;
  for (int i = 0; i < 3; ++i) {
    const std::int64_t off = layer * p[i] - (layer - 1) * target[i];
    sum += off * off;
  }
  return sum;
}

/// The starts from which a target other than rest may be reached, the best first.
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

/// The targets that follow from a start; all are in steps of this grid.
std::vector<CheckPoint> following_on_grid(const CheckPoint& start, std::int32_t reach) {
  std::vector<CheckPoint> targets;
  const std::int32_t layer = layer_of(start) + 1;
  if (layer > reach) return targets;
  for_each_neighbour(start, layer, [&](const CheckPoint& target) {
    if (candidates(target).front() == start) targets.push_back(target);
  });
  return targets;
}

}  // namespace

std::vector<CheckPoint> following_in_layers(const Grid& grid, const ConfigurationSummary& found) {
  std::vector<CheckPoint> targets;
  const std::int32_t step = grid.coarsest;
  if (!found.leads_on() || found.level != 0 || !is_on_grid(found.check_point, step)) return targets;
  targets = following_on_grid(on_grid(found.check_point, step), grid.reach() / step);
  for (CheckPoint& target : targets) target = scaled(target, step);
  return targets;
}

LayeredGrid::LayeredGrid(const Grid& grid)
    : step_(grid.coarsest),
      reach_(grid.reach() / step_),
      status_(static_cast<std::size_t>(2 * reach_ + 1) * (2 * reach_ + 1) * (2 * reach_ + 1),
              Status::open) {}

LayeredGrid::Status& LayeredGrid::at(const CheckPoint& p) {
  const std::size_t n = 2 * static_cast<std::size_t>(reach_) + 1;
  return status_[((p[0] + reach_) * n + (p[1] + reach_)) * n + (p[2] + reach_)];
}

std::int64_t LayeredGrid::num_expected() const { return static_cast<std::int64_t>(status_.size()); }

bool LayeredGrid::is_complete() const {
  return has_started_ && num_under_way_ == 0 && pending_.empty();
}

void LayeredGrid::take_in(const ConfigurationSummary& found) {
  const CheckPoint p = on_grid(found.check_point, step_);
  Status& status = at(p);
  if (status == Status::under_way) --num_under_way_;
  if (found.usable()) {
    status = found.leads_on() ? Status::start : Status::no_start;
    failed_from_.erase(p);
  } else {
    status = Status::open;
    failed_from_[p] = on_grid(found.parent, step_);
  }
}

bool LayeredGrid::holds(const CheckPoint& p) const { return is_on_grid(p, step_); }

void LayeredGrid::recall(const ConfigurationSummary& found) {
  if (holds(found.check_point)) take_in(found);
}

void LayeredGrid::accept(const ConfigurationSummary& found) {
  take_in(found);
  const CheckPoint p = on_grid(found.check_point, step_);
  if (found.leads_on()) {
    for (const CheckPoint& target : following_on_grid(p, reach_)) {
      // The result of a following target may have come before that of its start.
      const auto failed = failed_from_.find(target);
      const bool is_known_to_fail = failed != failed_from_.end() && failed->second == p;
      if (at(target) != Status::open || is_known_to_fail) continue;
      at(target) = Status::under_way;
      ++num_under_way_;
    }
  }
  if (found.usable()) {
    decide_around(p);
  } else {
    decide(p);
  }
}

void LayeredGrid::decide_around(const CheckPoint& p) {
  const std::int32_t layer = layer_of(p) + 1;
  if (layer > reach_) return;
  for_each_neighbour(p, layer, [&](const CheckPoint& target) { decide(target); });
}

void LayeredGrid::decide(const CheckPoint& target) {
  Status& status = at(target);
  if (status != Status::open) return;
  const auto failed = failed_from_.find(target);
  const bool is_new = failed == failed_from_.end();
  const auto ask_for = [&](const CheckPoint& start) {
    status = Status::under_way;
    ++num_under_way_;
    pending_.push_back({scaled(target, step_), scaled(start, step_)});
  };
  if (layer_of(target) == 0) {
    if (is_new) return ask_for(target);
  } else {
    int num_starts = 0;
    bool tried = !is_new;
    for (const CheckPoint& start : candidates(target)) {
      const Status of_start = at(start);
      // A better start may still be found here.
      if (of_start == Status::open || of_start == Status::under_way) return;
      if (of_start != Status::start) continue;
      if (++num_starts > kMaxLayerStarts) break;
      if (!tried) return ask_for(start);
      if (start == failed->second) tried = false;
    }
  }
  status = Status::no_start;
  given_up_.push_back(scaled(target, step_));
  decide_around(target);
}

std::vector<Transition> LayeredGrid::next() {
  if (!std::exchange(has_started_, true)) {
    // Go through the layers, so that targets which an earlier run has left open are decided.
    for (std::int32_t layer = 0; layer <= reach_; ++layer) {
      for (std::int32_t i = -layer; i <= layer; ++i) {
        for (std::int32_t j = -layer; j <= layer; ++j) {
          // Within a layer, the points with max(|i|, |j|) < layer have k = ±layer alone.
          const bool face = std::max(std::abs(i), std::abs(j)) == layer;
          for (std::int32_t k = -layer; k <= layer; k += face || layer == 0 ? 1 : 2 * layer) {
            decide({i, j, k});
          }
        }
      }
    }
  }
  // The sort is stable: targets of the same start keep their order.
  std::stable_sort(pending_.begin(), pending_.end(),
                   [](const Transition& a, const Transition& b) { return a.start < b.start; });
  return std::exchange(pending_, {});
}

std::vector<CheckPoint> LayeredGrid::given_up() { return std::exchange(given_up_, {}); }

}  // namespace palpate
