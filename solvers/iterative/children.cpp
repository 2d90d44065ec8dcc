// SPDX-License-Identifier: BSD-3-Clause
#include "iterative/children.h"

namespace palpate {

Children find_children(const NodeLevels& levels) {
  Children children;
  children.node_of_corner = levels.node_of_corner;
  const auto for_parents = [&](auto&& f) {
    for (Index node = 0; node < levels.num_nodes(); ++node) {
      const auto [a, b] = levels.parents[node];
      if (a >= 0) f(a, node);
      if (b >= 0 && b != a) f(b, node);
    }
  };
  // Counts are stored one index further on, so that the entries of a corner begin at start[corner +
  // 1] while they are filled in, and at start[corner] afterwards.
  children.start.assign(levels.num_corners() + 2, 0);
  for_parents([&](Index corner, Index) { ++children.start[corner + 2]; });
  for (Index corner = 0; corner < levels.num_corners(); ++corner) {
    children.start[corner + 2] += children.start[corner + 1];
  }
  children.node.resize(children.start.back());
  for_parents(
      [&](Index corner, Index node) { children.node[children.start[corner + 1]++] = node; });
  children.start.pop_back();
  return children;
}

}  // namespace palpate
