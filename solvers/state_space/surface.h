// SPDX-License-Identifier: BSD-3-Clause
// The surface of a body at rest: what is touched and shown.
#pragma once

#include <array>
#include <vector>

#include "mesh/tet_mesh.h"

namespace palpate {

struct Surface {
  /// Position at rest [num_points], m.
  std::vector<Vec3> points;
  /// The point of the mesh that each point is [num_points], ascending.
  std::vector<Index> mesh_points;
  /// Places in `points`, such that triangles look outward. A face of a quadratic body gives four.
  std::vector<std::array<Index, 3>> triangles;

  [[nodiscard]] Index num_points() const { return static_cast<Index>(points.size()); }
  /// The point of the surface that a point of the mesh is; −1 inside the body.
  [[nodiscard]] Index find(Index mesh_point) const;
};

/// Makes the surface that bounds a mesh, midside nodes included.
[[nodiscard]] Surface make_surface(const TetMesh& mesh);

}  // namespace palpate
