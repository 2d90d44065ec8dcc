// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "mesh/cell_faces.h"

namespace palpate {

/// The corners of the face opposite to a corner of a cell, and the midside nodes between them.
[[nodiscard]] inline std::vector<Index> points_of_side(const TetMesh& mesh, Index cell,
                                                       int opposite) {
  const Index* nodes = mesh.cell(cell);
  const FaceKey corners = face_opposite(nodes, opposite);
  std::vector<Index> points(corners.begin(), corners.end());
  for (int e = 0; e < 6 && mesh.order == ElementOrder::quadratic; ++e) {
    if (kTetEdges[e][0] != opposite && kTetEdges[e][1] != opposite) {
      points.push_back(nodes[4 + e]);
    }
  }
  return points;
}

}  // namespace palpate
