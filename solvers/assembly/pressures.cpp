// SPDX-License-Identifier: BSD-3-Clause
#include "assembly/pressures.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

namespace palpate {

double softest_mixed(const std::vector<Material>& materials) {
  double softest = std::numeric_limits<double>::infinity();
  for (const Material& material : materials) {
    if (!is_mixed(material.formulation)) continue;
    softest = std::min(softest, shear_modulus(material));
  }
  return softest;
}

int decade_above(double softest, const Material& material) {
  return static_cast<int>(std::log10(shear_modulus(material) / softest));
}

Index count_pressures(const Scene& scene) {
  const double softest = softest_mixed(scene.organ.materials);
  if (std::isinf(softest)) return 0;
  // For each law and decade: 1 if a corner of a cell has its pressure [num_points].
  std::map<std::pair<Law, int>, std::vector<char>> corners;
  std::vector<std::vector<char>*> corners_of_material;
  for (const Material& material : scene.organ.materials) {
    corners_of_material.push_back(
        is_mixed(material.formulation)
            ? &corners[{law_of_energy(material.law), decade_above(softest, material)}]
            : nullptr);
  }
  for (auto& [key, of_key] : corners) of_key.assign(scene.body.mesh.points.size(), 0);
  Index count = 0;
  for (Index c = 0; c < scene.body.mesh.num_cells(); ++c) {
    auto* const own = corners_of_material[scene.body.material_of(c)];
    if (own == nullptr) continue;
    for (int a = 0; a < 4; ++a) {
      char& is_counted = (*own)[scene.body.mesh.cell(c)[a]];
      count += is_counted == 0 ? 1 : 0;
      is_counted = 1;
    }
  }
  return count;
}

}  // namespace palpate
