// SPDX-License-Identifier: BSD-3-Clause
// Checks that a surface of triangles can be that of a tool: it bounds one piece.
#pragma once

#include <array>
#include <vector>

#include "base/types.h"

namespace palpate {

/// Checks that each edge belongs to two triangles and that all triangles are connected, and turns
/// them so that they look outward.
/// @param points Positions [num_points], m.
/// @param triangles Indices into `points`.
/// @throws InputError a check fails, a point is not finite, or a triangle has no area (less than
///   1e-12 of the square of its longest edge). The message names the first such point, triangle or
///   edge, and how many there are.
void check_and_orient_tool(const std::vector<Vec3>& points,
                           std::vector<std::array<Index, 3>>& triangles);

}  // namespace palpate
