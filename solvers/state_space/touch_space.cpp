// SPDX-License-Identifier: BSD-3-Clause
#include "state_space/touch_space.h"

#include <algorithm>
#include <map>
#include <memory>
#include <optional>

#include "interaction/tool_clearance.h"
#include "state_space/shown_surface.h"

namespace palpate {

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

const TouchToolSpace* TouchSpace::find(const ToolSpaceKey& key) const {
  const auto found = std::lower_bound(
      tool_spaces.begin(), tool_spaces.end(), key,
      [](const TouchToolSpace& space, const ToolSpaceKey& of) { return space.setup.key() < of; });
  return found != tool_spaces.end() && found->setup.key() == key ? &*found : nullptr;
}

std::vector<const TouchToolSpace*> TouchSpace::list_pressing() const {
  std::vector<const TouchToolSpace*> of_regions;
  std::vector<const TouchToolSpace*> found;
  for (const TouchToolSpace& space : tool_spaces) {
    if (!space.setup.presses() || space.setup.turns()) continue;
    if (!space.setup.region) return {&space};
    of_regions.push_back(&space);
    if (!space.configurations.empty()) found.push_back(&space);
  }
  return found.empty() ? of_regions : found;
}

std::vector<const TouchToolSpace*> TouchSpace::list_turned() const {
  std::vector<const TouchToolSpace*> turned;
  for (const TouchToolSpace& space : tool_spaces) {
    if (space.setup.turns()) turned.push_back(&space);
  }
  return turned;
}

std::vector<double> TouchSpace::areas_of_stages() const {
  std::vector<double> areas;
  for (const StageOfCut& stage : stages) areas.push_back(stage.area);
  return areas;
}

std::vector<const TouchToolSpace*> TouchSpace::find_stages(ToolSpaceId id) const {
  std::vector<const TouchToolSpace*> found;
  for (const StageOfCut& stage : stages) {
    found.push_back(find({id, stage.body}));
    if (found.back() == nullptr) return {};
  }
  return found;
}

const TouchToolSpace* TouchSpace::find_pressing() const {
  const std::vector<const TouchToolSpace*> all = list_pressing();
  return all.empty() ? nullptr : all.front();
}

bool TouchSpace::has_other_bodies() const {
  return std::any_of(tool_spaces.begin(), tool_spaces.end(),
                     [](const TouchToolSpace& space) { return space.setup.body != kFirstBody; });
}

void add_clearances(const std::vector<SpaceBody>& bodies, TouchSpace& space) {
  // The tool spaces of a body follow each other, and its tools share what takes time to make.
  std::optional<InteractionFactory> tools;
  BodyId of = kFirstBody;
  for (TouchToolSpace& tool_space : space.tool_spaces) {
    const ToolSpaceSetup& setup = tool_space.setup;
    if (!setup.presses()) continue;
    if (!tools || of != setup.body) {
      of = setup.body;
      const SpaceBody& body = find_body(bodies, of);
      tools.emplace(body.scene->body, body.at_rest);
    }
    add_clearance(tools->clearance(setup.interaction), tool_space);
  }
}

TouchSpace make_empty_touch_space(const ShownSurface& shown) {
  TouchSpace space;
  std::vector<std::string> hashes;
  for (const SpaceBody& body : shown.bodies()) hashes.push_back(body.hash);
  space.scene_hash = join_hashes(hashes);
  space.surface = shown.surface();
  std::map<std::int32_t, StageOfCut> stages;
  for (const SpaceBody& body : shown.bodies()) {
    const Cut& cut = body.scene->body.cut;
    if (!cut.faces.empty()) stages.try_emplace(cut.stage, StageOfCut{body.number, cut.area()});
  }
  if (stages.size() > 1) {
    for (const auto& [number, stage] : stages) space.stages.push_back(stage);
  }
  return space;
}

}  // namespace palpate
