// SPDX-License-Identifier: BSD-3-Clause
// Closed surfaces of triangles for tests.
#pragma once

#include <array>
#include <vector>

#include "mesh/tet_mesh.h"

namespace palpate::test {

/// Triangles look outward; each point belongs to one.
struct Surface {
  std::vector<Vec3> points;
  std::vector<std::array<Index, 3>> triangles;
};

/// What bounds a mesh, by its corners.
[[nodiscard]] Surface surface_of(const TetMesh& mesh);

/// The box from 0 to `size`, two triangles for each of squares[0] × squares[1] × squares[2].
[[nodiscard]] Surface box_surface(const Vec3& size, std::array<int, 3> squares);

/// The sphere around 0 of 20 · 4^level triangles: an icosahedron whose triangles are split in four,
/// with all points on the sphere.
[[nodiscard]] Surface icosphere(double radius, int level);

}  // namespace palpate::test
