// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/tet_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <utility>

#include "base/error.h"
#include "base/quantity.h"

namespace palpate {
namespace {

/// A cell counts as having no volume below this multiple of the cube of its longest edge. The value
/// of a regular tetrahedron is 0.12, that of a bad but usable one 1e-4; rounding of coordinates
/// gives 1e-15.
constexpr double kLeastRelativeVolume = 1e-12;

/// The nodes of each face, outward in VTK's node order: corners a b c, midsides ab, bc, ca.
constexpr int kFaces[4][6] = {
    {0, 2, 1, 6, 5, 4}, {0, 1, 3, 4, 8, 7}, {1, 2, 3, 5, 9, 8}, {0, 3, 2, 7, 9, 6}};

double signed_volume(const TetMesh& mesh, const Index* cell) {
  const Vec3& p = mesh.points[cell[0]];
  return (mesh.points[cell[1]] - p).cross(mesh.points[cell[2]] - p).dot(mesh.points[cell[3]] - p) /
         6;
}

double longest_edge(const TetMesh& mesh, const Index* cell) {
  double longest = 0;
  for (int a = 0; a < 4; ++a) {
    for (int b = a + 1; b < 4; ++b) {
      longest = std::max(longest, (mesh.points[cell[a]] - mesh.points[cell[b]]).norm());
    }
  }
  return longest;
}

struct FaceKey {
  std::array<Index, 3> sorted;
  bool operator==(const FaceKey& other) const { return sorted == other.sorted; }
};

struct FaceHash {
  std::size_t operator()(const FaceKey& key) const {
    std::size_t h = 0;
    for (Index i : key.sorted) h = h * 0x9E3779B97F4A7C15ULL + static_cast<std::size_t>(i);
    return h ^ (h >> 29);
  }
};

}  // namespace

void check_and_orient(TetMesh& mesh) {
  const int npc = nodes_per_cell(mesh.order);
  if (mesh.num_cells() == 0) {
    throw InputError("The body has no tetrahedra. Mesh a closed surface first.");
  }
  for (Index p = 0; p < mesh.num_points(); ++p) {
    if (!mesh.points[p].allFinite()) {
      throw InputError("Point " + std::to_string(p) + " of the body has a coordinate that is not " +
                       "finite: " + quantity(mesh.points[p]) + ". Repair the points.");
    }
  }
  Index num_flat = 0;
  Index first_flat = 0;
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    Index* cell = mesh.cells.data() + c * npc;
    for (int a = 0; a < npc; ++a) {
      if (cell[a] < 0 || cell[a] >= mesh.num_points()) {
        throw InputError("Cell " + std::to_string(c) + " names point " + std::to_string(cell[a]) +
                         ", but the body has " + std::to_string(mesh.num_points()) + " points.");
      }
    }
    const double volume = signed_volume(mesh, cell);
    const double edge = longest_edge(mesh, cell);
    if (!(std::abs(volume) > kLeastRelativeVolume * edge * edge * edge)) {
      if (num_flat++ == 0) first_flat = c;
    } else if (volume < 0) {
      std::swap(cell[0], cell[1]);
      if (mesh.order == ElementOrder::quadratic) {
        std::swap(cell[5], cell[6]);  // edges 12 and 02
        std::swap(cell[7], cell[8]);  // edges 03 and 13
      }
    }
  }
  if (num_flat > 0) {
    const Vec3& where = mesh.points[mesh.cell(first_flat)[0]];
    throw InputError(std::to_string(num_flat) + " of the tetrahedra " +
                     (num_flat == 1 ? "has" : "have") + " no volume, the first is cell " +
                     std::to_string(first_flat) + " at " + quantity(where) +
                     ". Remove such cells or mesh the surface again.");
  }
}

std::vector<char> points_in_use(const TetMesh& mesh) {
  std::vector<char> used(mesh.points.size(), 0);
  for (Index p : mesh.cells) used[p] = 1;
  return used;
}

double volume(const TetMesh& mesh) {
  double sum = 0;
  for (Index c = 0; c < mesh.num_cells(); ++c) sum += signed_volume(mesh, mesh.cell(c));
  return sum;
}

std::vector<Index> boundary_faces(const TetMesh& mesh, std::vector<Index>* cells) {
  std::unordered_map<FaceKey, int, FaceHash> uses;
  uses.reserve(static_cast<std::size_t>(mesh.num_cells()) * 3);
  const auto key_of = [&](Index c, int face) {
    const Index* cell = mesh.cell(c);
    FaceKey key{{cell[kFaces[face][0]], cell[kFaces[face][1]], cell[kFaces[face][2]]}};
    std::sort(key.sorted.begin(), key.sorted.end());
    return key;
  };
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    for (int face = 0; face < 4; ++face) ++uses[key_of(c, face)];
  }
  std::vector<Index> faces;
  if (cells != nullptr) cells->clear();
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    for (int face = 0; face < 4; ++face) {
      if (uses.at(key_of(c, face)) != 1) continue;
      if (cells != nullptr) cells->push_back(c);
      for (int a = 0; a < nodes_per_face(mesh.order); ++a) {
        faces.push_back(mesh.cell(c)[kFaces[face][a]]);
      }
    }
  }
  return faces;
}

std::vector<std::array<Index, 3>> boundary_triangles(const TetMesh& mesh) {
  const std::vector<Index> faces = boundary_faces(mesh);
  std::vector<std::array<Index, 3>> triangles;
  for (std::size_t i = 0; i < faces.size(); i += nodes_per_face(mesh.order)) {
    triangles.push_back({faces[i], faces[i + 1], faces[i + 2]});
  }
  return triangles;
}

std::vector<char> boundary_points(const TetMesh& mesh) {
  std::vector<char> on_boundary(mesh.points.size(), 0);
  for (const Index p : boundary_faces(mesh)) on_boundary[p] = 1;
  return on_boundary;
}

}  // namespace palpate
