// SPDX-License-Identifier: BSD-3-Clause
// The cells between the check-points of a grid: an octree that follows from the check-points that
// have a configuration, and from nothing else.
//
// Root cells of side Grid::coarsest tile the box. A cell of side > 1 is split into eight if each of
// the 27 points of its halves has a configuration, usable or not. Interpolation is done on the
// leaves; the sizes of neighbours may differ by any power of two.
//
// A root cell of a sparse grid is absent if one of its corners has no configuration, usable or not.
// The clearance of the tool may prove that it touches nothing in such a cell or in a part of it.
// The rest of the cell refers to the nearest existing root cell, see absent_cells.h.
//
// Nodes are the corners of leaves. In a grid that is not sparse, the corners of root cells are
// nodes with or without a configuration. A node hangs on a leaf if it lies on a side or an edge of
// the leaf without being one of its corners.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/memory_ranges.h"
#include "interpolation/absent_cells.h"
#include "state_space/tool_space.h"

namespace palpate {

/// A cube of check-points.
struct Cell {
  /// The corner with the least indices.
  CheckPoint first{};
  /// The side in steps of the grid, a power of two.
  std::int32_t side = 1;
};

[[nodiscard]] inline bool operator==(const Cell& a, const Cell& b) {
  return a.first == b.first && a.side == b.side;
}
[[nodiscard]] inline bool operator<(const Cell& a, const Cell& b) {
  return a.first != b.first ? a.first < b.first : a.side < b.side;
}

/// The cell of twice the side that contains a cell of a tree whose root cells begin at −reach.
[[nodiscard]] inline Cell parent_of(const Cell& cell, std::int32_t reach) {
  Cell parent{{}, 2 * cell.side};
  for (int k = 0; k < 3; ++k) {
    parent.first[k] = (cell.first[k] + reach) / parent.side * parent.side - reach;
  }
  return parent;
}

/// One of the eight corners, z fastest.
[[nodiscard]] inline CheckPoint corner_of(const Cell& cell, int which) {
  return {cell.first[0] + cell.side * (which >> 2), cell.first[1] + cell.side * ((which >> 1) & 1),
          cell.first[2] + cell.side * (which & 1)};
}

/// One of the 27 points of a cell's halves, z fastest; 0 is the first corner, 13 the centre.
[[nodiscard]] inline CheckPoint point_of_halves(const Cell& cell, int which) {
  const std::int32_t half = cell.side / 2;
  return {cell.first[0] + half * (which / 9), cell.first[1] + half * (which / 3 % 3),
          cell.first[2] + half * (which % 3)};
}

/// The trilinear weight of a corner of a cell, z fastest.
[[nodiscard]] inline double corner_weight(int corner, const Vec3& s) noexcept {
  double weight = 1;
  for (int k = 0; k < 3; ++k) weight *= ((corner >> (2 - k)) & 1) != 0 ? s[k] : 1 - s[k];
  return weight;
}

/// Memory and construction time grow with the numbers of root cells and of configurations. An
/// absent root cell takes four bytes.
class CellTree {
 public:
  /// An entry less than kFree is the number of a leaf. kFree stands for a place that is absent and
  /// proved free. Any other absent place has kNearestRoot plus the number of the nearest root cell.
  static constexpr std::int32_t kFree = 1 << 30;
  static constexpr std::int32_t kNearestRoot = kFree + 1;

  struct Leaf {
    /// The nodes at the corners, z fastest.
    std::array<std::int32_t, 8> corners{};
    Cell cell;
  };

  /// @param configurations Configurations off the grid are ignored.
  /// @param clearance The clearance of the tool, for a sparse grid; empty: nothing is proved free.
  /// @throws InputError a resolution that is not odd and positive, or coarsest cells that do not
  ///   tile the box.
  CellTree(const Grid& grid, const std::vector<ConfigurationSummary>& configurations,
           const Clearance& clearance = {});

  /// Where the nodes and leaves of a tree are in the tree to which configurations were added.
  struct Growth {
    /// The new number of each node of the earlier tree.
    std::vector<std::int32_t> nodes;
    /// The new number of each leaf of the earlier tree; −1: its root cell was built anew.
    std::vector<std::int32_t> leaves;
    /// The nodes in or at the root cells that were built anew, ascending, and in a grid those that
    /// are marking now and were not, or the other way round. At all other nodes the leaves are as
    /// they were.
    std::vector<std::int32_t> nodes_anew;
  };
  /// Makes the tree of the same grid after configurations were added or changed. It has the same
  /// nodes and leaves as a tree that is made from all configurations, but the leaves may be in
  /// another order. Root cells without a change are copied.
  /// @param changed The check-points of these configurations.
  /// @param clearance The clearance of the earlier tree.
  CellTree(const CellTree& before, const Grid& grid, const std::vector<CheckPoint>& changed,
           const Clearance& clearance, Growth& growth);

  [[nodiscard]] std::int32_t num_nodes() const { return static_cast<std::int32_t>(keys_.size()); }
  /// Side of the root cells, in steps of the grid.
  [[nodiscard]] std::int32_t coarsest() const { return coarsest_; }
  /// The check-point of a node. Nodes are numbered in the order of their check-points.
  [[nodiscard]] CheckPoint point(std::int32_t node) const;
  /// The node at a check-point; −1: there is none.
  [[nodiscard]] std::int32_t find(const CheckPoint& point) const;

  /// The leaves; none if rest is the only check-point.
  [[nodiscard]] const std::vector<Leaf>& leaves() const { return leaves_; }

  struct Place {
    /// The number of the leaf; kFree or more: there is none.
    std::int32_t leaf = -1;
    /// Local coordinates in the leaf, in [0, 1].
    Vec3 s = Vec3::Zero();
  };
  /// The leaf that contains a point of the box.
  /// @param x The point, in steps of the grid from the first corner of the box.
  /// @note Realtime-safe.
  [[nodiscard]] Place locate(const Vec3& x) const noexcept;
  /// The leaf that is nearest to a point of an absent root cell, searched in the root cells around
  /// the point and in a given one. So the interpolated values do not jump at the sides of leaves.
  /// @param root The number of a root cell that exists.
  /// @param x The point; it is replaced by the nearest point of the leaf.
  /// @note Realtime-safe.
  [[nodiscard]] Place locate_beside(std::int32_t root, Vec3& x) const noexcept;

  /// Adds the memory of the tree.
  void add_memory(MemoryRanges& ranges) const {
    palpate::add_memory(cells_, ranges);
    palpate::add_memory(leaves_, ranges);
    palpate::add_memory(keys_, ranges);
  }

  /// Calls visit(leaf) for the leaf in each of the eight octants around a check-point. A leaf that
  /// has the check-point on a side or an edge is visited more than once.
  template <class Visit>
  void for_each_leaf_around(const CheckPoint& point, Visit&& visit) const {
    for (int octant = 0; octant < 8; ++octant) {
      const std::int32_t leaf = leaf_in_octant(point, octant);
      if (leaf >= 0 && leaf < kFree) visit(leaf);
    }
  }

 private:
  using Key = std::int64_t;

  [[nodiscard]] bool is_on_grid(const CheckPoint& point) const;
  [[nodiscard]] Key key(const CheckPoint& point) const;
  [[nodiscard]] CheckPoint point_of(Key key) const;
  /// The leaf; −1: the octant is outside the box; kFree or more as in Place.
  [[nodiscard]] std::int32_t leaf_in_octant(const CheckPoint& point, int octant) const;
  /// Goes from an entry of cells_ down to the leaf.
  /// @param s Local coordinates in the cell, and afterwards in the leaf.
  [[nodiscard]] std::int32_t descend(std::int32_t cell, Vec3& s) const noexcept;
  [[nodiscard]] bool is_found(const CheckPoint& point) const;
  [[nodiscard]] Cell root_cell(std::int32_t root) const;
  /// Splits cells as far as the configurations say, and appends their nodes to keys_ and their
  /// leaves, whose corners are not filled in yet.
  /// @param places The indices of the cells in cells_.
  void split(std::vector<Cell> cells, std::vector<std::int32_t> places);
  void fill_corners(std::size_t first_leaf);
  /// Calls visit(root) for the root cells whose closed cubes have a point of the grid, by number.
  template <class Visit>
  void for_each_root_around(const CheckPoint& point, Visit&& visit) const {
    std::array<std::array<std::int32_t, 2>, 3> of_axis{};
    for (int k = 0; k < 3; ++k) {
      const std::int32_t x = point[k] + reach_;
      of_axis[k][1] = std::min(x / coarsest_, num_roots_ - 1);
      of_axis[k][0] = std::max((x - 1) / coarsest_, 0);
    }
    for (std::int32_t i = of_axis[0][0]; i <= of_axis[0][1]; ++i) {
      for (std::int32_t j = of_axis[1][0]; j <= of_axis[1][1]; ++j) {
        for (std::int32_t k = of_axis[2][0]; k <= of_axis[2][1]; ++k) {
          visit((i * num_roots_ + j) * num_roots_ + k);
        }
      }
    }
  }
  /// Copies an entry of another tree's cells_ with all below it.
  std::int32_t copy(const CellTree& from, std::int32_t entry,
                    const std::vector<std::int32_t>& leaves);

  std::int32_t reach_ = 0;
  std::int32_t coarsest_ = 1;
  /// The number of root cells along an axis.
  std::int32_t num_roots_ = 0;
  double per_coarsest_ = 1;
  /// The root cells, z fastest, and then the children of each cell next to each other. An entry is
  /// the index of the cell's first child or, below zero, ~leaf; for an absent place, leaf is as in
  /// Place.
  std::vector<std::int32_t> cells_;
  std::vector<Leaf> leaves_;
  /// The numbers of the root cells of a sparse grid that exist, ascending.
  std::vector<std::int32_t> present_;
  /// The keys of the check-points that have a configuration, ascending; empty in a grid of cells of
  /// side 1 that is not sparse, whose tree does not depend on them.
  std::vector<Key> found_;
  /// The keys of the nodes, ascending.
  std::vector<Key> keys_;
};

inline CellTree::Place CellTree::locate(const Vec3& x) const noexcept {
  Place place;
  std::int32_t cell = 0;
  for (int k = 0; k < 3; ++k) {
    const double root = x[k] * per_coarsest_;
    const std::int32_t index = std::min(static_cast<std::int32_t>(root), num_roots_ - 1);
    place.s[k] = root - index;
    cell = cell * num_roots_ + index;
  }
  place.leaf = descend(cell, place.s);
  return place;
}

inline std::int32_t CellTree::descend(std::int32_t cell, Vec3& s) const noexcept {
  // Doubling and subtracting 1 are exact, so that a point on a side is on the side in every cell.
  while (cells_[cell] >= 0) {
    std::int32_t child = 0;
    for (int k = 0; k < 3; ++k) {
      const double twice = 2 * s[k];
      const bool high = twice >= 1;
      s[k] = high ? twice - 1 : twice;
      child = 2 * child + (high ? 1 : 0);
    }
    cell = cells_[cell] + child;
  }
  return ~cells_[cell];
}

}  // namespace palpate
