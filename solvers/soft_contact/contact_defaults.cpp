// SPDX-License-Identifier: BSD-3-Clause
#include "soft_contact/contact_defaults.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

#include "mesh/cell_faces.h"

namespace palpate {
namespace {

constexpr double kThicknessOfEdge = 0.2;
constexpr double kThicknessOfLips = 0.05;
constexpr double kStiffnessOfModulus = 2;
/// How much an edge grows on the way to the next, as a share of that. Meshers take 0.2 to 0.5.
constexpr double kGrowth = 0.3;

double mean_edge(const TetMesh& mesh, const std::array<Index, 3>& triangle) {
  double sum = 0;
  for (int a = 0; a < 3; ++a) {
    sum += (mesh.points[triangle[a]] - mesh.points[triangle[(a + 1) % 3]]).norm();
  }
  return sum / 3;
}

/// Makes sizes smaller so that from point to point they grow by no more than kGrowth of the way
/// along the edges.
void limit_growth(const TetMesh& mesh, const std::vector<std::array<Index, 3>>& triangles,
                  std::vector<double>& sizes) {
  std::vector<std::vector<Index>> neighbours(sizes.size());
  for (const auto& triangle : triangles) {
    for (int a = 0; a < 3; ++a) neighbours[triangle[a]].push_back(triangle[(a + 1) % 3]);
  }
  using SizeAt = std::pair<double, Index>;
  std::priority_queue<SizeAt, std::vector<SizeAt>, std::greater<>> least_first;
  for (std::size_t p = 0; p < sizes.size(); ++p) {
    if (!neighbours[p].empty()) least_first.emplace(sizes[p], static_cast<Index>(p));
  }
  while (!least_first.empty()) {
    const auto [size, point] = least_first.top();
    least_first.pop();
    if (size > sizes[point]) continue;
    for (const Index next : neighbours[point]) {
      const double most = size + kGrowth * (mesh.points[next] - mesh.points[point]).norm();
      if (most >= sizes[next]) continue;
      sizes[next] = most;
      least_first.emplace(most, next);
    }
  }
}

}  // namespace

double mean_surface_edge(const TetMesh& mesh) {
  double sum = 0;
  const std::vector<std::array<Index, 3>> triangles = boundary_triangles(mesh);
  for (const auto& triangle : triangles) sum += mean_edge(mesh, triangle);
  return sum / static_cast<double>(triangles.size());
}

std::vector<double> local_surface_edges(const TetMesh& mesh, double most) {
  const std::vector<std::array<Index, 3>> triangles = boundary_triangles(mesh);
  std::vector<double> sums(mesh.points.size(), 0);
  std::vector<int> counts(mesh.points.size(), 0);
  for (const auto& triangle : triangles) {
    const double edge = mean_edge(mesh, triangle);
    for (const Index point : triangle) {
      sums[point] += edge;
      ++counts[point];
    }
  }
  std::vector<double> of_points(mesh.points.size(), std::numeric_limits<double>::infinity());
  for (std::size_t p = 0; p < of_points.size(); ++p) {
    if (counts[p] > 0) of_points[p] = std::min(sums[p] / counts[p], most);
  }
  limit_growth(mesh, triangles, of_points);
  std::vector<double> edges;
  edges.reserve(triangles.size());
  for (const auto& [a, b, c] : triangles) {
    edges.push_back((of_points[a] + of_points[b] + of_points[c]) / 3);
  }
  return edges;
}

double usual_contact_thickness(const Scene& scene) {
  const TetMesh& mesh = scene.body.mesh;
  if (scene.organ.touching != TouchingParts::lips)
    return kThicknessOfEdge * mean_surface_edge(mesh);
  double sum = 0;
  Index count = 0;
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    for (int k = 0; k < 4; ++k) {
      if (!opens(scene.body.cut.faces[c][k])) continue;
      sum += mean_edge(mesh, face_opposite(mesh.cell(c), k));
      ++count;
    }
  }
  return count > 0 ? kThicknessOfLips * sum / count : kThicknessOfEdge * mean_surface_edge(mesh);
}

double usual_contact_stiffness(const Scene& scene) {
  std::vector<Index> cells;
  if (scene.organ.touching == TouchingParts::lips) {
    for (Index c = 0; c < scene.body.mesh.num_cells(); ++c) {
      const OpenedFaces& faces = scene.body.cut.faces[c];
      if (std::any_of(faces.begin(), faces.end(), opens)) cells.push_back(c);
    }
  }
  if (cells.empty()) (void)boundary_faces(scene.body.mesh, &cells);
  double least = std::numeric_limits<double>::infinity();
  for (const Index cell : cells) least = std::min(least, youngs_modulus(scene.material_of(cell)));
  return kStiffnessOfModulus * least;
}

Scene with_contact_defaults(Scene scene) {
  if (scene.organ.touching == TouchingParts::none) return scene;
  ContactLaw& law = scene.organ.contact;
  if (law.thickness == 0) law.thickness = usual_contact_thickness(scene);
  if (law.stiffness == 0) law.stiffness = usual_contact_stiffness(scene);
  return scene;
}

}  // namespace palpate
