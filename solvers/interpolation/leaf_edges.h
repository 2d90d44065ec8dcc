// SPDX-License-Identifier: BSD-3-Clause
// The edges between the check-points of an octree.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <vector>

#include "interpolation/cell_tree.h"

namespace palpate {

/// The edges of the leaves of an octree, each divided at the check-points that lie on it.
class LeafEdges {
 public:
  /// @param within Only edges between such check-points; empty: all.
  explicit LeafEdges(const CellTree& tree,
                     const std::function<bool(const CheckPoint&)>& within = {});

  /// The other ends of the edges at a check-point.
  [[nodiscard]] std::vector<CheckPoint> neighbours(const CheckPoint& p) const;
  /// Calls visit(p, axis, steps) for each edge, from p on along the axis.
  template <class Visit>
  void for_each(Visit&& visit) const {
    for (const auto& [p, steps] : steps_) {
      for (int axis = 0; axis < 3; ++axis) {
        if (steps[2 * axis] > 0) visit(p, axis, steps[2 * axis]);
      }
    }
  }

 private:
  /// The lengths of the edges at each check-point along x, −x, y, −y, z, −z, in steps of the grid;
  /// 0: there is none.
  std::map<CheckPoint, std::array<std::int32_t, 6>> steps_;
};

}  // namespace palpate
