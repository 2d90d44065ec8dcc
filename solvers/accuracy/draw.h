// SPDX-License-Identifier: BSD-3-Clause
// Where the accuracy of a space is tested: places that depend on the test set alone, so that the
// first ones are the same however many there are, and serve spaces of any resolution.
#pragma once

#include <vector>

#include "state_space/test_point.h"

namespace palpate {

/// Points of one walk: it begins at rest, heads for a random place of the box, then for the next.
inline constexpr int kWalkLength = 20;
/// From one to the next, in half-widths.
inline constexpr double kWalkStep = 1.0 / 12;
/// How far from rest the points near rest are at most, in half-widths.
inline constexpr double kNearRest = 0.01;

/// Anchors along an axis: test points anywhere in the box are reached by way of the nearest one.
inline constexpr int kAnchors = 3;

/// The middle of that of kAnchors³ equal parts of the box that a place lies in.
[[nodiscard]] Vec3 anchor_of(const Vec3& t, double half_width);

/// @param num Of which a fifth are on walks, a tenth are near rest, and the others anywhere.
/// @returns Not solved, in the order of operator<.
[[nodiscard]] std::vector<TestPoint> draw_test_points(const TestSet& set, int num);

}  // namespace palpate
