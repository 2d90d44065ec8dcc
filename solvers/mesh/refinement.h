// SPDX-License-Identifier: BSD-3-Clause
// A mesh whose chosen cells are divided, and of the others as few as are needed so that cells share
// whole faces. The new mesh is nested in the old one: its cells fill those of the old mesh exactly,
// curved cells too, and each displacement of the old mesh is one of the new mesh.
//
// Edges are halved, each at most once. A cell is divided at the longest of its halved edges, its
// parts at the longest that are left (Plaza & Rivara, Mesh refinement based on the 8-tetrahedra
// longest-edge partition, 12th International Meshing Roundtable, 2003). Since all cells go by the
// same order of edges, they agree on their common faces. The longest edge of a divided cell is
// always halved, which keeps the shapes of the cells good when they are divided again and again.
#pragma once

#include <array>
#include <vector>

#include "mesh/tet_mesh.h"

namespace palpate {

struct Refinement {
  /// A place in a cell of the old mesh.
  struct Place {
    Index cell;
    /// The coordinates from 0 to 1 that belong to the corners of the cell, with the sum 1.
    Eigen::Vector4d barycentric;
  };

  /// The new mesh. Its first points are those of the old mesh, with their numbers.
  TetMesh mesh;
  /// The cell of the old mesh that each cell is a part of [mesh.num_cells()]. Parts of a cell
  /// follow each other, in the order of the old cells.
  std::vector<Index> parents;
  /// Where the points after those of the old mesh lie in it.
  std::vector<Place> new_points;
};

/// @param chosen 1 for the cells whose edges are all halved, else 0 [num_cells].
[[nodiscard]] Refinement refine(const TetMesh& mesh, const std::vector<char>& chosen);

/// Divides every cell into eight.
[[nodiscard]] Refinement refine_all(const TetMesh& mesh);

/// The displacement of the new mesh that is the same everywhere in the body.
/// @param mesh The old mesh. @param u Its displacement [3 × num_points].
[[nodiscard]] NodalVector carried(const TetMesh& mesh, const Refinement& refinement,
                                  const NodalVector& u);

}  // namespace palpate
