// SPDX-License-Identifier: BSD-3-Clause
#include "state_space/touch_space.h"

#include <algorithm>
#include <memory>

#include "interaction/tool_clearance.h"

namespace palpate {

void add_clearance(const Scene& scene, TouchToolSpace& tool_space) {
  const InteractionSpec& interaction = tool_space.setup.interaction;
  if (!interaction.presses()) return;
  add_clearance(InteractionFactory(scene).clearance(interaction), tool_space);
}

void add_clearance(std::shared_ptr<const ToolClearance> clearance, TouchToolSpace& tool_space) {
  for (ConfigurationSummary& found : tool_space.configurations) {
    if (found.usable() && found.force.isZero(0) && clearance->is_inside(found.t)) {
      found.outcome = Outcome::tool_inside;
    }
  }
  tool_space.clearance = [clearance = std::move(clearance)](const Vec3& q) {
    return clearance->clearance(q);
  };
}

const TouchToolSpace* TouchSpace::find(ToolSpaceId id) const {
  const auto found = std::lower_bound(
      tool_spaces.begin(), tool_spaces.end(), id,
      [](const TouchToolSpace& space, ToolSpaceId of) { return space.setup.id < of; });
  return found != tool_spaces.end() && found->setup.id == id ? &*found : nullptr;
}

const TouchToolSpace* TouchSpace::find_pressing() const {
  const auto found =
      std::find_if(tool_spaces.begin(), tool_spaces.end(),
                   [](const TouchToolSpace& space) { return space.setup.presses(); });
  return found != tool_spaces.end() ? &*found : nullptr;
}

TouchSpace make_empty_touch_space(const Scene& scene, const std::string& scene_hash) {
  TouchSpace space;
  space.scene_hash = scene_hash;
  space.surface = make_surface(scene.mesh);
  for (Index p = 0; p < space.surface.num_points(); ++p) {
    space.surface.points[p] = place_at_rest(scene, space.surface.mesh_points[p]);
  }
  return space;
}

}  // namespace palpate
