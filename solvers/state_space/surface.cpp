// SPDX-License-Identifier: BSD-3-Clause
#include "state_space/surface.h"

#include <algorithm>

namespace palpate {
namespace {

using Triangle = std::array<Index, 3>;

/// Four triangles for each quadratic face.
std::vector<Triangle> split(const std::vector<Index>& faces) {
  std::vector<Triangle> triangles;
  triangles.reserve(faces.size() * 4 / 6);
  for (std::size_t i = 0; i < faces.size(); i += 6) {
    const Index a = faces[i], b = faces[i + 1], c = faces[i + 2];
    const Index ab = faces[i + 3], bc = faces[i + 4], ca = faces[i + 5];
    triangles.insert(triangles.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
  }
  return triangles;
}

}  // namespace

Index Surface::find(Index mesh_point) const {
  const auto found = std::lower_bound(mesh_points.begin(), mesh_points.end(), mesh_point);
  return found != mesh_points.end() && *found == mesh_point
             ? static_cast<Index>(found - mesh_points.begin())
             : -1;
}

Surface make_surface(const TetMesh& mesh) {
  Surface surface;
  surface.triangles = mesh.order == ElementOrder::quadratic ? split(boundary_faces(mesh))
                                                            : boundary_triangles(mesh);

  std::vector<Index> number(mesh.points.size(), -1);
  for (const Triangle& triangle : surface.triangles) {
    for (Index p : triangle) number[p] = 0;
  }
  for (Index p = 0; p < mesh.num_points(); ++p) {
    if (number[p] < 0) continue;
    number[p] = surface.num_points();
    surface.points.push_back(mesh.points[p]);
    surface.mesh_points.push_back(p);
  }
  for (Triangle& triangle : surface.triangles) {
    for (Index& p : triangle) p = number[p];
  }
  return surface;
}

}  // namespace palpate
