// SPDX-License-Identifier: BSD-3-Clause
// Draws the places at which the accuracy of a space is tested. They depend on the test set alone:
// the first ones are the same for any number of points, and serve spaces of any resolution.
#pragma once

#include <functional>
#include <vector>

#include "accuracy/surface_places.h"
#include "interaction/tool_clearance.h"
#include "state_space/test_point.h"
#include "state_space/tool_space.h"

namespace palpate {

/// The number of points of a walk. A walk begins at rest and heads for one random place of the box
/// after the other.
inline constexpr int kWalkLength = 20;
/// The distance from a point of a walk to the next, in half-widths.
inline constexpr double kWalkStep = 1.0 / 12;
/// The largest distance of the points near rest from rest, in half-widths.
inline constexpr double kNearRest = 0.01;

/// The number of anchors along an axis. A test point on no walk is reached by way of the nearest
/// anchor.
inline constexpr int kAnchors = 3;

/// The anchor of a place: the box is divided into kAnchors³ equal parts, and the anchor is the
/// centre of the part that contains the place.
[[nodiscard]] Vec3 anchor_of(const Vec3& t, double half_width);

/// The set of test points of a tool space. Each rigid tool has a set of its own, so that a file can
/// have the points of several tools.
[[nodiscard]] TestSet test_set_of(const ToolSpaceSetup& setup, std::int64_t seed);

/// Draws the test points of the set of an active node: a fifth on walks, a tenth near rest, and the
/// others anywhere.
/// @returns The points in the order of operator<, not solved yet.
[[nodiscard]] std::vector<TestPoint> draw_test_points(const TestSet& set, int num);

/// The distance from a point of a slide to the next, along the surface, in half-widths of the tool.
inline constexpr double kSlideStep = 0.1;

/// Draws test points for a rigid tool: a fifth on slides of kWalkLength points, a tenth where the
/// tool begins to touch, with the surface in the contact layer only, and the others pressed in
/// along the normal. The depth is uniform down to that of the space or, if the force limit alone
/// bounds it, to half the width of the tool. A slide starts with a press, and goes on in one
/// direction along the surface to another depth.
///
/// Each number has its place, whether this is in the space or not: a place that is left out for one
/// space is used for another. A slide ends where it leaves the space.
/// @param places, clearance Those of the body, and of the tool and the body.
/// @param holds Whether a place of the tool is in the space.
/// @returns The points in the order of operator<, not solved yet.
/// @throws InputError hardly any place, or none, is in the space.
[[nodiscard]] std::vector<TestPoint> draw_contact_points(
    const ToolSpaceSetup& setup, std::int64_t seed, int num, const SurfacePlaces& places,
    const ToolClearance& clearance, const std::function<bool(const Vec3& q)>& holds);

}  // namespace palpate
