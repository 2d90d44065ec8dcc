// SPDX-License-Identifier: BSD-3-Clause
// The linear elements inside the quadratic ones, as a multigrid method needs them.
//
// A displacement that is linear in each cell is given by its values at the corners; at a midside
// node it is the mean of the values at the two corners of the edge. Let P be the matrix of these
// means. Then P x is the field of Tet10 that equals the field x of Tet4 (P1 ⊂ P2), exactly, and
// PᵀKP is the stiffness that linear elements would have in the same state.
#pragma once

#include <array>
#include <vector>

#include "base/types.h"
#include "mesh/tet_mesh.h"

namespace palpate {

/// The free nodes, and those among them that are corners, each numbered from 0.
struct NodeLevels {
  /// The two corners between which a node lies halfway [num_nodes × 2]: x = ½ (x₀ + x₁). For a
  /// corner both are itself. −1 stands for a corner that does not move.
  std::vector<std::array<Index, 2>> parents;
  /// The node of each corner [num_corners].
  std::vector<Index> node_of_corner;
  /// The place of each corner at rest [num_corners], m, for the rigid motions.
  std::vector<Vec3> corners;

  [[nodiscard]] Index num_nodes() const { return static_cast<Index>(parents.size()); }
  [[nodiscard]] Index num_corners() const { return static_cast<Index>(node_of_corner.size()); }
};

/// The levels of a body. In a body of Tet4 all nodes are corners.
/// @param unknown_of_point As in Assembly: the number of the first of the three unknowns of each
///   point, −1 if it is fixed or unused [num_points].
[[nodiscard]] NodeLevels make_node_levels(const TetMesh& mesh,
                                          const std::vector<Index>& unknown_of_point);

/// Removes nodes that do not move, such as those that a tool prescribes. They keep their numbers,
/// since the pattern of a tangent has them, but they have no parents and are no parents.
/// @param held 1 for such a node, else 0 [num_nodes].
[[nodiscard]] NodeLevels without(const NodeLevels& levels, const std::vector<char>& held);

}  // namespace palpate
