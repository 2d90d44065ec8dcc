// SPDX-License-Identifier: BSD-3-Clause
// Where the accuracy of a space is tested: places that depend on the test set alone, so that the
// first ones are the same however many there are, and serve spaces of any resolution.
#pragma once

#include <vector>

#include "state_space/test_point.h"

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

/// Draws the test points of a set: a fifth on walks, a tenth near rest, the others anywhere.
/// @returns The points in the order of operator<. They are not solved.
[[nodiscard]] std::vector<TestPoint> draw_test_points(const TestSet& set, int num);

}  // namespace palpate
