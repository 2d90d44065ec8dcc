// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/cell_faces.h"

#include <tuple>

namespace palpate {

std::vector<CellFace> sorted_faces(const TetMesh& mesh) {
  std::vector<CellFace> faces;
  faces.reserve(static_cast<std::size_t>(mesh.num_cells()) * 4);
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    for (int k = 0; k < 4; ++k) faces.push_back({face_opposite(mesh.cell(c), k), c, k});
  }
  std::sort(faces.begin(), faces.end(), [](const CellFace& a, const CellFace& b) {
    return std::tie(a.corners, a.cell) < std::tie(b.corners, b.cell);
  });
  return faces;
}

}  // namespace palpate
