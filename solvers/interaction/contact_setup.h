// SPDX-License-Identifier: BSD-3-Clause
// What contact with a body needs to know of it: how stiff its surface is, and from where a tool can
// come to a place.
#pragma once

#include "assembly/scene.h"
#include "interaction/rigid_contact.h"
#include "mesh/surface_tree.h"

namespace palpate {

/// Young's modulus at small strain of the cells under the touchable surface, the mean by area, Pa;
/// of the whole free surface where no face is touchable.
[[nodiscard]] double mean_youngs_modulus(const Scene& scene);

/// Finds ways for one tool to places at a body.
class ContactApproach {
 public:
  /// @throws InputError the tool is larger than the body.
  ContactApproach(const Scene& scene, RigidContact contact);

  /// The nearest place from which a tool comes to a place straight along the normal of the surface,
  /// and where it does not touch the body at rest yet, m. It is the place itself where it does not
  /// touch there.
  /// @throws InputError there is none: the place is not finite, or that way leads through another
  ///   part of the body.
  [[nodiscard]] Vec3 start_for(const Vec3& place) const;

 private:
  [[nodiscard]] bool is_free(const Vec3& place) const;

  RigidContact contact_;
  SurfaceTree tree_;
  NodalVector at_rest_;
  double thickness_;
};

}  // namespace palpate
