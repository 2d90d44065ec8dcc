// SPDX-License-Identifier: BSD-3-Clause
// Tells where a rigid tool is clear of a body at rest, and elsewhere how deep it is in the body and
// which way leads out. The tool at a place q is turned as PoseMap::coordinates() says.
//
// The depth of a tool follows from those of its places that are deepest in the body. For a tool
// that is larger than the body, such as a plate on which the body lies, it also follows from the
// body's places that are deepest in the tool. Both are lower bounds of the way that the tool must
// go to be clear, and the larger one counts. The way out of such a large tool is the shortest of
// several, since a deep place of a plate may be nearer to the side of the body.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "assembly/body.h"
#include "interaction/contact_surface.h"
#include "interaction/rigid_contact.h"
#include "mesh/box_tree.h"
#include "mesh/surface_tree.h"

namespace palpate {

class ToolClearance {
 public:
  /// @param at_rest The body at rest under its loads.
  /// @param contact The contact of the tool with this body.
  /// @throws InputError how far the points of the tool move is not known, see PoseMap::stretch().
  ToolClearance(const Body& body, const SettledBody& at_rest, const RigidContact& contact);

  /// That of the same tool in another motion.
  /// @throws InputError as above.
  ToolClearance(const ToolClearance& other, PoseMapPtr pose);

  /// A distance, m, by which the tool at q may be moved in any direction without touching the body
  /// at rest: nothing is in its layer of contact then. Not positive: the tool may touch the body.
  [[nodiscard]] double clearance(const Vec3& q) const;
  /// Whether the motion of the tool leads to q.
  [[nodiscard]] bool allows(const Vec3& q) const { return pose_->allows(pose_->coordinates(q)); }
  /// The farthest way of a point of the tool as that moves from q by no more than `way`, m.
  [[nodiscard]] double farthest_way(const Vec3& q, double way) const;
  /// Whether the middle of the tool at q, or of a part of it, is in the body at rest. If the tool
  /// has no force there, it has gone through the surface.
  [[nodiscard]] bool is_inside(const Vec3& q) const;

  struct Approach {
    /// The depth of the tool in the body at rest along the way out, without its layer, m; negative
    /// where the tool is clear of the body.
    double depth = 0;
    /// The way out, of unit length: the normal of the surface where the tool is deepest.
    Vec3 out = Vec3::UnitZ();
    /// The place of the surface at rest that the tool leaves last on that way, m.
    Vec3 touched = Vec3::Zero();
    /// The points of the mesh around that place.
    std::array<Index, 3> around{};
  };
  [[nodiscard]] Approach approach(const Vec3& q) const;
  /// The coordinates of the tool at which it has a depth in a surface that is flat around a point,
  /// m. It is the inverse of approach(), except where the body is curved.
  /// @param normal The outward normal of the surface, of unit length.
  /// @param depth The depth, m; negative: the tool is clear of the surface.
  [[nodiscard]] Vec3 pressed(const Vec3& point, const Vec3& normal, double depth) const;

  /// The nearest place on the way out at which the tool does not touch the body at rest, m. It is
  /// where the tool comes from to reach q, and q itself if the tool does not touch there.
  /// @throws InputError there is no such place: q is not finite, or the way leads through another
  ///   part of the body.
  [[nodiscard]] Vec3 start_for(const Vec3& q) const;
  /// Does the same, and returns nothing where there is no such place.
  [[nodiscard]] std::optional<Vec3> find_start(const Vec3& q) const;

  /// The box in which the tool touches the body at rest, m.
  [[nodiscard]] Eigen::AlignedBox3d bounds() const;
  /// The box around the body at rest, m.
  [[nodiscard]] Eigen::AlignedBox3d body_bounds() const { return of_->body.bounds(); }
  /// Whether the tool is larger than the body.
  [[nodiscard]] bool is_large() const { return of_->is_large; }

 private:
  [[nodiscard]] Pose pose_at(const Vec3& q) const { return pose_->at(pose_->coordinates(q)); }
  [[nodiscard]] PoseMap::Stretch stretch_at(const Vec3& q) const {
    return pose_->stretch(pose_->coordinates(q), shape_->bounds());
  }
  /// The place of the body at rest that is deepest in the tool, or nearest to it.
  struct Deepest {
    /// The signed distance to the tool, m.
    double gap = 0;
    /// An index into Parts::points; −1: none is within reach.
    Index place = -1;
  };
  [[nodiscard]] Deepest deepest_of_body(const Pose& pose) const;
  /// Takes the places of the body that lie in the tool into account.
  void deepen(const Pose& pose, Approach& approach) const;
  /// The distance that the tool must go in a direction until it touches nothing, m; nothing: it is
  /// too far.
  [[nodiscard]] std::optional<double> way_out(const Vec3& q, const Vec3& direction) const;
  /// Whether a face that may be pressed looks in a direction.
  [[nodiscard]] bool has_face_towards(const Vec3& direction) const;
  /// Directions in which a large tool may be clear of the body soon.
  [[nodiscard]] std::vector<Vec3> directions_out(const Vec3& q) const;

  /// The signed distance to the tool of a place, m, and its gradient.
  [[nodiscard]] double gap(const Vec3& place, const Pose& pose) const {
    return shape_->value(pose.in_tool(place));
  }
  [[nodiscard]] Vec3 gap_gradient(const Vec3& place, const Pose& pose) const {
    return pose.rotation * shape_->evaluate(pose.in_tool(place), 1).gradient;
  }

  /// What does not depend on the motion.
  struct Parts {
    std::shared_ptr<const ContactSurface> surface;
    /// The reach of the layer of contact plus twice the error of the shape, m. The values of the
    /// shape at two places differ by no more than their distance plus twice that error.
    double margin = 0;
    SurfaceTree body;
    /// The balls of the shape, in its own axes.
    std::vector<RigidShape::Ball> balls;
    /// Whether the tool is larger than the body.
    bool is_large = false;
    /// The points at which contact is integrated, in the order of the tree.
    std::vector<Vec3> points;
    BoxTree tree;
  };

  RigidShapePtr shape_;
  PoseMapPtr pose_;
  std::shared_ptr<const Parts> of_;
};

}  // namespace palpate
