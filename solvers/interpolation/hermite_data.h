// SPDX-License-Identifier: BSD-3-Clause
// The derivatives of the energy that triquintic Hermite interpolation takes from each node.
//
// D^{abc} = H^{a+b+c} ∂^{abc}Π for a, b, c ∈ {0, 1, 2}, where H is the spacing of the check-points,
// whatever the side of the cells around. Derivatives with a + b + c ≤ 2 are known: Π, h, k (or
// with a + b + c ≤ 1, if the stiffness is not used); and those with a + b + c = 3 where a node has
// its third derivatives. The others follow in the order of |α| = a + b + c:
//
//   D^α = mean over the axes k with α_k > 0 of the difference along k of D^{α − e_k}
//
// with differences of five nodes in a row along the axis: those for which the product of their
// distances from the node is least. So a difference is central if it can be. It is one-sided at the
// border of the box and beside a node without a usable configuration. It is one-sided beside a node
// that is inverted, unstable, near a fold or singular too, unless the node itself is one: the
// energy behind such a node does not continue that before it. It goes across changes of the cells'
// size. It has fewer nodes if fewer than five stand in a row. An axis along which the node stands
// alone does not count; if no axis counts, the derivative is zero.
//
// A row follows edges of leaves, and contains hanging nodes with their own configurations. If it
// ends with fewer than five nodes at the side of a larger leaf, it is continued into that leaf by
// points at which the leaf gives the data, up to two on a side of the node.
//
// A free node (check_point_grid.h) has zeros only: all its derivatives are known.
//
// Extrapolated nodes (extrapolated_node.h) have their Taylor expansion up to a + b + c = 3 and zero
// beyond, and are not used in the differences of other nodes. At the end, the data of hanging nodes
// are replaced by those that the larger leaf gives there.
#pragma once

#include <map>
#include <vector>

#include "interpolation/check_point_grid.h"
#include "interpolation/hermite_cell.h"

namespace palpate {

/// The number of nodes in a difference.
inline constexpr int kHermiteStencil = 5;

struct HermiteDataOptions {
  /// The number of nodes in a difference, kHermiteStencil or fewer.
  int most = kHermiteStencil;
  /// Whether a difference uses one node less than its row has if no more than `most` nodes stand in
  /// the row.
  bool fewer_in_short_rows = false;
  /// Derivatives with a + b + c up to this are taken from the nodes, the others are differences: 0:
  /// the energy alone, 1: the force too, 2: the stiffness too. With less than 2, third derivatives
  /// must not be used either.
  int known = 2;
  /// Whether third derivatives are used where they are known.
  bool third_derivatives = true;
  /// Whether extrapolated nodes are used. If not, they are zero, and no node hangs on a leaf with
  /// such a corner.
  bool extrapolated_nodes = true;
};

/// The data of a grid that are kept so that, once the grid has grown, only data that have changed
/// are computed again.
struct HermiteMemory {
  /// D without and with inserted points, before hanging nodes take those of leaves [num_nodes].
  std::vector<HermiteNode> first;
  std::vector<HermiteNode> second;
  /// D at the inserted points.
  std::map<CheckPoint, HermiteNode> inserted;
};

/// A grid before it has grown.
struct HermiteBefore {
  const CellTree::Growth& growth;
  const std::vector<HermiteNode>& data;
  const HermiteMemory& memory;
};

/// D [num_nodes]; all zero if no node is usable.
/// @param before What is known from the earlier grid, with the same options; null: nothing. It does
///   not change the result by a bit.
/// @param memory Receives what a grid that grows from this needs; null: none does.
[[nodiscard]] std::vector<HermiteNode> hermite_data(
    const CheckPointGrid& grid, const std::vector<ConfigurationSummary>& configurations,
    const HermiteDataOptions& options = {}, const HermiteBefore* before = nullptr,
    HermiteMemory* memory = nullptr);

}  // namespace palpate
