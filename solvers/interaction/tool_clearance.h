// SPDX-License-Identifier: BSD-3-Clause
// Where a rigid tool is clear of a body at rest, how deep it is in it elsewhere, and the way out.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "assembly/scene.h"
#include "interaction/contact_surface.h"
#include "interaction/rigid_contact.h"
#include "mesh/box_tree.h"
#include "mesh/surface_tree.h"

namespace palpate {

class ToolClearance {
 public:
  /// @param scene With its body at rest, where it has a body force. @param contact With its body.
  /// @throws InputError the tool is larger than the body.
  ToolClearance(const Scene& scene, const RigidContact& contact);

  /// How far the tool at q may be moved in any direction without touching the body at rest, at the
  /// least, m: as far as nothing is in its layer of contact. Not positive: it may touch it.
  [[nodiscard]] double clearance(const Vec3& q) const;

  struct Approach {
    /// How far the tool is in the body at rest, along the way out, without its layer, m; negative
    /// where it is clear of it.
    double depth = 0;
    /// The way out, of unit length: the normal of the surface where the tool is deepest.
    Vec3 out = Vec3::UnitZ();
    /// The place of the surface at rest that is left last on that way, m.
    Vec3 touched = Vec3::Zero();
    /// The points of the mesh around that place.
    std::array<Index, 3> around{};
  };
  [[nodiscard]] Approach approach(const Vec3& q) const;
  /// The place of the tool at which it is so deep in a surface that is flat around a point of it,
  /// m: what approach() says, but where the body is curved.
  /// @param normal Of the surface, outward, of unit length. @param depth m; negative: clear of it.
  [[nodiscard]] Vec3 pressed(const Vec3& point, const Vec3& normal, double depth) const;

  /// The nearest place on the way out from which the tool comes to q, and where it does not touch
  /// the body at rest yet, m. It is q itself where the tool does not touch there.
  /// @throws InputError there is none: the place is not finite, or that way leads through another
  ///   part of the body.
  [[nodiscard]] Vec3 start_for(const Vec3& q) const;
  /// The same, and nothing where there is none.
  [[nodiscard]] std::optional<Vec3> find_start(const Vec3& q) const;

  /// The box in which the tool touches the body at rest, m.
  [[nodiscard]] Eigen::AlignedBox3d bounds() const;

 private:
  RigidShapePtr shape_;
  /// The reach of the layer of contact and twice the error of the shape, m: what the shape
  /// gives for two places differs by no more than their distance and that.
  double margin_;
  SurfaceTree body_;
  std::vector<RigidShape::Ball> balls_;
  /// The points at which contact is integrated, in the order of the tree.
  std::vector<Vec3> points_;
  BoxTree tree_;
};

}  // namespace palpate
