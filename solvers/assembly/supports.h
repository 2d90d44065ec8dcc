// SPDX-License-Identifier: BSD-3-Clause
// What holds a body besides fixed points, and what acts on its surface: whether they make sense.
#pragma once

#include "assembly/scene.h"

namespace palpate {

/// I − Σ n nᵀ: what is left of a displacement of a point that is held along these directions.
[[nodiscard]] inline Mat3 projector(const HeldDirections& held) {
  return Mat3::Identity() - held * held.transpose();
}

/// Holds a point along one more direction; three that are independent fix it.
/// @param fixed Of the point, as in Scene. @param direction Of any length but 0.
void hold_along(const Vec3& direction, HeldDirections& held, char& fixed);

/// The points that hold their pieces, as PieceSupport takes them [num_points]: those that are
/// fixed, and all of the pieces with other supports, which check() has found to be held.
/// @param scene It was checked.
[[nodiscard]] std::vector<char> holding_points(const Scene& scene);

/// Checks the supports, and of each connected piece with supports besides fixed points, that they
/// hold it against every rigid motion. Directions become orthonormal, those of fixed points none,
/// and arrays of zeros empty.
/// @param scene The sizes of `fixed` and of what comes before it were checked.
/// @throws InputError says what is wrong, where, and what to do.
void check_supports(Scene& scene);

/// Checks pressures and tractions. The rim of a surface under pressure may not move, or slides in a
/// plane: there alone has the pressure an energy, so that its tangent is symmetric. Arrays of zeros
/// become empty.
/// @param scene Its supports were checked.
/// @throws InputError says what is wrong, where, and what to do.
void check_surface_loads(Scene& scene);

}  // namespace palpate
