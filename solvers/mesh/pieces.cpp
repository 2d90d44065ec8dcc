// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/pieces.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <sstream>
#include <utility>

#include "mesh/cell_faces.h"
#include "mesh/disjoint_sets.h"

namespace palpate {
namespace {

/// @param set_of_cell The same number below `num_sets` for all cells of a piece, and for no others.
template <class SetOfCell>
Pieces collect(const TetMesh& mesh, Index num_sets, SetOfCell&& set_of_cell) {
  Pieces pieces;
  std::vector<Index> piece_of_set(num_sets, -1);
  pieces.of_cell.reserve(mesh.num_cells());
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    Index& place = piece_of_set[set_of_cell(c)];
    if (place < 0) {
      place = pieces.size();
      pieces.each.emplace_back();
    }
    pieces.of_cell.push_back(place);
    Piece& piece = pieces.each[place];
    const Index* cell = mesh.cell(c);
    const Vec3& p = mesh.points[cell[0]];
    const Vec3 a = mesh.points[cell[1]] - p;
    const Vec3 b = mesh.points[cell[2]] - p;
    const Vec3 d = mesh.points[cell[3]] - p;
    const double volume = a.cross(b).dot(d) / 6;
    ++piece.num_cells;
    piece.volume += volume;
    piece.centre += volume * (p + (a + b + d) / 4);
  }
  for (Piece& piece : pieces.each) piece.centre /= piece.volume;
  return pieces;
}

/// Whether the cell is on that side of its face to which the normal of the sorted corners points.
bool looks_up(const TetMesh& mesh, const CellFace& face) {
  const Index* cell = mesh.cell(face.cell);
  const Index opposite = cell[face.opposite];
  const auto& [a, b, c] = face.corners;
  const Vec3 normal = (mesh.points[b] - mesh.points[a]).cross(mesh.points[c] - mesh.points[a]);
  return normal.dot(mesh.points[opposite] - mesh.points[a]) > 0;
}

}  // namespace

Pieces find_pieces(const TetMesh& mesh) {
  DisjointSets points(mesh.num_points());
  const int nodes = nodes_per_cell(mesh.order);
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    for (int a = 1; a < nodes; ++a) points.join(mesh.cell(c)[0], mesh.cell(c)[a]);
  }
  return collect(mesh, mesh.num_points(), [&](Index c) { return points.root(mesh.cell(c)[0]); });
}

Pieces find_rigid_parts(const TetMesh& mesh) {
  const std::vector<CellFace> faces = sorted_faces(mesh);
  DisjointSets cells(mesh.num_cells());
  for (std::size_t f = 1; f < faces.size(); ++f) {
    if (faces[f].corners == faces[f - 1].corners) cells.join(faces[f].cell, faces[f - 1].cell);
  }
  return collect(mesh, mesh.num_cells(), [&](Index c) { return cells.root(c); });
}

std::optional<Index> find_overlap(const TetMesh& mesh) {
  const std::vector<CellFace> faces = sorted_faces(mesh);
  for (std::size_t f = 1; f < faces.size(); ++f) {
    const CellFace& face = faces[f];
    if (face.corners != faces[f - 1].corners) continue;
    const bool is_third = f > 1 && face.corners == faces[f - 2].corners;
    if (is_third || looks_up(mesh, face) == looks_up(mesh, faces[f - 1])) return face.cell;
  }
  return std::nullopt;
}

std::vector<Index> piece_of_points(const TetMesh& mesh, const Pieces& pieces) {
  std::vector<Index> piece(mesh.points.size(), -1);
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    for (int a = 0; a < nodes_per_cell(mesh.order); ++a) {
      piece[mesh.cell(c)[a]] = pieces.of_cell[c];
    }
  }
  return piece;
}

std::string describe(const Piece& piece) {
  std::ostringstream text;
  text.precision(3);
  text << piece.num_cells << (piece.num_cells == 1 ? " cell, " : " cells, ") << piece.volume
       << " m³, around (" << piece.centre.x() << ", " << piece.centre.y() << ", "
       << piece.centre.z() << ") m";
  return text.str();
}

}  // namespace palpate
