// SPDX-License-Identifier: BSD-3-Clause
// Where a rigid tool can press, and how deep: wherever its tool space has cells.
#pragma once

#include <vector>

#include "haptic/touching/touchable.h"
#include "interpolation/tool_force.h"
#include "state_space/surface.h"

namespace palpate {

/// The coordinates of a tool that touches the surface at a place, as if the surface were flat
/// there, m.
/// @param normal The normal of the surface, outward, of unit length.
[[nodiscard]] Vec3 touching_place(const RigidTool& tool, const Vec3& place, const Vec3& normal);

/// The normals at the points of a surface, of unit length, weighted by the areas of the triangles
/// around.
[[nodiscard]] std::vector<Vec3> point_normals(const Surface& surface);

/// The points of the surface that the tool can press [surface.num_points()]: 1 where the space has
/// a cell for the tool that is a little way into the body along the normal.
/// @param force The force of the tool space.
[[nodiscard]] std::vector<char> pressable_points(const Surface& surface, const RigidTool& tool,
                                                 const ToolForce& force);

/// How far the tool can go on from a place in a direction before the space ends, at most `most`, m.
/// @param direction The direction, of unit length.
[[nodiscard]] double depth_left(const ToolForce& force, const Vec3& place, const Vec3& direction,
                                double most);

/// How deep a rigid tool is in the body at rest, m: the depth of its deepest point, along the
/// normal of the surface nearest to its place; below 0 the tool is outside.
/// @param place The tool's coordinates [3], m.
[[nodiscard]] double depth_in_body(const SurfaceTree& surface, const RigidTool& tool,
                                   const Vec3& place);

/// Where a hand may begin to touch.
struct StartPlace {
  /// The tool's place when it touches [3], m, and the outward normal of the surface there.
  Vec3 place = Vec3::Zero();
  Vec3 normal = Vec3::Zero();
  /// How far the space goes from there, m.
  double depth = 0;
};

/// The place from which to begin in a space: for a rigid tool the pressable place that is nearest
/// to the middle of all of them; for other tools the first active node.
/// @param body The body that was made of the space.
/// @param pressable The points of the surface that the rigid tool can press, as
///   pressable_points() has them.
/// @throws InputError there is no place yet that the tool can press.
[[nodiscard]] StartPlace start_place(const TouchSpace& space, const Touchable& body,
                                     const std::vector<char>& pressable);
[[nodiscard]] StartPlace start_place(const TouchSpace& space, const Touchable& body);

}  // namespace palpate
