// SPDX-License-Identifier: BSD-3-Clause
// The patch of the surface that a tool of finite size touches: it is connected and lies around a
// node.
#pragma once

#include <vector>

#include "mesh/tet_mesh.h"

namespace palpate {

/// Patches of the surface of one mesh.
class SurfacePatches {
 public:
  explicit SurfacePatches(const TetMesh& mesh);

  [[nodiscard]] bool on_surface(Index point) const;

  /// The points of the surface within the Euclidean distance `radius` (m, at rest) of a node that
  /// are reached from it over the faces of the boundary through such points alone, midside nodes
  /// included; ascending. Radius 0 gives the node alone.
  /// @throws InputError the node is not on the surface, or the radius is negative or not finite.
  [[nodiscard]] std::vector<Index> around(Index node, double radius) const;

 private:
  std::vector<Vec3> points_;
  int nodes_per_face_;
  std::vector<Index> faces_;
  /// The faces at each point, concatenated, and where those of each point begin.
  std::vector<Index> face_of_point_;
  std::vector<Index> first_face_;
};

}  // namespace palpate
