// SPDX-License-Identifier: BSD-3-Clause
// What holds a body besides fixed points, and what acts on its surface: whether they make sense.
#pragma once

#include "assembly/scene.h"

namespace palpate {

/// I − Σ n nᵀ: what is left of a displacement of a point that is held along these directions.
[[nodiscard]] inline Mat3 projector(const HeldDirections& held) {
  return Mat3::Identity() - held * held.transpose();
}

/// The points that hold their pieces, as `fixed` in Scene: with other supports all, as check() has
/// found every piece to be held.
[[nodiscard]] inline std::vector<char> holding_points(const Scene& scene) {
  return scene.has_supports() ? std::vector<char>(scene.mesh.points.size(), 1) : scene.fixed;
}

/// Checks the supports, and where there are any besides fixed points, that they hold each connected
/// piece of the body against every rigid motion. Directions become orthonormal, those of fixed
/// points none, and arrays of zeros empty.
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
