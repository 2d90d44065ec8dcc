// SPDX-License-Identifier: BSD-3-Clause
#include "solvers/support/box_mesh.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace palpate::test {
namespace {

/// The six orders of the axes: a tetrahedron each, along the diagonal of the brick (Kuhn).
constexpr int kOrders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {1, 0, 2}, {0, 2, 1}, {2, 1, 0}};

Vec3 wave(const Vec3& p, const Vec3& size) {
  const double x = p.x() / size.x();
  const double y = p.y() / size.y();
  const double z = p.z() / size.z();
  return Vec3(std::sin(3 * y + 2 * z + 1), std::sin(2 * z - 3 * x), std::cos(2 * x + 3 * y - 1));
}

}  // namespace

TetMesh with_midside_nodes(const TetMesh& linear) {
  TetMesh mesh;
  mesh.order = ElementOrder::quadratic;
  mesh.points = linear.points;
  std::map<std::pair<Index, Index>, Index> middle;
  for (Index c = 0; c < linear.num_cells(); ++c) {
    const Index* corner = linear.cell(c);
    mesh.cells.insert(mesh.cells.end(), corner, corner + 4);
    for (const auto& edge : kTetEdges) {
      const auto ends = std::minmax(corner[edge[0]], corner[edge[1]]);
      const auto [place, is_new] = middle.try_emplace(ends, mesh.num_points());
      if (is_new) mesh.points.push_back((mesh.points[ends.first] + mesh.points[ends.second]) / 2);
      mesh.cells.push_back(place->second);
    }
  }
  return mesh;
}

TetMesh make_box(ElementOrder order, std::array<int, 3> cells, const Vec3& size) {
  TetMesh mesh;
  for (int k = 0; k <= cells[2]; ++k) {
    for (int j = 0; j <= cells[1]; ++j) {
      for (int i = 0; i <= cells[0]; ++i) {
        mesh.points.push_back(size.cwiseProduct(Vec3(static_cast<double>(i) / cells[0],
                                                     static_cast<double>(j) / cells[1],
                                                     static_cast<double>(k) / cells[2])));
      }
    }
  }
  const std::array<Index, 3> stride{1, cells[0] + 1, (cells[0] + 1) * (cells[1] + 1)};
  for (int k = 0; k < cells[2]; ++k) {
    for (int j = 0; j < cells[1]; ++j) {
      for (int i = 0; i < cells[0]; ++i) {
        for (int n = 0; n < 6; ++n) {
          Index corner[4] = {i * stride[0] + j * stride[1] + k * stride[2], 0, 0, 0};
          for (int a = 0; a < 3; ++a) corner[a + 1] = corner[a] + stride[kOrders[n][a]];
          if (n >= 3) std::swap(corner[1], corner[2]);  // an odd order is left-handed
          mesh.cells.insert(mesh.cells.end(), corner, corner + 4);
        }
      }
    }
  }
  return order == ElementOrder::linear ? mesh : with_midside_nodes(mesh);
}

void warp_curved(TetMesh& mesh, const Map& map) {
  for (Vec3& p : mesh.points) p = map(p);
}

void warp_straight(TetMesh& mesh, const Map& map) {
  warp_curved(mesh, map);
  if (mesh.order == ElementOrder::linear) return;
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    const Index* cell = mesh.cell(c);
    for (int e = 0; e < 6; ++e) {
      mesh.points[cell[4 + e]] =
          (mesh.points[cell[kTetEdges[e][0]]] + mesh.points[cell[kTetEdges[e][1]]]) / 2;
    }
  }
}

Map wavy(const Vec3& size) {
  return [size](const Vec3& p) -> Vec3 { return p + 0.04 * size.minCoeff() * wave(p, size); };
}

Map wavy_inside(const Vec3& size) {
  return [size](const Vec3& p) -> Vec3 {
    double bubble = 1;
    for (int i = 0; i < 3; ++i) bubble *= 4 * p[i] / size[i] * (1 - p[i] / size[i]);
    return p + 0.05 * size.minCoeff() * bubble * wave(p, size);
  };
}

TetMesh subset(const TetMesh& mesh, const std::function<bool(Index)>& keep) {
  TetMesh part;
  part.order = mesh.order;
  part.points = mesh.points;
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    if (keep(c)) {
      part.cells.insert(part.cells.end(), mesh.cell(c), mesh.cell(c) + nodes_per_cell(mesh.order));
    }
  }
  return part;
}

}  // namespace palpate::test
