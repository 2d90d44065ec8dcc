// SPDX-License-Identifier: BSD-3-Clause
#include "state_space/surface.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>

#include "cutting/opened_mesh.h"
#include "mesh/cell_faces.h"

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

std::vector<Triangle> triangles_of(ElementOrder order, const std::vector<Index>& faces) {
  if (order == ElementOrder::quadratic) return split(faces);
  std::vector<Triangle> triangles;
  for (std::size_t i = 0; i < faces.size(); i += 3) {
    triangles.push_back({faces[i], faces[i + 1], faces[i + 2]});
  }
  return triangles;
}

/// @param triangles By points of the mesh.
Surface surface_of(const TetMesh& mesh, std::vector<Triangle> triangles) {
  Surface surface;
  surface.triangles = std::move(triangles);
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

}  // namespace

Index Surface::find(Index mesh_point) const {
  const auto found = std::lower_bound(mesh_points.begin(), mesh_points.end(), mesh_point);
  return found != mesh_points.end() && *found == mesh_point
             ? static_cast<Index>(found - mesh_points.begin())
             : -1;
}

Surface make_surface(const TetMesh& mesh) {
  return surface_of(mesh, triangles_of(mesh.order, boundary_faces(mesh)));
}

Surface make_surface(const Body& body) {
  if (body.cut.faces.empty()) return make_surface(body.mesh);
  const OpenedMesh opened =
      open_mesh(body.mesh, body.cut.faces, std::numeric_limits<std::int32_t>::max());
  std::vector<Index> cells;
  std::vector<Index> faces = boundary_faces(opened.mesh, &cells);
  const auto per_face = static_cast<std::size_t>(nodes_per_face(body.mesh.order));
  // The points of the body that the points of what is all open are.
  for (Index& p : faces) {
    const Index further = p - body.mesh.num_points();
    if (further >= 0) p = opened.originals[further];
  }
  std::vector<Index> outside;
  std::vector<Index> of_cut;
  std::vector<std::int32_t> stages;
  const std::size_t per_triangle = body.mesh.order == ElementOrder::quadratic ? 4 : 1;
  for (std::size_t f = 0; f < cells.size(); ++f) {
    const Index* corners = &faces[f * per_face];
    const int opposite = corner_opposite(body.mesh.cell(cells[f]), corners);
    const std::int32_t stage = body.cut.faces[cells[f]][opposite];
    std::vector<Index>& to = opens(stage) ? of_cut : outside;
    to.insert(to.end(), corners, corners + per_face);
    if (opens(stage)) stages.insert(stages.end(), per_triangle, stage);
  }
  outside.insert(outside.end(), of_cut.begin(), of_cut.end());
  Surface surface = surface_of(body.mesh, triangles_of(body.mesh.order, outside));
  surface.stages_of_cut = std::move(stages);
  return surface;
}

}  // namespace palpate
