// SPDX-License-Identifier: BSD-3-Clause
// The meaning of the numbers of a stored tool (rigid_tool.h), for each kind of shape. A kind makes
// the shape. It also answers the questions of panels and plans without making the shape, since the
// distance to a surface takes long to compute.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "interaction/rigid_shape.h"
#include "interaction/rigid_tool.h"

namespace palpate {

class ShapeKind {
 public:
  virtual ~ShapeKind() = default;
  ShapeKind(const ShapeKind&) = delete;
  ShapeKind& operator=(const ShapeKind&) = delete;

  /// The number under which the kind is stored.
  [[nodiscard]] virtual ToolShape number() const = 0;
  /// Half of the tool's least width, m.
  [[nodiscard]] virtual double half_width(const RigidTool& tool) const = 0;
  /// How far the tool reaches from its centre in a direction of unit length, m.
  [[nodiscard]] virtual double reach(const RigidTool& tool, const Vec3& direction) const = 0;
  /// The least thickness of the layer of contact for which the shape can be made, m; 0: any.
  [[nodiscard]] virtual double least_thickness(const RigidTool& /*tool*/) const { return 0; }
  /// Whether the user gives the half-width as a property (ToolRadius).
  [[nodiscard]] virtual bool has_radius() const { return true; }
  /// The name of a tool, for a message: "the sphere of radius 0.01 m".
  [[nodiscard]] virtual std::string name(const RigidTool& tool) const = 0;
  /// @throws InputError the numbers are not those of such a shape.
  [[nodiscard]] virtual RigidShapePtr make(const RigidTool& tool) const = 0;

 protected:
  ShapeKind() = default;
};

/// The kind with a number; null: there is none, as with a number from a damaged file.
[[nodiscard]] const ShapeKind* find_shape_kind(ToolShape number);
/// @throws InputError there is no kind with this number.
[[nodiscard]] const ShapeKind& shape_kind(ToolShape number);

/// Adds a kind for as long as the program runs. Call this before any tool of the kind is made.
/// @throws InputError its number is taken.
void add_shape_kind(std::unique_ptr<const ShapeKind> kind);

/// The kinds that are always there.
[[nodiscard]] std::unique_ptr<const ShapeKind> sphere_kind();
[[nodiscard]] std::unique_ptr<const ShapeKind> capsule_kind();
[[nodiscard]] std::unique_ptr<const ShapeKind> surface_kind();

}  // namespace palpate
