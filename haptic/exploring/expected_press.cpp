// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/exploring/expected_press.h"

#include <cmath>

#include "interaction/rigid_tool.h"

namespace palpate {

std::vector<char> may_be_pressed(const Surface& surface, const Scene& scene,
                                 const ShellOptions& shell) {
  std::vector<char> may;
  for (std::size_t p = 0; p < surface.points.size(); ++p) {
    const auto point = static_cast<std::size_t>(surface.mesh_points[p]);
    const bool is_touchable = scene.body.touchable[point] != 0;
    may.push_back(is_touchable && (!shell.region || shell.region(surface.points[p])) ? 1 : 0);
  }
  return may;
}

ExpectedPress expected_press(const Scene& scene, const ToolSpaceSetup& setup) {
  const double modulus = mean_contact_modulus(scene);
  const double radius = setup.interaction.touching_radius();
  const double depth = setup.depth();
  return {4.0 / 3 * modulus * std::sqrt(radius) * std::pow(depth, 1.5),
          2 / double{EIGEN_PI} * modulus * std::sqrt(depth / radius)};
}

}  // namespace palpate
