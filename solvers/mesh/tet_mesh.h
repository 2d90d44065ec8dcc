// SPDX-License-Identifier: BSD-3-Clause
// The mesh of a body: tetrahedra, at rest.
#pragma once

#include <array>
#include <vector>

#include "base/types.h"

namespace palpate {

enum class ElementOrder : int { linear = 1, quadratic = 2 };

[[nodiscard]] constexpr int nodes_per_cell(ElementOrder order) {
  return order == ElementOrder::linear ? 4 : 10;
}

/// The corners of the edges of a cell, in the order of their midside nodes.
inline constexpr int kTetEdges[6][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};

[[nodiscard]] constexpr int nodes_per_face(ElementOrder order) {
  return order == ElementOrder::linear ? 3 : 6;
}

/// Points and cells in VTK's node order (VTK_TETRA, VTK_QUADRATIC_TETRA: corners, then midside
/// nodes of the edges 01 12 02 03 13 23).
struct TetMesh {
  ElementOrder order = ElementOrder::linear;
  /// Position at rest [num_points], m. A point that belongs to no cell is not an unknown.
  std::vector<Vec3> points;
  /// The points of the nodes [num_cells × nodes_per_cell(order)], cell by cell.
  std::vector<Index> cells;

  [[nodiscard]] Index num_points() const { return static_cast<Index>(points.size()); }
  [[nodiscard]] Index num_cells() const {
    return static_cast<Index>(cells.size()) / nodes_per_cell(order);
  }
  [[nodiscard]] const Index* cell(Index c) const {
    return cells.data() + c * nodes_per_cell(order);
  }
};

/// Checks indices and coordinates, and reorders the nodes of cells that are left-handed.
/// @throws InputError there are no cells, an index is out of range, a coordinate is not finite, or
///   a cell has no volume (less than 1e-12 of the cube of its longest edge). The message names the
///   first such point or cell, and how many there are.
void check_and_orient(TetMesh& mesh);

/// 1 for each point that belongs to a cell, else 0 [num_points].
[[nodiscard]] std::vector<char> points_in_use(const TetMesh& mesh);

/// The volume of the cells with straight edges, m³.
[[nodiscard]] double volume(const TetMesh& mesh);

/// The faces of the boundary, which are those that belong to one cell alone, face by face
/// [num_faces × nodes_per_face(order)]. They look outward: corners a b c, then the midside nodes of
/// ab, bc, ca.
/// @param cells If not null, it is set to the cell of each face [num_faces].
[[nodiscard]] std::vector<Index> boundary_faces(const TetMesh& mesh,
                                                std::vector<Index>* cells = nullptr);

/// The corners of the faces of the boundary.
[[nodiscard]] std::vector<std::array<Index, 3>> boundary_triangles(const TetMesh& mesh);

/// 1 for each point on the boundary, midside nodes included, else 0 [num_points].
[[nodiscard]] std::vector<char> boundary_points(const TetMesh& mesh);

}  // namespace palpate
