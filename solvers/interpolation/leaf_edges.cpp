// SPDX-License-Identifier: BSD-3-Clause
#include "interpolation/leaf_edges.h"

namespace palpate {

LeafEdges::LeafEdges(const CellTree& tree, const std::function<bool(const CheckPoint&)>& within) {
  const auto add = [&](const CheckPoint& p, int direction, std::int32_t side) {
    CheckPoint q = p;
    q[static_cast<std::size_t>(direction / 2)] += direction % 2 == 0 ? side : -side;
    if (within && !(within(p) && within(q))) return;
    std::int32_t& steps = steps_[p][static_cast<std::size_t>(direction)];
    if (steps == 0 || side < steps) steps = side;
  };
  for (const CellTree::Leaf& leaf : tree.leaves()) {
    for (int corner = 0; corner < 8; ++corner) {
      const CheckPoint p = corner_of(leaf.cell, corner);
      for (int axis = 0; axis < 3; ++axis) {
        const bool is_last = (corner >> (2 - axis) & 1) != 0;
        add(p, 2 * axis + (is_last ? 1 : 0), leaf.cell.side);
      }
    }
  }
}

std::vector<CheckPoint> LeafEdges::neighbours(const CheckPoint& p) const {
  std::vector<CheckPoint> all;
  const auto here = steps_.find(p);
  if (here == steps_.end()) return all;
  for (int direction = 0; direction < 6; ++direction) {
    const std::int32_t steps = here->second[static_cast<std::size_t>(direction)];
    if (steps > 0) {
      CheckPoint& q = all.emplace_back(p);
      q[static_cast<std::size_t>(direction / 2)] += direction % 2 == 0 ? steps : -steps;
    }
  }
  return all;
}

}  // namespace palpate
