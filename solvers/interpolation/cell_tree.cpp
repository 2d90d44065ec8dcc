// SPDX-License-Identifier: BSD-3-Clause
#include "interpolation/cell_tree.h"

#include <algorithm>
#include <cstdlib>
#include <string>

#include "base/error.h"

namespace palpate {
namespace {

void check(const Grid& grid) {
  if (grid.resolution < 1 || grid.resolution % 2 == 0 || grid.resolution > kLargestResolution) {
    throw InputError("The grid has " + std::to_string(grid.resolution) +
                     " check-points an axis; it takes an odd number up to " +
                     std::to_string(kLargestResolution) + '.');
  }
  const bool power_of_two = grid.coarsest >= 1 && (grid.coarsest & (grid.coarsest - 1)) == 0;
  if (!power_of_two || grid.reach() % grid.coarsest != 0) {
    throw InputError("The grid has cells of side " + std::to_string(grid.coarsest) +
                     "; it takes a power of two that divides " + std::to_string(grid.reach()) +
                     ", the number of check-points from rest to the border.");
  }
  if (grid.coarsest_resolution() > kLargestCoarsestResolution) {
    throw InputError("The grid has " + std::to_string(grid.coarsest_resolution() - 1) +
                     " of the coarsest cells an axis; it takes " +
                     std::to_string(kLargestCoarsestResolution - 1) + " at most.");
  }
}

template <class T>
void make_set(std::vector<T>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

}  // namespace

CellTree::CellTree(const Grid& grid, const std::vector<ConfigurationSummary>& configurations) {
  check(grid);
  reach_ = grid.reach();
  coarsest_ = grid.coarsest;
  num_roots_ = 2 * reach_ / coarsest_;
  per_coarsest_ = 1.0 / coarsest_;

  std::vector<Key> found;
  if (coarsest_ > 1) {
    found.reserve(configurations.size());
    for (const ConfigurationSummary& c : configurations) {
      if (is_on_grid(c.check_point)) found.push_back(key(c.check_point));
    }
    make_set(found);
  }
  const auto is_split = [&](const Cell& cell) {
    if (cell.side == 1) return false;
    for (int i = 0; i < 27; ++i) {
      // The centre first: few cells have it and are not split.
      const CheckPoint p = point_of_halves(cell, (i + 13) % 27);
      if (!std::binary_search(found.begin(), found.end(), key(p))) return false;
    }
    return true;
  };

  std::vector<Cell> cells;
  for (std::int32_t x = 0; x <= num_roots_; ++x) {
    for (std::int32_t y = 0; y <= num_roots_; ++y) {
      for (std::int32_t z = 0; z <= num_roots_; ++z) {
        const CheckPoint p{coarsest_ * x - reach_, coarsest_ * y - reach_, coarsest_ * z - reach_};
        keys_.push_back(key(p));
        if (std::max({x, y, z}) < num_roots_) cells.push_back({p, coarsest_});
      }
    }
  }
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const Cell cell = cells[i];
    if (is_split(cell)) {
      cells_.push_back(static_cast<std::int32_t>(cells.size()));
      for (int point = 0; point < 27; ++point) keys_.push_back(key(point_of_halves(cell, point)));
      const Cell half{cell.first, cell.side / 2};
      for (int child = 0; child < 8; ++child) cells.push_back({corner_of(half, child), half.side});
    } else {
      cells_.push_back(~static_cast<std::int32_t>(leaves_.size()));
      leaves_.push_back({{}, cell});
    }
  }
  make_set(keys_);
  for (Leaf& leaf : leaves_) {
    for (int corner = 0; corner < 8; ++corner) {
      leaf.corners[corner] = find(corner_of(leaf.cell, corner));
    }
  }
}

bool CellTree::is_on_grid(const CheckPoint& point) const {
  return std::all_of(point.begin(), point.end(),
                     [&](std::int32_t x) { return x >= -reach_ && x <= reach_; });
}

CellTree::Key CellTree::key(const CheckPoint& point) const {
  const Key n = 2 * Key{reach_} + 1;
  return ((point[0] + reach_) * n + (point[1] + reach_)) * n + (point[2] + reach_);
}

CheckPoint CellTree::point(std::int32_t node) const {
  const Key n = 2 * Key{reach_} + 1;
  const Key k = keys_[node];
  return {static_cast<std::int32_t>(k / (n * n)) - reach_,
          static_cast<std::int32_t>(k / n % n) - reach_, static_cast<std::int32_t>(k % n) - reach_};
}

std::int32_t CellTree::find(const CheckPoint& point) const {
  if (!is_on_grid(point)) return -1;
  const auto found = std::lower_bound(keys_.begin(), keys_.end(), key(point));
  if (found == keys_.end() || *found != key(point)) return -1;
  return static_cast<std::int32_t>(found - keys_.begin());
}

std::int32_t CellTree::leaf_in_octant(const CheckPoint& point, int octant) const {
  // In halves of a step from the first corner of the box, at the middle of the octant's unit cube.
  std::array<std::int32_t, 3> at{};
  std::int32_t cell = 0;
  for (int k = 0; k < 3; ++k) {
    at[k] = 2 * (point[k] + reach_) + (((octant >> k) & 1) != 0 ? 1 : -1);
    if (at[k] < 0 || at[k] > 4 * reach_) return -1;
    cell = cell * num_roots_ + at[k] / (2 * coarsest_);
    at[k] %= 2 * coarsest_;
  }
  for (std::int32_t half = coarsest_; cells_[cell] >= 0; half /= 2) {
    std::int32_t child = 0;
    for (std::int32_t& x : at) {
      child = 2 * child + (x >= half ? 1 : 0);
      x %= half;
    }
    cell = cells_[cell] + child;
  }
  return ~cells_[cell];
}

}  // namespace palpate
