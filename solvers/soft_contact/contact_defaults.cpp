// SPDX-License-Identifier: BSD-3-Clause
#include "soft_contact/contact_defaults.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace palpate {
namespace {

constexpr double kThicknessOfEdge = 0.2;
constexpr double kStiffnessOfModulus = 2;

}  // namespace

double mean_surface_edge(const TetMesh& mesh) {
  double sum = 0;
  const std::vector<std::array<Index, 3>> triangles = boundary_triangles(mesh);
  for (const auto& triangle : triangles) {
    for (int a = 0; a < 3; ++a) {
      sum += (mesh.points[triangle[a]] - mesh.points[triangle[(a + 1) % 3]]).norm();
    }
  }
  return sum / (3 * static_cast<double>(triangles.size()));
}

double usual_contact_thickness(const TetMesh& mesh) {
  return kThicknessOfEdge * mean_surface_edge(mesh);
}

double usual_contact_stiffness(const Scene& scene) {
  std::vector<Index> cells;
  (void)boundary_faces(scene.body.mesh, &cells);
  double least = std::numeric_limits<double>::infinity();
  for (const Index cell : cells) least = std::min(least, youngs_modulus(scene.material_of(cell)));
  return kStiffnessOfModulus * least;
}

Scene with_contact_defaults(Scene scene) {
  if (scene.organ.touching == TouchingParts::none) return scene;
  ContactLaw& law = scene.organ.contact;
  if (law.thickness == 0) law.thickness = usual_contact_thickness(scene.body.mesh);
  if (law.stiffness == 0) law.stiffness = usual_contact_stiffness(scene);
  return scene;
}

}  // namespace palpate
