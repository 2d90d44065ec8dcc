// SPDX-License-Identifier: BSD-3-Clause
// Parts of a lower triangle that are passed over side by side, each a range of nodes that follow
// one another.
//
// A pass over a part adds to the rows of nodes behind its range too. What it has for these goes to
// rooms of its own behind the sums of the nodes. A node that gets something from another part is
// late: its row is completed when all parts have been passed over, and so the vector is the same
// there until then for the parts that read it. All other rows are completed where the pass comes to
// them, as in a matrix that is one part.
#pragma once

#include <vector>

#include "base/parallel.h"

namespace palpate {

struct TriangleParts {
  Ranges nodes{0, kNodesOfPart};
  /// 1 for a late node, else 0 [num_nodes]; empty: there is one part.
  std::vector<char> is_late;
  /// Of each node that is coupled to one behind its part, in the order of a pass: for each of its
  /// blocks, the sum that it adds to, that of the neighbour or a room.
  std::vector<Index> sum;
  /// Where the nodes of each part begin in `sum` [num_parts + 1].
  std::vector<Index> first_sum;
  /// The late nodes, ascending.
  std::vector<Index> late;
  /// Where the late nodes of each part begin [num_parts + 1].
  std::vector<Index> first_late;
  /// The rooms of what late nodes get, of each one by the part that it is from.
  std::vector<Index> arriving;
  /// Where those of each late node begin [late.size() + 1].
  std::vector<Index> first_arriving;

  [[nodiscard]] Index num_rooms() const { return static_cast<Index>(arriving.size()); }
  [[nodiscard]] std::size_t bytes() const;
};

/// @param start @param neighbour Those of a BlockPattern.
[[nodiscard]] TriangleParts make_triangle_parts(const std::vector<Index>& start,
                                                const std::vector<Index>& neighbour);

}  // namespace palpate
