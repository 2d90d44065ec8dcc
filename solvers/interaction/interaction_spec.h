// SPDX-License-Identifier: BSD-3-Clause
// What a tool is, in numbers that can be stored, and the tool that is made of them.
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

/// The kinds of tools. The numbers are stored: keep them.
enum class InteractionKind : std::int32_t {
  bonded_patch = 0,
  rigid_contact = 1,
};

/// What a tool is, and what of the body it acts on.
struct InteractionSpec {
  InteractionKind kind = InteractionKind::bonded_patch;
  /// Of a bonded patch: the material point of the surface that the tool is bonded to: its position
  /// at rest [3], m, and the point of the mesh that is there.
  Vec3 material_point = Vec3::Zero();
  Index active_node = 0;
  /// The points of the surface patch within this distance of the material point move with it, m; 0:
  /// the one of the mesh alone.
  double tip_radius = 0;
  /// Of a rigid contact: the tool.
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

/// The spec of a tool that is bonded to the patch around a node of a scene, which is there.
[[nodiscard]] InteractionSpec bonded_patch_spec(const Scene& scene, Index node, double tip_radius);

/// The spec of a rigid tool that presses the body anywhere, and whose coordinates are the place of
/// its centre.
[[nodiscard]] InteractionSpec rigid_contact_spec(RigidTool tool);

/// Makes the tools of one scene, which it copies.
class InteractionFactory {
 public:
  explicit InteractionFactory(Scene scene) : scene_(std::move(scene)) {}

  /// @throws InputError a place where the tool cannot be, see BondedPatches::around(), or a
  ///   rigid tool that is none, see make_contact().
  [[nodiscard]] std::unique_ptr<Interaction> make(const InteractionSpec& spec);
  /// Where a tool is clear of the body; null: it acts wherever it is.
  /// @throws InputError a rigid tool that is none.
  [[nodiscard]] std::shared_ptr<const ToolClearance> clearance(const InteractionSpec& spec);

  /// What the kinds of tools make theirs of. It is made once.
  [[nodiscard]] const BondedPatches& patches(double radius);
  [[nodiscard]] const RigidContact& contact(const RigidTool& tool) { return rigid(tool).contact; }
  [[nodiscard]] std::shared_ptr<const ToolClearance> clearance_of(const RigidTool& tool);

 private:
  /// What was made of a rigid tool last: its distance and the points of its contact take time.
  struct Rigid {
    RigidTool tool;
    RigidContact contact;
    std::shared_ptr<const ToolClearance> clearance;
  };
  Rigid& rigid(const RigidTool& tool);

  Scene scene_;
  std::optional<Rigid> rigid_;
  /// By radius.
  std::map<double, BondedPatches> bonded_patches_;
};

}  // namespace palpate
