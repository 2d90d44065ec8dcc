// SPDX-License-Identifier: BSD-3-Clause
// Quadratic cells with straight edges, and the linear ones of their corners.
#pragma once

#include <vector>

#include "mesh/tet_mesh.h"

namespace palpate {

/// The linear cells of the corners, without points that are none.
/// @throws InputError an edge is curved: the message says where.
[[nodiscard]] TetMesh straight_cells(const TetMesh& mesh);

/// The same cells with a point in the middle of each edge. The points of the linear mesh come
/// first.
[[nodiscard]] TetMesh with_middles(const TetMesh& linear);

/// The weights of the corners of a cell at a place, with the sum 1; the least is negative outside.
[[nodiscard]] Eigen::Vector4d weights_at(const TetMesh& mesh, Index cell, const Vec3& place);

/// A place in a cell, with the weights of its corners.
struct InCell {
  Index cell = -1;
  Eigen::Vector4d weights;
};

/// Where the points of a mesh are in the one before: in one of the cells whose parts they belong
/// to, or nearly so where they were moved [num_points of `after`].
/// @param parents The cell of the mesh before that each cell is a part of.
[[nodiscard]] std::vector<InCell> find_places(const TetMesh& before, const TetMesh& after,
                                              const std::vector<Index>& parents);

}  // namespace palpate
