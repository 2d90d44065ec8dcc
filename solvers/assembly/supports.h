// SPDX-License-Identifier: BSD-3-Clause
// The supports of a body besides its fixed points, and the loads on its surface: what they are at a
// point, and whether they make sense.
#pragma once

#include <vector>

#include "assembly/scene.h"

namespace palpate {

/// I − Σ n nᵀ: projects a displacement to that of a point that is held along these directions.
[[nodiscard]] inline Mat3 projector(const HeldDirections& held) {
  return Mat3::Identity() - held * held.transpose();
}

/// Holds a point along one more direction; three independent directions fix it.
/// @param direction A vector of any length but 0.
/// @param fixed The entry of the point in Body::fixed.
void hold_along(const Vec3& direction, HeldDirections& held, char& fixed);

/// What holds a point: the projection on the directions along which it cannot move.
[[nodiscard]] Mat3 held_space(const Body& body, Index point);

/// The directions that all of these points are held along, almost: columns, the rest is zero.
[[nodiscard]] Mat3 common_directions(const Body& body, const std::vector<Index>& points);

/// The points that hold their pieces, for PieceSupport [num_points]: the fixed ones, and all points
/// of pieces with other supports, which check() has found to be held.
/// @param body A body that check() accepts.
[[nodiscard]] std::vector<char> holding_points(const Body& body);

/// Checks the supports, and that each connected piece with supports besides fixed points is held
/// against every rigid motion. Directions become orthonormal, those of fixed points are removed,
/// and arrays of zeros become empty.
/// @param body The sizes of `fixed` and of the members before it are valid.
/// @throws InputError says what is wrong, where, and what to do.
void check_supports(Body& body);

/// Checks pressures and tractions. The rim of a surface under pressure must not move, or must slide
/// in a plane: only then does the pressure have an energy and a symmetric tangent. Arrays of zeros
/// become empty.
/// @param body Its supports are valid.
/// @throws InputError says what is wrong, where, and what to do.
void check_surface_loads(Body& body);

}  // namespace palpate
