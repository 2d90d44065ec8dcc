// SPDX-License-Identifier: BSD-3-Clause
// Edges and faces of cells by the numbers of their corners.
#pragma once

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "mesh/tet_mesh.h"

namespace palpate {

/// The two points, ascending.
using EdgeKey = std::pair<Index, Index>;
/// The three corners, ascending.
using FaceKey = std::array<Index, 3>;

/// A face of a cell, opposite to a corner.
struct CellFace {
  FaceKey corners;
  Index cell;
  int opposite;
};

[[nodiscard]] inline EdgeKey edge_of(Index a, Index b) { return {std::min(a, b), std::max(a, b)}; }

/// The face of a cell that is opposite to a corner.
/// @param corners The first four numbers are those of the corners.
[[nodiscard]] inline FaceKey face_opposite(const Index* corners, int corner) {
  FaceKey face{};
  int next = 0;
  for (int a = 0; a < 4; ++a) {
    if (a != corner) face[next++] = corners[a];
  }
  std::sort(face.begin(), face.end());
  return face;
}

/// Which corner of a cell is opposite to one of its faces; −1: the face is not of the cell.
/// @param corners, face The first four and three numbers are those of the corners.
[[nodiscard]] inline int corner_opposite(const Index* corners, const Index* face) {
  int opposite = -1;
  int num_others = 0;
  for (int k = 0; k < 4; ++k) {
    if (std::find(face, face + 3, corners[k]) != face + 3) continue;
    opposite = k;
    ++num_others;
  }
  return num_others == 1 ? opposite : -1;
}

/// All faces of all cells; those that two cells share are neighbours, that of the first cell first.
[[nodiscard]] std::vector<CellFace> sorted_faces(const TetMesh& mesh);

}  // namespace palpate
