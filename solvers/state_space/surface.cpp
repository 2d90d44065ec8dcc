// SPDX-License-Identifier: BSD-3-Clause
#include "state_space/surface.h"

#include <algorithm>
#include <unordered_map>

namespace palpate {
namespace {

using Triangle = std::array<Index, 3>;

/// Ends of the edges that the midside nodes 4 … 9 lie on.
constexpr int kEdges[6][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};

std::uint64_t edge_key(Index a, Index b) {
  return static_cast<std::uint64_t>(std::min(a, b)) << 32 |
         static_cast<std::uint32_t>(std::max(a, b));
}

std::vector<Triangle> split(const TetMesh& mesh, const std::vector<Triangle>& faces) {
  std::unordered_map<std::uint64_t, Index> midside;
  midside.reserve(static_cast<std::size_t>(mesh.num_cells()) * 2);
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    const Index* cell = mesh.cell(c);
    for (int e = 0; e < 6; ++e) {
      midside.emplace(edge_key(cell[kEdges[e][0]], cell[kEdges[e][1]]), cell[4 + e]);
    }
  }
  std::vector<Triangle> triangles;
  triangles.reserve(4 * faces.size());
  for (const auto& [a, b, c] : faces) {
    const Index ab = midside.at(edge_key(a, b));
    const Index bc = midside.at(edge_key(b, c));
    const Index ca = midside.at(edge_key(c, a));
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
  surface.triangles = boundary_triangles(mesh);
  if (mesh.order == ElementOrder::quadratic) surface.triangles = split(mesh, surface.triangles);

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
