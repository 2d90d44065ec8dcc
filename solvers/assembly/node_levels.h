// SPDX-License-Identifier: BSD-3-Clause
// The linear elements inside the quadratic ones: what a multigrid method must know of a mesh.
//
// A displacement that is linear in each cell is given by that of the corners; at a midside node it
// is the mean of those of the two corners of its edge. So with P the matrix of these means, P x is
// the field of Tet10 of the field x of Tet4 (P1 ⊂ P2), exactly, and PᵀKP the stiffness that linear
// elements would have in the same state.
#pragma once

#include <array>
#include <vector>

#include "base/types.h"
#include "mesh/tet_mesh.h"

namespace palpate {

/// Nodes that are free and those of them that are corners, each numbered from 0.
struct NodeLevels {
  /// The corners between which a node lies halfway [num_nodes × 2]: x = ½ (x₀ + x₁). Both are the
  /// same for a corner. −1 stands for a corner that does not move.
  std::vector<std::array<Index, 2>> parents;
  /// The node that each corner is [num_corners].
  std::vector<Index> node_of_corner;
  /// The place of each corner at rest [num_corners], m: for the rigid motions.
  std::vector<Vec3> corners;

  [[nodiscard]] Index num_nodes() const { return static_cast<Index>(parents.size()); }
  [[nodiscard]] Index num_corners() const { return static_cast<Index>(node_of_corner.size()); }
};

/// The levels of a body. In one of Tet4 all nodes are corners.
/// @param unknown_of_point As Assembly has it: the number of the first of the three unknowns of
///   each point, −1 for one that is fixed or unused [num_points].
[[nodiscard]] NodeLevels make_node_levels(const TetMesh& mesh,
                                          const std::vector<Index>& unknown_of_point);

/// Takes nodes out that do not move, as those that a tool prescribes. They keep their numbers, for
/// the pattern of a tangent has them still, but have no parents, and are nobody's.
/// @param held 1 for such a node, else 0 [num_nodes].
[[nodiscard]] NodeLevels without(const NodeLevels& levels, const std::vector<char>& held);

}  // namespace palpate
