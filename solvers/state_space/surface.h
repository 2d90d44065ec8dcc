// SPDX-License-Identifier: BSD-3-Clause
// The surface of a body at rest: what is touched and shown.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "assembly/body.h"

namespace palpate {

struct Surface {
  /// Position at rest [num_points], m.
  std::vector<Vec3> points;
  /// The point of the mesh that each point is [num_points], ascending.
  std::vector<Index> mesh_points;
  /// Places in `points`, such that triangles look outward. A face of a quadratic body gives four.
  std::vector<std::array<Index, 3>> triangles;
  /// The last triangles are the sides of a cut, which are shown where it opens: the stage at which
  /// each of them opens. All others are touched.
  std::vector<std::int32_t> stages_of_cut;

  [[nodiscard]] Index num_points() const { return static_cast<Index>(points.size()); }
  [[nodiscard]] std::ptrdiff_t num_touched() const {
    return static_cast<std::ptrdiff_t>(triangles.size() - stages_of_cut.size());
  }
  [[nodiscard]] std::vector<std::array<Index, 3>> touched_triangles() const {
    return {triangles.begin(), triangles.begin() + num_touched()};
  }
  /// The point of the surface that a point of the mesh is; −1 inside the body.
  [[nodiscard]] Index find(Index mesh_point) const;
};

/// Makes the surface that bounds a mesh, midside nodes included.
[[nodiscard]] Surface make_surface(const TetMesh& mesh);
/// Makes the surface of a body. One that is cut has both sides of all that opens, also of what is
/// closed yet, so that the surfaces of all stages have the same triangles in the same order.
[[nodiscard]] Surface make_surface(const Body& body);

}  // namespace palpate
