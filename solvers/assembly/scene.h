// SPDX-License-Identifier: BSD-3-Clause
// The scene: a body, what it is made of, where it is held and where it may be touched, and a force
// that acts on all of it, such as gravity.
//
// Under a body force g the body is at rest where it sags to: the equilibrium of ∫ ρ g N_a dV and of
// the elastic forces without a tool. All that a tool does counts from there.
#pragma once

#include <string>
#include <vector>

#include "base/types.h"
#include "materials/material.h"
#include "materials/rheology.h"
#include "mesh/tet_mesh.h"

namespace palpate {

/// A body at rest under its body force.
struct SettledBody {
  /// Displacement of every point [3 × num_points], m, and pressures of mixed cells [num_pressures],
  /// Pa.
  NodalVector u;
  NodalVector p;
};

struct Scene {
  TetMesh mesh;
  /// The different materials of the body; at least one.
  std::vector<Material> materials;
  /// Index into `materials` [num_cells]; empty where the body is of materials[0] throughout.
  std::vector<Index> material_of_cell;
  /// 1 where u = 0 [num_points].
  std::vector<char> fixed;
  /// 1 where the body may be touched [num_points].
  std::vector<char> touchable;
  /// g, m/s²; zero: there is none.
  Vec3 body_force = Vec3::Zero();
  /// ρ of each material, kg/m³; empty where there is no body force.
  std::vector<double> densities;
  /// Follows from the rest: see EquilibriumSolver::settled(). Empty where there is no body force,
  /// and where it was not found yet.
  SettledBody settled;

  [[nodiscard]] bool has_body_force() const { return !body_force.isZero(0); }
};

/// The scene under gravity, m/s², not checked.
/// @param rheologies Of each material: their densities count. @param gravity Zero: it stays as it
/// is.
[[nodiscard]] Scene with_gravity(Scene scene, const std::vector<Rheology>& rheologies,
                                 const Vec3& gravity);

/// Where the points are at rest: those of the mesh, displaced to where the body settles
/// [num_points], m.
[[nodiscard]] std::vector<Vec3> points_at_rest(const Scene& scene);
[[nodiscard]] Vec3 place_at_rest(const Scene& scene, Index point);

/// Checks the mesh (and orients its cells), the sizes of the arrays, that some point is fixed, and
/// the body force.
/// @throws InputError says what is wrong, where, and what to do.
void check(Scene& scene);

/// 128-bit hash (XXH3, hexadecimal) of mesh, materials, boundary and, where there is one, body
/// force and densities: two scenes with the same hash have the same equilibria. `touchable` takes
/// no part: it changes no equilibrium. `settled` follows from the rest.
[[nodiscard]] std::string hash(const Scene& scene);

}  // namespace palpate
