// SPDX-License-Identifier: BSD-3-Clause
// A scene is an organ with one of its bodies. Equilibria are computed for scenes.
//
// Under loads (external_energy.h), the body at rest is deformed: rest is the equilibrium of the
// loads and the elastic forces without a tool. Whatever a tool does is counted from there.
#pragma once

#include <string>
#include <vector>

#include "assembly/body.h"
#include "assembly/organ.h"
#include "materials/rheology.h"

namespace palpate {

struct Scene {
  Organ organ;
  Body body;

  /// Whether the body is deformed without a tool.
  [[nodiscard]] bool has_load() const { return organ.has_body_force() || body.has_surface_loads(); }
  /// Whether the body has surfaces that touch each other.
  [[nodiscard]] bool has_contact() const {
    return organ.touching == TouchingParts::lips ? body.cut.stage > 0
                                                 : organ.touching != TouchingParts::none;
  }
  [[nodiscard]] const Material& material_of(Index cell) const {
    return organ.materials[body.material_of(cell)];
  }
};

/// Returns the scene under gravity, m/s², without checking it.
/// @param rheologies One for each material; their densities are used.
/// @param gravity Zero: the scene is returned as it is.
[[nodiscard]] Scene with_gravity(Scene scene, const std::vector<Rheology>& rheologies,
                                 const Vec3& gravity);

/// Checks the mesh (and orients its cells), the sizes of the arrays, that the body is held, its
/// loads, and the contact of its parts. Directions become orthonormal, and arrays of zeros empty.
/// @throws InputError says what is wrong, where, and what to do.
void check(Scene& scene);

/// 128-bit hash (XXH3, hexadecimal) of mesh, materials and boundary, and of body force, densities,
/// supports, loads and contact of parts if there are any: two scenes with the same hash have the
/// same equilibria. `touchable` changes no equilibrium, so it is not part of the hash.
[[nodiscard]] std::string hash(const Scene& scene);

}  // namespace palpate
