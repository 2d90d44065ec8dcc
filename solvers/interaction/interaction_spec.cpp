// SPDX-License-Identifier: BSD-3-Clause
#include "interaction/interaction_spec.h"

#include <utility>

#include "base/error.h"

namespace palpate {

InteractionSpec bonded_patch_spec(const Scene& scene, Index node, double tip_radius) {
  InteractionSpec spec;
  spec.material_point = place_at_rest(scene, node);
  spec.active_node = node;
  spec.tip_radius = tip_radius;
  return spec;
}

InteractionSpec rigid_contact_spec(RigidTool tool) {
  InteractionSpec spec;
  spec.kind = InteractionKind::rigid_contact;
  spec.active_node = -1;
  spec.tool = std::move(tool);
  return spec;
}

std::unique_ptr<Interaction> InteractionFactory::make(const InteractionSpec& spec) {
  switch (spec.kind) {
    case InteractionKind::bonded_patch:
      return bonded_patches_.try_emplace(spec.tip_radius, scene_, spec.tip_radius)
          .first->second.around(spec.active_node)
          .clone();
    case InteractionKind::rigid_contact: return rigid(spec).contact.clone();
  }
  throw InputError("A tool of an unknown kind, " + std::to_string(static_cast<int>(spec.kind)) +
                   ", cannot be made.");
}

InteractionFactory::Rigid& InteractionFactory::rigid(const InteractionSpec& spec) {
  if (!rigid_ || !(rigid_->tool == spec.tool)) {
    rigid_.emplace(Rigid{spec.tool, make_contact(scene_, spec.tool), nullptr});
  }
  return *rigid_;
}

std::shared_ptr<const ToolClearance> InteractionFactory::clearance(const InteractionSpec& spec) {
  Rigid& of = rigid(spec);
  if (of.clearance == nullptr) {
    of.clearance = std::make_shared<const ToolClearance>(scene_, of.contact);
  }
  return of.clearance;
}

}  // namespace palpate
