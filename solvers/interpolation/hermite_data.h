// SPDX-License-Identifier: BSD-3-Clause
// The derivatives of the energy that triquintic Hermite interpolation takes from each node.
//
// D^{abc} = H^{a+b+c} ∂^{abc}Π for a, b, c ∈ {0, 1, 2}, H the spacing of the check-points, whatever
// the side of the cells around. Known are those of a + b + c ≤ 2: Π, h, k, and where a node has its
// third derivatives those of a + b + c = 3. The others follow by increasing |α| = a + b + c:
//
//   D^α = mean over the axes k with α_k > 0 of the difference along k of D^{α − e_k}
//
// with differences of five nodes: of those in a row that holds the node the ones for which the
// product of the distances from it is least. That is central where it can be, one-sided at the
// border of the box, beside a node without a usable configuration and, unless the node is such a
// one itself, beside one that is inverted, unstable or near a fold: what lies behind does not
// continue what lies before. It goes across a change of the cells' size. It is of fewer where fewer
// than five stand in a row. An axis along which the node stands alone takes no part; where no axis
// does, the derivative is taken as zero.
//
// A row goes along edges of leaves, and takes in hanging nodes with the configurations they have.
// Where it ends, with fewer than five, at the side of a larger leaf, it goes on into that by points
// at which the leaf gives the data, up to two on a side of the node.
//
// A free node (check_point_grid.h) has zeros only: all its derivatives are known.
//
// Extrapolated nodes (extrapolated_node.h) have what their Taylor expansion gives up to
// a + b + c = 3 and zero beyond, and take no part in the differences of others. Last of all the
// data of hanging nodes are put in the place of what the larger leaf gives there.
#pragma once

#include <vector>

#include "interpolation/check_point_grid.h"
#include "interpolation/hermite_cell.h"

namespace palpate {

/// Nodes in a difference.
inline constexpr int kHermiteStencil = 5;

struct HermiteDataOptions {
  /// Nodes in a difference, kHermiteStencil or fewer.
  int most = kHermiteStencil;
  /// Where no more than `most` stand in a row, a difference is of one fewer.
  bool fewer_in_short_rows = false;
  /// Third derivatives are used where they are known.
  bool third_derivatives = true;
  /// Without, nodes that are not usable are zero, and no node hangs on a leaf that has one.
  bool extrapolated_nodes = true;
};

/// D [num_nodes]; zero where no node is usable.
[[nodiscard]] std::vector<HermiteNode> hermite_data(
    const CheckPointGrid& grid, const std::vector<ConfigurationSummary>& configurations,
    const HermiteDataOptions& options = {});

}  // namespace palpate
