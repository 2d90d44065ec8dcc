// SPDX-License-Identifier: BSD-3-Clause
// Parts of a lower triangle over which passes run in parallel. Each part is a range of consecutive
// nodes.
//
// A pass over a part also contributes to rows of nodes behind its range. It adds these
// contributions to entries of its own, which are stored behind the sums of the nodes. A node that
// receives contributions from another part is late: its row is completed when all parts have been
// passed over, so that until then the vector there is unchanged for the parts that read it. All
// other rows are completed when the pass reaches them, as in a matrix of one part.
#pragma once

#include <vector>

#include "base/parallel.h"

namespace palpate {

struct TriangleParts {
  Ranges nodes{0, kNodesOfPart};
  /// 1 for a late node, else 0 [num_nodes]; empty: there is one part.
  std::vector<char> is_late;
  /// For each node that is coupled to one behind its part, in the order of a pass, and for each
  /// block of this node: the index of the sum to which the block adds. It is the sum of the
  /// neighbour or an entry of the part.
  std::vector<Index> sum;
  /// Where the nodes of each part begin in `sum` [num_parts + 1].
  std::vector<Index> first_sum;
  /// The late nodes, ascending.
  std::vector<Index> late;
  /// Where the late nodes of each part begin [num_parts + 1].
  std::vector<Index> first_late;
  /// The entries that late nodes receive; those of one node are ordered by the part that they come
  /// from.
  std::vector<Index> arriving;
  /// Where the entries of each late node begin [late.size() + 1].
  std::vector<Index> first_arriving;

  [[nodiscard]] Index num_rooms() const { return static_cast<Index>(arriving.size()); }
  [[nodiscard]] std::size_t bytes() const;
};

/// @param start, neighbour Those of a BlockPattern.
[[nodiscard]] TriangleParts make_triangle_parts(const std::vector<Index>& start,
                                                const std::vector<Index>& neighbour);

}  // namespace palpate
