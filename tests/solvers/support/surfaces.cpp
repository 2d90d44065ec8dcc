// SPDX-License-Identifier: BSD-3-Clause
#include "solvers/support/surfaces.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "solvers/support/box_mesh.h"

namespace palpate::test {

Surface surface_of(const TetMesh& mesh) {
  Surface surface;
  std::map<Index, Index> numbers;
  for (auto triangle : boundary_triangles(mesh)) {
    for (Index& point : triangle) {
      const auto [place, is_new] = numbers.try_emplace(point, static_cast<Index>(numbers.size()));
      if (is_new) surface.points.push_back(mesh.points[point]);
      point = place->second;
    }
    surface.triangles.push_back(triangle);
  }
  return surface;
}

Surface box_surface(const Vec3& size, std::array<int, 3> squares) {
  return surface_of(make_box(ElementOrder::linear, squares, size));
}

Surface icosphere(double radius, int level) {
  const double t = (1 + std::sqrt(5.0)) / 2;
  Surface surface;
  surface.points = {{-1, t, 0},  {1, t, 0},  {-1, -t, 0}, {1, -t, 0}, {0, -1, t},  {0, 1, t},
                    {0, -1, -t}, {0, 1, -t}, {t, 0, -1},  {t, 0, 1},  {-t, 0, -1}, {-t, 0, 1}};
  surface.triangles = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                       {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                       {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                       {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (Vec3& point : surface.points) point.normalize();
  for (int i = 0; i < level; ++i) {
    std::map<std::pair<Index, Index>, Index> middles;
    const auto middle = [&](Index a, Index b) {
      const auto [place, is_new] = middles.try_emplace(std::minmax({a, b}), surface.points.size());
      if (is_new) surface.points.push_back((surface.points[a] + surface.points[b]).normalized());
      return place->second;
    };
    std::vector<std::array<Index, 3>> finer;
    for (const auto& [a, b, c] : surface.triangles) {
      const Index ab = middle(a, b);
      const Index bc = middle(b, c);
      const Index ca = middle(c, a);
      for (const auto& triangle : {std::array{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}}) {
        finer.push_back(triangle);
      }
    }
    surface.triangles = std::move(finer);
  }
  for (Vec3& point : surface.points) point *= radius;
  return surface;
}

}  // namespace palpate::test
