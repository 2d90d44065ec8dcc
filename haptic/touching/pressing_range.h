// SPDX-License-Identifier: BSD-3-Clause
// Where a rigid tool can press, and how deep: as far as its space has cells.
#pragma once

#include <vector>

#include "haptic/touching/touchable.h"
#include "interpolation/interpolator.h"
#include "state_space/surface.h"

namespace palpate {

/// Where the centre of a tool is that touches a place of the surface, as if that were flat there,
/// m.
/// @param normal Of the surface, outward, of unit length.
[[nodiscard]] Vec3 touching_place(const RigidTool& tool, const Vec3& place, const Vec3& normal);

/// The normals at the points of a surface, of unit length, by the areas of the triangles around.
[[nodiscard]] std::vector<Vec3> point_normals(const Surface& surface);

/// Which points of the surface the tool can press: 1 where the space has a cell when the tool has
/// come a little into the body along the normal [surface.num_points()].
/// @param force That of the space.
[[nodiscard]] std::vector<char> pressable_points(const Surface& surface, const RigidTool& tool,
                                                 const Interpolator& force);

/// How far the tool can go on from a place in a direction before the space ends, at most `most`, m.
/// @param direction Of unit length.
[[nodiscard]] double depth_left(const Interpolator& force, const Vec3& place, const Vec3& direction,
                                double most);

/// How far the space of a tool goes from where it touches nothing, m: the half-width of a bonded
/// tool's, and how deep a rigid one presses.
[[nodiscard]] double depth_of(const ToolSpaceSetup& setup);

/// Where a hand may begin to touch.
/// How deep a rigid tool is in the body at rest [m]: that of the point of it that is farthest down,
/// along the normal of the surface nearest to its centre; below 0 it is outside.
/// @param place Of its centre [3], m.
[[nodiscard]] double depth_in_body(const SurfaceTree& surface, const RigidTool& tool,
                                   const Vec3& place);

struct StartPlace {
  /// Of the tool when it touches [3], m, and the normal of the surface there, outward.
  Vec3 place = Vec3::Zero();
  Vec3 normal = Vec3::Zero();
  /// How far the space goes from there, m.
  double depth = 0;
};

/// The place of a space for a rigid tool that is nearest to the middle of all that it can press;
/// of another one its first active node.
/// @param body That of the space.
/// @throws InputError there is no place yet that the tool can press.
[[nodiscard]] StartPlace start_place(const TouchSpace& space, const Touchable& body);

}  // namespace palpate
