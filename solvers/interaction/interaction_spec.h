// SPDX-License-Identifier: BSD-3-Clause
// Describes a tool in numbers that can be stored, and makes the tool from them.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <tuple>

#include "assembly/scene.h"
#include "interaction/bonded_patch.h"
#include "interaction/interaction.h"
#include "interaction/rigid_tool.h"
#include "interaction/tool_clearance.h"

namespace palpate {

/// The kinds of tools. The numbers are stored in files: do not change them.
enum class InteractionKind : std::int32_t {
  bonded_patch = 0,
  rigid_contact = 1,
};

/// What a tool is, and which part of the body it acts on.
struct InteractionSpec {
  InteractionKind kind = InteractionKind::bonded_patch;
  /// For a bonded patch: the material point of the surface that the tool is bonded to, as its
  /// position at rest [3], m, and as the point of the mesh at that position.
  Vec3 material_point = Vec3::Zero();
  Index active_node = 0;
  /// The points of the surface patch within this distance of the material point move with it, m; 0:
  /// the point of the mesh alone.
  double tip_radius = 0;
  /// For a rigid contact: the tool.
  RigidTool tool;

  /// See tool_kind.h.
  [[nodiscard]] std::string name() const;
  [[nodiscard]] bool presses() const;
  [[nodiscard]] double touching_radius() const;
  [[nodiscard]] RigidTool shown_shape() const;

  [[nodiscard]] friend bool operator==(const InteractionSpec& a, const InteractionSpec& b) {
    return std::tie(a.kind, a.active_node, a.tip_radius, a.tool) ==
               std::tie(b.kind, b.active_node, b.tip_radius, b.tool) &&
           a.material_point == b.material_point;
  }
};

/// The spec of a tool that is bonded to the patch around a node of a mesh. The node must exist.
/// @param at_rest The body at rest under its loads.
[[nodiscard]] InteractionSpec bonded_patch_spec(const TetMesh& mesh, const SettledBody& at_rest,
                                                Index node, double tip_radius);

/// The spec of a rigid tool that presses the body anywhere, and whose coordinates are the place of
/// its centre.
[[nodiscard]] InteractionSpec rigid_contact_spec(RigidTool tool);

/// Makes the tools of one body, which it copies.
class InteractionFactory {
 public:
  /// @param at_rest The body at rest under its loads.
  InteractionFactory(Body body, SettledBody at_rest)
      : body_(std::move(body)), at_rest_(std::move(at_rest)) {}

  /// @throws InputError the tool cannot be at its place, see BondedPatches::around(), or the rigid
  ///   tool is not valid, see make_contact().
  [[nodiscard]] std::unique_ptr<Interaction> make(const InteractionSpec& spec);
  /// The clearance of a tool; null: the tool acts wherever it is.
  /// @throws InputError the rigid tool is not valid.
  [[nodiscard]] std::shared_ptr<const ToolClearance> clearance(const InteractionSpec& spec);

  /// The patches and contacts from which the kinds make their tools. Each is made once.
  [[nodiscard]] const BondedPatches& patches(double radius);
  [[nodiscard]] const RigidContact& contact(const RigidTool& tool) { return rigid(tool).contact; }
  [[nodiscard]] std::shared_ptr<const ToolClearance> clearance_of(const RigidTool& tool);

 private:
  /// The parts of the rigid tool that was made last. They are kept, since its distance and the
  /// points of its contact take time to make, and serve the same tool in another motion too.
  struct Rigid {
    RigidTool tool;
    RigidContact contact;
    std::shared_ptr<const ToolClearance> clearance;
  };
  Rigid& rigid(const RigidTool& tool);

  Body body_;
  SettledBody at_rest_;
  std::optional<Rigid> rigid_;
  /// The patches that were made, by radius.
  std::map<double, BondedPatches> bonded_patches_;
};

}  // namespace palpate
