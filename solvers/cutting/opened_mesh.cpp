// SPDX-License-Identifier: BSD-3-Clause
#include "cutting/opened_mesh.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "base/quantity.h"
#include "mesh/cell_faces.h"
#include "mesh/disjoint_sets.h"

namespace palpate {
namespace {

bool is_open(const std::vector<OpenedFaces>& faces, const CellFace& face, int stage) {
  return palpate::is_open(faces[face.cell][face.opposite], stage);
}

EdgeKey longest_side(const TetMesh& mesh, const FaceKey& face) {
  const auto& [a, b, c] = face;
  const auto length = [&](const EdgeKey& edge) {
    return (mesh.points[edge.first] - mesh.points[edge.second]).norm();
  };
  return std::max({EdgeKey(a, b), EdgeKey(b, c), EdgeKey(a, c)},
                  [&](const EdgeKey& e, const EdgeKey& f) { return length(e) < length(f); });
}

struct Count {
  Index vertices = 0, edges = 0, faces = 0;
  [[nodiscard]] Index characteristic() const { return vertices - edges + faces; }
};

/// How many open faces an edge has, and whether it is on the boundary of the closed mesh.
struct AroundEdge {
  int num_open = 0;
  bool is_outside = false;
};

/// The open faces at a point. On a small sphere around it they are arcs between the edges there.
struct AroundPoint {
  /// The two other corners of each open face.
  std::vector<std::array<Index, 2>> arcs;

  /// Into how many parts the arcs divide the sphere, or what of it is in the body, which the circle
  /// of the surface bounds (Euler: regions = arcs − ends + connected parts + 1).
  /// @param on_circle Whether the edge to another point is on the surface.
  template <class OnCircle>
  [[nodiscard]] Index copies(const OnCircle& on_circle) const {
    std::map<Index, Index> number;  // the circle is the end 0
    Index num_ends = 1;
    for (const auto& arc : arcs) {
      for (const Index end : arc) {
        if (number.count(end) != 0) continue;
        number[end] = on_circle(end) ? 0 : num_ends++;
      }
    }
    DisjointSets sets(num_ends);
    for (const auto& [a, b] : arcs) sets.join(number[a], number[b]);
    Index parts = 0;
    for (Index end = 0; end < num_ends; ++end) parts += sets.root(end) == end ? 1 : 0;
    const Index balance = static_cast<Index>(arcs.size()) - (num_ends - 1);
    // What is outside the circle is no region; without a surface there is no circle, but it counts
    // as a part: one less in either case.
    return balance + parts;
  }
};

}  // namespace

OpenedMesh open_mesh(const TetMesh& mesh, const std::vector<OpenedFaces>& faces, int stage) {
  const Index nodes = nodes_per_cell(mesh.order);
  const auto num_nodes = static_cast<Index>(mesh.cells.size());
  DisjointSets copies(num_nodes);
  const std::vector<CellFace> all = sorted_faces(mesh);
  for (std::size_t i = 1; i < all.size(); ++i) {
    const CellFace& a = all[i - 1];
    const CellFace& b = all[i];
    if (a.corners != b.corners || is_open(faces, a, stage)) continue;
    // All nodes that the two cells share are on this face.
    const Index first_a = nodes * a.cell;
    const Index first_b = nodes * b.cell;
    for (Index m = 0; m < nodes; ++m) {
      for (Index n = 0; n < nodes; ++n) {
        if (mesh.cells[first_a + m] == mesh.cells[first_b + n]) {
          copies.join(first_a + m, first_b + n);
        }
      }
    }
  }
  OpenedMesh result;
  result.mesh.order = mesh.order;
  result.mesh.points = mesh.points;
  result.mesh.cells.resize(mesh.cells.size());
  // The first copy that is met keeps the number of the point.
  std::vector<char> is_taken(mesh.points.size(), 0);
  for (Index i = 0; i < num_nodes; ++i) {
    const Index original = mesh.cells[i];
    const Index first = copies.root(i);
    if (first != i) {
      result.mesh.cells[i] = result.mesh.cells[first];
    } else if (is_taken[original] == 0) {
      is_taken[original] = 1;
      result.mesh.cells[i] = original;
    } else {
      result.mesh.cells[i] = result.mesh.num_points();
      result.mesh.points.push_back(mesh.points[original]);
      result.originals.push_back(original);
    }
  }
  return result;
}

Index euler_characteristic(const TetMesh& mesh) {
  const std::vector<FaceKey> triangles = boundary_triangles(mesh);
  std::vector<Index> vertices;
  std::vector<EdgeKey> edges;
  for (const FaceKey& t : triangles) {
    for (int k = 0; k < 3; ++k) {
      vertices.push_back(t[k]);
      edges.push_back(edge_of(t[k], t[(k + 1) % 3]));
    }
  }
  const auto count = [](auto& of) {
    std::sort(of.begin(), of.end());
    return static_cast<Index>(std::unique(of.begin(), of.end()) - of.begin());
  };
  return Count{count(vertices), count(edges), static_cast<Index>(triangles.size())}
      .characteristic();
}

std::optional<MeshFault> find_fault(const TetMesh& whole,
                                    const std::vector<OpenedFaces>& faces_of_whole, int stage) {
  // The cells around the points of the open faces: what happens elsewhere is as before.
  std::vector<char> is_near(whole.points.size(), 0);
  for (Index c = 0; c < whole.num_cells(); ++c) {
    for (int k = 0; k < 4; ++k) {
      const std::int32_t from = faces_of_whole[c][k];
      if (from == 0 || from > stage) continue;
      for (const Index point : face_opposite(whole.cell(c), k)) is_near[point] = 1;
    }
  }
  TetMesh mesh;
  mesh.points = whole.points;
  std::vector<OpenedFaces> faces;
  for (Index c = 0; c < whole.num_cells(); ++c) {
    const Index* corners = whole.cell(c);
    if (std::none_of(corners, corners + 4, [&](Index p) { return is_near[p] != 0; })) continue;
    mesh.cells.insert(mesh.cells.end(), corners, corners + 4);
    faces.push_back(faces_of_whole[c]);
  }
  const auto at = [&](Index point) { return " at " + quantity(mesh.points[point], "m"); };
  std::map<EdgeKey, AroundEdge> edges;
  std::map<Index, AroundPoint> points;
  std::set<Index> outside;
  Count added;
  const std::vector<CellFace> all = sorted_faces(mesh);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto& [a, b, c] = all[i].corners;
    const bool has_other = i + 1 < all.size() && all[i + 1].corners == all[i].corners;
    const bool open = is_open(faces, all[i], stage);
    if (has_other && open != is_open(faces, all[i + 1], stage)) {
      return MeshFault{"a face is open on one side alone" + at(a), {}};
    }
    if (!has_other && open) return MeshFault{"a face of the surface is open" + at(a), {}};
    for (const EdgeKey& edge : {EdgeKey(a, b), EdgeKey(b, c), EdgeKey(a, c)}) {
      AroundEdge& around = edges[edge];
      around.num_open += open ? 1 : 0;
      around.is_outside = around.is_outside || !has_other;
    }
    if (!has_other) outside.insert({a, b, c});
    if (open) {
      points[a].arcs.push_back({b, c});
      points[b].arcs.push_back({a, c});
      points[c].arcs.push_back({a, b});
      added.faces += 2;
    }
    if (has_other) ++i;
  }
  for (const auto& [edge, around] : edges) added.edges += around.num_open;
  for (const auto& [point, around] : points) {
    const bool is_outside = outside.count(point) != 0;
    added.vertices += around.copies([&, center = point](Index other) {
      return edges.at(edge_of(center, other)).is_outside;
    }) - (is_outside ? 1 : 0);
  }
  const OpenedMesh copies = open_mesh(mesh, faces, stage);
  const TetMesh& opened = copies.mesh;
  std::map<EdgeKey, int> uses;
  for (const auto& t : boundary_triangles(opened)) {
    for (int k = 0; k < 3; ++k) ++uses[edge_of(t[k], t[(k + 1) % 3])];
  }
  for (const auto& [edge, count] : uses) {
    const bool is_copy = edge.second >= mesh.num_points();
    if (count == 2 || (!is_copy && is_near[edge.first] == 0 && is_near[edge.second] == 0)) continue;
    const auto original = [&](Index p) {
      return p < mesh.num_points() ? p : copies.originals[p - mesh.num_points()];
    };
    return MeshFault{
        std::to_string(count) + " faces of the surface meet at an edge" + at(original(edge.first)),
        edge_of(original(edge.first), original(edge.second))};
  }
  // Some cells hang together by others that were left out.
  const TetMesh closed = open_mesh(mesh, faces, 0).mesh;
  const Index expected = euler_characteristic(closed) + added.characteristic();
  const Index found = euler_characteristic(opened);
  const std::vector<CellFace> after = sorted_faces(opened);
  for (std::size_t i = 1; i < after.size(); ++i) {
    const FaceKey& corners = after[i].corners;
    if (corners != after[i - 1].corners || !is_open(faces, after[i], stage)) continue;
    // No corner opens, so that the two sides are the same face.
    return MeshFault{"a face opens between corners that do not" + at(corners[0]),
                     longest_side(mesh, corners)};
  }
  if (expected != found) {
    return MeshFault{"the surface has the Euler characteristic " + std::to_string(found) +
                         " in place of " + std::to_string(expected),
                     {}};
  }
  return std::nullopt;
}

}  // namespace palpate
