// SPDX-License-Identifier: BSD-3-Clause
// Where the accuracy of a space is tested: places that depend on the test set alone, so that the
// first ones are the same however many there are, and serve spaces of any resolution.
#pragma once

#include <functional>
#include <vector>

#include "accuracy/surface_places.h"
#include "interaction/tool_clearance.h"
#include "state_space/test_point.h"
#include "state_space/tool_space.h"

namespace palpate {

/// The number of points of a walk, which begins at rest, heads for a random place of the box, and
/// from there for the next.
inline constexpr int kWalkLength = 20;
/// The distance from a point of a walk to the next, in half-widths.
inline constexpr double kWalkStep = 1.0 / 12;
/// The largest distance of the points near rest from rest, in half-widths.
inline constexpr double kNearRest = 0.01;

/// The number of anchors along an axis. A test point that is on no walk is reached by way of the
/// nearest anchor.
inline constexpr int kAnchors = 3;

/// The anchor of a place: the box has kAnchors³ equal parts, and the anchor is the middle of the
/// one that the place lies in.
[[nodiscard]] Vec3 anchor_of(const Vec3& t, double half_width);

/// The set of the test points of a tool space. That of a rigid tool has a number of its own for
/// each tool, so that a file may have the points of several.
[[nodiscard]] TestSet test_set_of(const ToolSpaceSetup& setup, std::int64_t seed);

/// Draws the test points of the set of an active node: a fifth on walks, a tenth near rest, the
/// others anywhere.
/// @returns The points in the order of operator<. They are not solved.
[[nodiscard]] std::vector<TestPoint> draw_test_points(const TestSet& set, int num);

/// The distance from a point of a slide to the next, along the surface, in half-widths of the tool.
inline constexpr double kSlideStep = 0.1;

/// Draws test points for a rigid tool: a fifth on slides of kWalkLength points, a tenth where the
/// tool begins to touch, with the surface in the layer of contact alone, the others pressed in
/// along the normal. The depth is anywhere down to that of the space, or where the force limit
/// alone bounds it, to half the width of the tool. A slide goes on from a press in one direction
/// along the surface, to another depth.
///
/// Each number has its place, whether that is in the space or not: what is left out for one space
/// is there for another one. A slide ends where it leaves the space.
/// @param places, clearance Of the body, and of the tool and the body.
/// @param holds Whether a place of the tool is in the space.
/// @returns The points in the order of operator<. They are not solved.
/// @throws InputError hardly any place, or none, is in the space.
[[nodiscard]] std::vector<TestPoint> draw_contact_points(
    const ToolSpaceSetup& setup, std::int64_t seed, int num, const SurfacePlaces& places,
    const ToolClearance& clearance, const std::function<bool(const Vec3& q)>& holds);

}  // namespace palpate
