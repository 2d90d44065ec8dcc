// SPDX-License-Identifier: BSD-3-Clause
#include "interaction/interaction_spec.h"

#include <utility>

#include "interaction/tool_kind.h"

namespace palpate {

InteractionSpec bonded_patch_spec(const TetMesh& mesh, const SettledBody& at_rest, Index node,
                                  double tip_radius) {
  InteractionSpec spec;
  spec.material_point = place_at_rest(mesh, at_rest, node);
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

std::string InteractionSpec::name() const { return tool_kind(kind).name(*this); }
bool InteractionSpec::presses() const { return tool_kind(kind).presses(); }
double InteractionSpec::touching_radius() const { return tool_kind(kind).touching_radius(*this); }
RigidTool InteractionSpec::shown_shape() const { return tool_kind(kind).shown_shape(*this); }

std::unique_ptr<Interaction> InteractionFactory::make(const InteractionSpec& spec) {
  return tool_kind(spec.kind).make(spec, *this);
}

std::shared_ptr<const ToolClearance> InteractionFactory::clearance(const InteractionSpec& spec) {
  return tool_kind(spec.kind).clearance(spec, *this);
}

const BondedPatches& InteractionFactory::patches(double radius) {
  return bonded_patches_.try_emplace(radius, body_, radius).first->second;
}

InteractionFactory::Rigid& InteractionFactory::rigid(const RigidTool& tool) {
  if (rigid_ && rigid_->tool == tool) return *rigid_;
  RigidTool moved = rigid_ ? rigid_->tool : tool;
  moved.motion = tool.motion;
  moved.motion_numbers = tool.motion_numbers;
  if (rigid_ && moved == tool) {
    const RigidContact& other = rigid_->contact;
    const PoseMapPtr pose = pose_of(tool);
    const auto clearance = rigid_->clearance;
    rigid_.emplace(Rigid{
        tool, RigidContact(other.surface_ptr(), other.shape_ptr(), other.law(), pose),
        clearance == nullptr ? nullptr : std::make_shared<const ToolClearance>(*clearance, pose)});
  } else {
    rigid_.emplace(Rigid{tool, make_contact(body_, tool), nullptr});
  }
  return *rigid_;
}

std::shared_ptr<const ToolClearance> InteractionFactory::clearance_of(const RigidTool& tool) {
  Rigid& of = rigid(tool);
  if (of.clearance == nullptr) {
    of.clearance = std::make_shared<const ToolClearance>(body_, at_rest_, of.contact);
  }
  return of.clearance;
}

}  // namespace palpate
