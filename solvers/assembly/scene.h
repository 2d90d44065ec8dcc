// SPDX-License-Identifier: BSD-3-Clause
// The scene: a body, what it is made of, where it is held and where it may be touched, and what
// acts on it: its weight, pressures and tractions (external_energy.h).
//
// Under loads the body is at rest where it is deformed to by them: the equilibrium of the loads and
// of the elastic forces without a tool. All that a tool does counts from there.
#pragma once

#include <string>
#include <vector>

#include "base/types.h"
#include "materials/material.h"
#include "materials/rheology.h"
#include "mesh/tet_mesh.h"

namespace palpate {

/// A body at rest under its loads.
struct SettledBody {
  /// Displacement of every point [3 × num_points], m, and pressures of mixed cells [num_pressures],
  /// Pa.
  NodalVector u;
  NodalVector p;
};

/// The directions along which a point is held, as a plane of symmetry holds it: none, one or two,
/// orthonormal; columns without one are zero.
using HeldDirections = Eigen::Matrix<double, 3, 2>;

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
  // What follows is empty where the body has none of it. A face of the surface has what all of its
  // corners have, and in between what is linear between these.

  /// Along which u is 0 [num_points].
  std::vector<HeldDirections> held_directions;
  /// κ, N/m³, of springs that hold the surface where it is at rest [num_points].
  std::vector<double> support_stiffness;
  /// p, Pa, that pushes on the surface as it is deformed [num_points]. Only faces with the same one
  /// at all corners have it.
  std::vector<double> applied_pressure;
  /// t, Pa: force in the direction of t on the area at rest [num_points].
  std::vector<Vec3> applied_traction;
  /// g, m/s²; zero: there is none.
  Vec3 body_force = Vec3::Zero();
  /// ρ of each material, kg/m³; empty where there is no body force.
  std::vector<double> densities;
  /// Follows from the rest: see EquilibriumSolver::settled(). Empty where there is no load, and
  /// where it was not found yet.
  SettledBody settled;

  [[nodiscard]] bool has_body_force() const { return !body_force.isZero(0); }
  /// Something deforms the body without a tool.
  [[nodiscard]] bool has_load() const {
    return has_body_force() || !applied_pressure.empty() || !applied_traction.empty();
  }
  /// Something besides fixed points holds it.
  [[nodiscard]] bool has_supports() const {
    return !held_directions.empty() || !support_stiffness.empty();
  }
  /// There is more than fixed points and a body force.
  [[nodiscard]] bool has_supports_or_surface_loads() const {
    return has_supports() || !applied_pressure.empty() || !applied_traction.empty();
  }
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

/// Checks the mesh (and orients its cells), the sizes of the arrays, that the body is held, and its
/// loads. Directions become orthonormal, and arrays of zeros empty.
/// @throws InputError says what is wrong, where, and what to do.
void check(Scene& scene);

/// 128-bit hash (XXH3, hexadecimal) of mesh, materials, boundary and, where there are any, body
/// force and densities, supports and loads: two scenes with the same hash have the same equilibria.
/// `touchable` takes no part: it changes no equilibrium. `settled` follows from the rest.
[[nodiscard]] std::string hash(const Scene& scene);

}  // namespace palpate
