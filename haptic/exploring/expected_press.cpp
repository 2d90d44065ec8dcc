// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/exploring/expected_press.h"

#include <cmath>
#include <utility>

#include "interaction/rigid_tool.h"

namespace palpate {

std::vector<char> may_be_pressed(const Surface& surface, const Scene& scene,
                                 const ShellOptions& shell) {
  const TetMesh& mesh = scene.body.mesh;
  std::vector<char> touchable = scene.body.touchable;
  // Whether an edge may be touched is said by its ends.
  for (Index c = 0; c < mesh.num_cells() && mesh.order == ElementOrder::quadratic; ++c) {
    const Index* nodes = mesh.cell(c);
    for (int edge = 0; edge < 6; ++edge) {
      const auto [a, b] = std::pair(nodes[kTetEdges[edge][0]], nodes[kTetEdges[edge][1]]);
      if (scene.body.touchable[a] != 0 && scene.body.touchable[b] != 0) {
        touchable[nodes[4 + edge]] = 1;
      }
    }
  }
  std::vector<char> may;
  for (std::size_t p = 0; p < surface.points.size(); ++p) {
    const bool is_touchable = touchable[surface.mesh_points[p]] != 0;
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
