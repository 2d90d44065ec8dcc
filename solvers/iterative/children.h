// SPDX-License-Identifier: BSD-3-Clause
// The nodes that each corner moves (assembly/node_levels.h), in the order in which a restriction
// gathers their values.
#pragma once

#include <vector>

#include "assembly/node_levels.h"

namespace palpate {

struct Children {
  /// Where each corner begins in `node` [num_corners + 1].
  std::vector<Index> start;
  /// The nodes of which a corner is a parent, ascending: itself, with the weight 1, and those
  /// halfway to another corner, with ½.
  std::vector<Index> node;
  /// The node that each corner is [num_corners].
  std::vector<Index> node_of_corner;

  [[nodiscard]] Index num_corners() const { return static_cast<Index>(node_of_corner.size()); }
  [[nodiscard]] std::size_t bytes() const {
    return (start.capacity() + node.capacity() + node_of_corner.capacity()) * sizeof(Index);
  }
};

[[nodiscard]] Children find_children(const NodeLevels& levels);

}  // namespace palpate
