// SPDX-License-Identifier: BSD-3-Clause
// A box whose stiffness falls as its cut opens.
#pragma once

#include <vector>

#include "haptic/support/analytic_body.h"

namespace palpate::test {

/// Of the stages, m².
inline const std::vector<double> kAreas{0, 1e-4, 2e-4, 3e-4, 4e-4};
/// J/m². The whole cut takes 0.4 mJ.
inline constexpr double kToughness = 1;

/// How stiff the body is when an area is open, N/m: G = ½ q² 8e4 at a displacement q.
inline double stiffness_at(double area) { return 60 - 8e4 * area; }

/// The sheet comes in at x = 0, and goes on along x in the middle of the box, a centimetre deep
/// from its top. Front j is at x = 0.01 j m.
inline constexpr double kFrontLength = 0.01;
inline void add_sheet(Surface& surface) {
  const auto num_stages = static_cast<int>(kAreas.size()) - 1;
  for (int j = 0; j <= num_stages; ++j) {
    for (const double z : {kBox.z() - kFrontLength, kBox.z()}) {
      surface.mesh_points.push_back(surface.mesh_points.back() + 1);
      surface.points.push_back(Vec3(0.01 * j, 0.5 * kBox.y(), z));
    }
    if (j == 0) continue;
    const Index last = surface.num_points() - 1;
    surface.triangles.push_back({last - 3, last - 1, last});
    surface.triangles.push_back({last - 3, last, last - 2});
    surface.stages_of_cut.insert(surface.stages_of_cut.end(), 2, j);
  }
}

/// The last stage is the first body.
inline TouchSpace torn_box(const std::vector<Index>& nodes) {
  TouchSpace space;
  const auto num_stages = static_cast<BodyId>(kAreas.size());
  for (BodyId body = 1; body <= num_stages; ++body) {
    const double area = kAreas[static_cast<std::size_t>(num_stages - body)];
    TouchSpace stage = box_space([&](int) { return stiffening_spring(stiffness_at(area)); }, nodes);
    if (body == 1) {
      space.surface = stage.surface;
      add_sheet(space.surface);
    }
    for (TouchToolSpace& tool_space : stage.tool_spaces) {
      tool_space.setup.id = tool_space.setup.interaction.active_node;
      tool_space.setup.body = body;
      space.tool_spaces.push_back(std::move(tool_space));
    }
    space.stages.insert(space.stages.begin(), {body, area});
  }
  space.scene_hash = "torn";
  return space;
}

/// The inner points of the top.
inline std::vector<Index> top_points() {
  std::vector<Index> nodes;
  for (const TouchToolSpace& tool_space :
       box_space([](int) { return stiffening_spring(1); }).tool_spaces) {
    nodes.push_back(tool_space.setup.interaction.active_node);
  }
  return nodes;
}

}  // namespace palpate::test
