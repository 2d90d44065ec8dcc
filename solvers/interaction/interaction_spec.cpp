// SPDX-License-Identifier: BSD-3-Clause
#include "interaction/interaction_spec.h"

#include "base/error.h"

namespace palpate {

InteractionSpec bonded_patch_spec(const Scene& scene, Index node, double tip_radius) {
  InteractionSpec spec;
  spec.material_point = scene.mesh.points[node];
  spec.active_node = node;
  spec.tip_radius = tip_radius;
  return spec;
}

std::unique_ptr<Interaction> InteractionFactory::make(const InteractionSpec& spec) {
  switch (spec.kind) {
    case InteractionKind::bonded_patch:
      return bonded_patches_.try_emplace(spec.tip_radius, scene_, spec.tip_radius)
          .first->second.around(spec.active_node)
          .clone();
  }
  throw InputError("A tool of an unknown kind, " + std::to_string(static_cast<int>(spec.kind)) +
                   ", cannot be made.");
}

}  // namespace palpate
