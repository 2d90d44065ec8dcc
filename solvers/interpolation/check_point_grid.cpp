// SPDX-License-Identifier: BSD-3-Clause
#include "interpolation/check_point_grid.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/error.h"

namespace palpate {
namespace {

/// A displacement that misses the border of a cell by so little, in spacings, is on it: rounding of
/// t = i·H must not make a check-point on the border of the box an outside one.
constexpr double kOnBorder = 1e-9;

/// How far a configuration may lie from its check-point, in spacings: a t that went through single
/// precision misses it by 1e-7.
constexpr double kOffCheckPoint = 1e-4;

constexpr Flags kMarking = flags::inverted | flags::unstable | flags::near_fold;

bool has_finite_data(const ConfigurationSummary& c) {
  return c.usable() && std::isfinite(c.energy) && c.force.allFinite() && c.stiffness.allFinite();
}

}  // namespace

CheckPointGrid::CheckPointGrid(const TouchSite& site) {
  const Site& s = site.site;
  const std::string which = "The site at active node " + std::to_string(s.active_node);
  if (s.resolution < 1 || s.resolution % 2 == 0 || s.resolution > kLargestResolution) {
    throw InputError(which + " has " + std::to_string(s.resolution) +
                     " check-points an axis; it takes an odd number up to " +
                     std::to_string(kLargestResolution) + '.');
  }
  if (s.resolution > 1 && !(s.half_width > 0 && std::isfinite(s.half_width))) {
    throw InputError(which + " has a half-width of " + std::to_string(s.half_width) +
                     " m; it takes a positive one.");
  }
  resolution_ = s.resolution;
  reach_ = s.reach();
  if (s.resolution > 1) spacing_ = s.spacing();
  per_spacing_ = 1 / spacing_;

  configuration_.assign(static_cast<std::size_t>(num_nodes()), -1);
  for (std::size_t i = 0; i < site.configurations.size(); ++i) {
    const ConfigurationSummary& c = site.configurations[i];
    const bool on_grid = std::all_of(c.check_point.begin(), c.check_point.end(),
                                     [&](std::int32_t x) { return std::abs(x) <= reach_; });
    if (!on_grid || !has_finite_data(c)) continue;
    const Vec3 place = spacing_ * Vec3(c.check_point[0], c.check_point[1], c.check_point[2]);
    if (!((c.t - place).norm() <= kOffCheckPoint * spacing_)) {
      throw InputError(which + " has a configuration that does not lie at its check-point (" +
                       std::to_string(c.check_point[0]) + ", " + std::to_string(c.check_point[1]) +
                       ", " + std::to_string(c.check_point[2]) + "): the grid was changed after " +
                       "it was computed. Compute the state space again.");
    }
    std::int32_t& at = configuration_[node(c.check_point[0] + reach_, c.check_point[1] + reach_,
                                           c.check_point[2] + reach_)];
    if (at < 0) at = static_cast<std::int32_t>(i);
    any_usable_ = true;
  }
  classify_cells(site);
  find_nearest();
}

void CheckPointGrid::classify_cells(const TouchSite& site) {
  cells_.assign(configuration_.size(), Cell::lacks_corner);
  for (std::int32_t x = 0; x + 1 < resolution_; ++x) {
    for (std::int32_t y = 0; y + 1 < resolution_; ++y) {
      for (std::int32_t z = 0; z + 1 < resolution_; ++z) {
        bool complete = true;
        bool marked = false;
        for (int corner = 0; corner < 8 && complete; ++corner) {
          const std::int32_t at =
              configuration_[node(x + (corner >> 2), y + ((corner >> 1) & 1), z + (corner & 1))];
          complete = at >= 0;
          marked = marked || (complete && (site.configurations[at].flags & kMarking) != 0);
        }
        if (complete) cells_[node(x, y, z)] = marked ? Cell::marked : Cell::inside;
      }
    }
  }
}

// Neighbours hand on their nearest usable node until nobody has a nearer one to offer.
void CheckPointGrid::find_nearest() {
  nearest_.assign(configuration_.size(), -1);
  if (!any_usable_) return;
  const auto coordinates = [&](std::int32_t n) {
    return std::array<std::int32_t, 3>{n / (resolution_ * resolution_),
                                       n / resolution_ % resolution_, n % resolution_};
  };
  const auto distance2 = [&](std::int32_t a, std::int32_t b) {
    const auto p = coordinates(a);
    const auto q = coordinates(b);
    std::int64_t sum = 0;
    for (int k = 0; k < 3; ++k) sum += std::int64_t{p[k] - q[k]} * (p[k] - q[k]);
    return sum;
  };
  std::vector<std::int32_t> changed;
  for (std::int32_t n = 0; n < num_nodes(); ++n) {
    if (!usable(n)) continue;
    nearest_[n] = n;
    changed.push_back(n);
  }
  while (!changed.empty()) {
    std::vector<std::int32_t> next;
    for (std::int32_t n : changed) {
      const auto c = coordinates(n);
      for (int neighbour = 0; neighbour < 27; ++neighbour) {
        const std::array<std::int32_t, 3> d{c[0] + neighbour / 9 - 1, c[1] + neighbour / 3 % 3 - 1,
                                            c[2] + neighbour % 3 - 1};
        if (std::any_of(d.begin(), d.end(),
                        [&](std::int32_t x) { return x < 0 || x >= resolution_; })) {
          continue;
        }
        const std::int32_t m = node(d[0], d[1], d[2]);
        const std::int32_t offered = nearest_[n];
        std::int32_t& known = nearest_[m];
        if (known < 0 || distance2(m, offered) < distance2(m, known) ||
            (distance2(m, offered) == distance2(m, known) && offered < known)) {
          known = offered;
          next.push_back(m);
        }
      }
    }
    changed = std::move(next);
  }
}

CheckPointGrid::Location CheckPointGrid::locate(const Vec3& t) const noexcept {
  Location at;
  if (!any_usable_ || !t.allFinite()) return at;
  const double last = resolution_ - 1;
  std::array<std::int32_t, 3> index{};
  Vec3 clamped;
  bool outside = false;
  for (int k = 0; k < 3; ++k) {
    const double x = t[k] * per_spacing_ + reach_;
    clamped[k] = std::min(std::max(x, 0.0), last);
    outside = outside || std::abs(x - clamped[k]) > kOnBorder;
    index[k] = std::min(static_cast<std::int32_t>(clamped[k]), std::max(resolution_ - 2, 0));
    at.s[k] = clamped[k] - index[k];
  }
  std::int32_t first = node(index[0], index[1], index[2]);
  Cell cell = cells_[first];
  // On a side of a cell that lacks a corner, the cell across may lack none.
  for (int across = 1; across < 8 && cell == Cell::lacks_corner; ++across) {
    std::int32_t other = first;
    Vec3 s = at.s;
    bool exists = true;
    for (int k = 0; k < 3 && exists; ++k) {
      if (((across >> k) & 1) == 0) continue;
      const bool low = at.s[k] < kOnBorder && index[k] > 0;
      const bool high = at.s[k] > 1 - kOnBorder && index[k] + 2 < resolution_;
      exists = low || high;
      other += low ? -stride(k) : stride(k);
      s[k] = low ? 1 : 0;
    }
    if (!exists || cells_[other] == Cell::lacks_corner) continue;
    first = other;
    cell = cells_[other];
    at.s = s;
  }
  if (cell != Cell::lacks_corner) {
    at.place = outside ? Place::beside_cell : Place::cell;
    at.marked = cell == Cell::marked;
    at.node = first;
    if (outside) at.offset = t - spacing_ * (clamped.array() - reach_).matrix();
    return at;
  }
  std::array<std::int32_t, 3> closest{};
  for (int k = 0; k < 3; ++k) closest[k] = static_cast<std::int32_t>(clamped[k] + 0.5);
  at.place = Place::check_point;
  at.node = nearest_[node(closest[0], closest[1], closest[2])];
  const Vec3 grid_point(at.node / (resolution_ * resolution_) - reach_,
                        at.node / resolution_ % resolution_ - reach_,
                        at.node % resolution_ - reach_);
  at.offset = t - spacing_ * grid_point;
  at.s.setZero();
  return at;
}

}  // namespace palpate
