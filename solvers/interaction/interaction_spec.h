// SPDX-License-Identifier: BSD-3-Clause
// What a tool is, in numbers that can be stored, and the tool that is made of them.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <tuple>

#include "assembly/scene.h"
#include "interaction/bonded_patch.h"
#include "interaction/interaction.h"

namespace palpate {

/// The kinds of tools. The numbers are stored: keep them.
enum class InteractionKind : std::int32_t {
  bonded_patch = 0,
};

/// What a tool is, and what of the body it acts on.
struct InteractionSpec {
  InteractionKind kind = InteractionKind::bonded_patch;
  /// The material point of the surface that the tool is bonded to: its position at rest [3], m, and
  /// the point of the mesh that is there.
  Vec3 material_point = Vec3::Zero();
  Index active_node = 0;
  /// The points of the surface patch within this distance of the material point move with it, m; 0:
  /// the one of the mesh alone.
  double tip_radius = 0;

  [[nodiscard]] friend bool operator==(const InteractionSpec& a, const InteractionSpec& b) {
    return std::tie(a.kind, a.active_node, a.tip_radius) ==
               std::tie(b.kind, b.active_node, b.tip_radius) &&
           a.material_point == b.material_point;
  }
};

/// The spec of a tool that is bonded to the patch around a node of a scene, which is there.
[[nodiscard]] InteractionSpec bonded_patch_spec(const Scene& scene, Index node, double tip_radius);

/// Makes the tools of one scene, which it copies.
class InteractionFactory {
 public:
  explicit InteractionFactory(Scene scene) : scene_(std::move(scene)) {}

  /// @throws InputError a place where the tool cannot be, see BondedPatches::around().
  [[nodiscard]] std::unique_ptr<Interaction> make(const InteractionSpec& spec);

 private:
  Scene scene_;
  /// By radius.
  std::map<double, BondedPatches> bonded_patches_;
};

}  // namespace palpate
