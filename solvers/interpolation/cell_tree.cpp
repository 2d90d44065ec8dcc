// SPDX-License-Identifier: BSD-3-Clause
#include "interpolation/cell_tree.h"

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

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

CellTree::CellTree(const Grid& grid, const std::vector<ConfigurationSummary>& configurations,
                   const Clearance& clearance) {
  check(grid);
  reach_ = grid.reach();
  coarsest_ = grid.coarsest;
  num_roots_ = 2 * reach_ / coarsest_;
  per_coarsest_ = 1.0 / coarsest_;

  if (coarsest_ > 1 || grid.sparse) {
    found_.reserve(configurations.size());
    for (const ConfigurationSummary& c : configurations) {
      if (is_on_grid(c.check_point)) found_.push_back(key(c.check_point));
    }
    make_set(found_);
  }
  const std::int32_t n = num_roots_;
  cells_.resize(static_cast<std::size_t>(n) * n * n);
  std::vector<Cell> cells;
  if (grid.sparse) {
    for (const Key k : found_) {
      const CheckPoint p = point_of(k);
      std::int32_t root = 0;
      bool is_there = true;
      for (std::int32_t x : p) {
        is_there = is_there && x < reach_ && (x + reach_) % coarsest_ == 0;
        root = root * n + (x + reach_) / coarsest_;
      }
      const Cell cell{p, coarsest_};
      for (int corner = 1; corner < 8 && is_there; ++corner) {
        is_there = is_found(corner_of(cell, corner));
      }
      if (!is_there) continue;
      cells.push_back(cell);
      present_.push_back(root);
      for (int corner = 0; corner < 8; ++corner) keys_.push_back(key(corner_of(cell, corner)));
    }
    fill_absent_cells(grid, clearance, present_, cells_);
    split(std::move(cells), present_);
  } else {
    std::vector<std::int32_t> places;
    for (std::int32_t x = 0; x <= n; ++x) {
      for (std::int32_t y = 0; y <= n; ++y) {
        for (std::int32_t z = 0; z <= n; ++z) {
          const CheckPoint p{coarsest_ * x - reach_, coarsest_ * y - reach_,
                             coarsest_ * z - reach_};
          keys_.push_back(key(p));
          if (std::max({x, y, z}) == n) continue;
          places.push_back(static_cast<std::int32_t>(cells.size()));
          cells.push_back({p, coarsest_});
        }
      }
    }
    split(std::move(cells), std::move(places));
  }
  make_set(keys_);
  fill_corners(0);
}

CellTree::CellTree(const CellTree& before, const Grid& grid, const std::vector<CheckPoint>& changed,
                   const Clearance& clearance, Growth& growth)
    : reach_(before.reach_),
      coarsest_(before.coarsest_),
      num_roots_(before.num_roots_),
      per_coarsest_(before.per_coarsest_),
      present_(before.present_) {
  const auto num_roots = static_cast<std::size_t>(num_roots_) * num_roots_ * num_roots_;
  std::vector<char> is_anew(num_roots, 0);
  std::vector<std::int32_t> anew;
  for (const CheckPoint& p : changed) {
    if (!is_on_grid(p)) continue;
    for_each_root_around(p, [&](std::int32_t root) {
      if (std::exchange(is_anew[static_cast<std::size_t>(root)], 1) == 0) anew.push_back(root);
    });
  }
  if (coarsest_ > 1 || grid.sparse) {
    std::vector<Key> added;
    for (const CheckPoint& p : changed) {
      if (is_on_grid(p)) added.push_back(key(p));
    }
    make_set(added);
    std::set_union(before.found_.begin(), before.found_.end(), added.begin(), added.end(),
                   std::back_inserter(found_));
  }
  std::vector<Cell> cells;
  std::vector<std::int32_t> places;
  for (const std::int32_t root : anew) {
    const Cell cell = root_cell(root);
    bool is_there = true;
    for (int corner = 0; corner < 8 && is_there && grid.sparse; ++corner) {
      is_there = is_found(corner_of(cell, corner));
    }
    if (!is_there) continue;
    cells.push_back(cell);
    places.push_back(root);
    for (int corner = 0; corner < 8; ++corner) keys_.push_back(key(corner_of(cell, corner)));
  }

  growth.leaves.assign(before.leaves_.size(), -1);
  for (std::size_t l = 0; l < before.leaves_.size(); ++l) {
    const Leaf& leaf = before.leaves_[l];
    std::int32_t root = 0;
    for (const std::int32_t x : leaf.cell.first) {
      root = root * num_roots_ + (x + reach_) / coarsest_;
    }
    if (is_anew[static_cast<std::size_t>(root)] != 0) continue;
    growth.leaves[l] = static_cast<std::int32_t>(leaves_.size());
    leaves_.push_back(leaf);
  }
  const std::size_t num_kept = leaves_.size();

  cells_.resize(num_roots);
  std::vector<char> is_split_anew(num_roots, 0);
  for (const std::int32_t root : places) is_split_anew[static_cast<std::size_t>(root)] = 1;
  if (grid.sparse) {
    present_.insert(present_.end(), places.begin(), places.end());
    make_set(present_);
  }
  std::vector<std::int32_t> copies;
  if (grid.sparse && present_.size() > before.present_.size()) {
    fill_absent_cells(grid, clearance, present_, cells_);
    for (const std::int32_t root : before.present_) copies.push_back(root);
  } else {
    copies.resize(num_roots);
    std::iota(copies.begin(), copies.end(), 0);
  }
  for (const std::int32_t root : copies) {
    if (is_split_anew[static_cast<std::size_t>(root)] != 0) continue;
    const std::int32_t entry = copy(before, before.cells_[root], growth.leaves);
    cells_[root] = entry;
  }
  split(std::move(cells), std::move(places));

  make_set(keys_);
  const std::vector<Key> of_anew = std::exchange(keys_, {});
  std::set_union(before.keys_.begin(), before.keys_.end(), of_anew.begin(), of_anew.end(),
                 std::back_inserter(keys_));
  growth.nodes.resize(before.keys_.size());
  growth.nodes_anew.clear();
  std::size_t b = 0;
  for (std::int32_t n = 0; n < num_nodes(); ++n) {
    if (b < before.keys_.size() && before.keys_[b] == keys_[n]) growth.nodes[b++] = n;
    bool is_at_anew = false;
    for_each_root_around(point(n), [&](std::int32_t root) {
      is_at_anew = is_at_anew || is_anew[static_cast<std::size_t>(root)] != 0;
    });
    if (is_at_anew) growth.nodes_anew.push_back(n);
  }
  for (std::size_t l = 0; l < num_kept; ++l) {
    for (std::int32_t& corner : leaves_[l].corners) corner = growth.nodes[corner];
  }
  fill_corners(num_kept);
}

void CellTree::split(std::vector<Cell> cells, std::vector<std::int32_t> places) {
  const auto is_split = [&](const Cell& cell) {
    if (cell.side == 1) return false;
    for (int i = 0; i < 27; ++i) {
      // Test the centre first: few cells have it without being split.
      if (!is_found(point_of_halves(cell, (i + 13) % 27))) return false;
    }
    return true;
  };
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const Cell cell = cells[i];
    if (is_split(cell)) {
      for (int point = 0; point < 27; ++point) keys_.push_back(key(point_of_halves(cell, point)));
      const Cell half{cell.first, cell.side / 2};
      cells_[places[i]] = static_cast<std::int32_t>(cells_.size());
      for (int child = 0; child < 8; ++child) {
        cells.push_back({corner_of(half, child), half.side});
        places.push_back(static_cast<std::int32_t>(cells_.size()));
        cells_.push_back(0);
      }
    } else {
      cells_[places[i]] = ~static_cast<std::int32_t>(leaves_.size());
      leaves_.push_back({{}, cell});
    }
  }
}

void CellTree::fill_corners(std::size_t first_leaf) {
  for (std::size_t l = first_leaf; l < leaves_.size(); ++l) {
    Leaf& leaf = leaves_[l];
    for (int corner = 0; corner < 8; ++corner) {
      leaf.corners[corner] = find(corner_of(leaf.cell, corner));
    }
  }
}

std::int32_t CellTree::copy(const CellTree& from, std::int32_t entry,
                            const std::vector<std::int32_t>& leaves) {
  if (entry < 0) return ~entry >= kFree ? entry : ~leaves[static_cast<std::size_t>(~entry)];
  const std::size_t at = cells_.size();
  cells_.resize(at + 8);
  for (int child = 0; child < 8; ++child) {
    const std::int32_t copied = copy(from, from.cells_[entry + child], leaves);
    cells_[at + static_cast<std::size_t>(child)] = copied;
  }
  return static_cast<std::int32_t>(at);
}

Cell CellTree::root_cell(std::int32_t root) const {
  const std::int32_t n = num_roots_;
  const std::array<std::int32_t, 3> index{root / (n * n), root / n % n, root % n};
  Cell cell{{}, coarsest_};
  for (int k = 0; k < 3; ++k) cell.first[k] = coarsest_ * index[k] - reach_;
  return cell;
}

bool CellTree::is_found(const CheckPoint& point) const {
  return is_on_grid(point) && std::binary_search(found_.begin(), found_.end(), key(point));
}

CellTree::Place CellTree::locate_beside(std::int32_t root, Vec3& x) const noexcept {
  const Vec3 asked = x;
  Place nearest;
  double least = std::numeric_limits<double>::infinity();
  const auto offer = [&](const std::array<std::int32_t, 3>& index) {
    Place place;
    Vec3 y;
    std::int32_t cell = 0;
    for (int k = 0; k < 3; ++k) {
      const double first = coarsest_ * index[k];
      y[k] = std::clamp(asked[k], first, first + coarsest_);
      place.s[k] = (y[k] - first) * per_coarsest_;
      cell = cell * num_roots_ + index[k];
    }
    const double distance2 = (y - asked).squaredNorm();
    if (distance2 >= least) return;
    place.leaf = descend(cell, place.s);
    if (place.leaf >= kFree) return;
    least = distance2;
    nearest = place;
    x = y;
  };
  offer({root / (num_roots_ * num_roots_), root / num_roots_ % num_roots_, root % num_roots_});
  for (int number = 0; number < num_neighbours; ++number) {
    const CheckPoint around = neighbour({}, number);
    std::array<std::int32_t, 3> index{};
    bool is_in_box = true;
    for (int k = 0; k < 3; ++k) {
      const auto here = static_cast<std::int32_t>(asked[k] * per_coarsest_);
      index[k] = std::min(here, num_roots_ - 1) + around[k];
      is_in_box = is_in_box && index[k] >= 0 && index[k] < num_roots_;
    }
    if (is_in_box) offer(index);
  }
  return nearest;
}

bool CellTree::is_on_grid(const CheckPoint& point) const {
  return std::all_of(point.begin(), point.end(),
                     [&](std::int32_t x) { return x >= -reach_ && x <= reach_; });
}

CellTree::Key CellTree::key(const CheckPoint& point) const {
  const Key n = 2 * Key{reach_} + 1;
  return ((point[0] + reach_) * n + (point[1] + reach_)) * n + (point[2] + reach_);
}

CheckPoint CellTree::point(std::int32_t node) const { return point_of(keys_[node]); }

CheckPoint CellTree::point_of(Key k) const {
  const Key n = 2 * Key{reach_} + 1;
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
  // Positions are in halves of a step from the first corner of the box, in the middle of the unit
  // cube of the octant.
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
