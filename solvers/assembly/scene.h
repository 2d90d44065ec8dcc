// SPDX-License-Identifier: BSD-3-Clause
// The scene: a body, its materials, where it is held and may be touched, and its loads: weight,
// pressures and tractions (external_energy.h).
//
// Under loads, the body at rest is deformed: rest is the equilibrium of the loads and the elastic
// forces without a tool. All that a tool does counts from there.
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
  /// Index into `materials` [num_cells]; empty: the whole body has materials[0].
  std::vector<Index> material_of_cell;
  /// 1 for each point whose displacement is 0 [num_points].
  std::vector<char> fixed;
  /// 1 for each point that may be touched [num_points].
  std::vector<char> touchable;
  // The following are empty if the body has none. A face of the surface has what all of its corners
  // have, with linear values in between.

  /// Directions along which the displacement is 0 [num_points].
  std::vector<HeldDirections> held_directions;
  /// κ, N/m³, of springs that hold the surface at its place at rest [num_points].
  std::vector<double> support_stiffness;
  /// p, Pa, which pushes on the deformed surface [num_points]. It acts only on faces that have the
  /// same p at all corners.
  std::vector<double> applied_pressure;
  /// t, Pa: a force in the direction of t on the area at rest [num_points].
  std::vector<Vec3> applied_traction;
  /// g, m/s²; zero: there is none.
  Vec3 body_force = Vec3::Zero();
  /// ρ of each material, kg/m³; empty if there is no body force.
  std::vector<double> densities;
  /// The body at rest, which follows from the other members: see EquilibriumSolver::settled().
  /// Empty if there is no load, or if it was not computed yet.
  SettledBody settled;

  [[nodiscard]] bool has_body_force() const { return !body_force.isZero(0); }
  /// Whether the body is deformed without a tool.
  [[nodiscard]] bool has_load() const {
    return has_body_force() || !applied_pressure.empty() || !applied_traction.empty();
  }
  /// Whether the body is held by more than fixed points.
  [[nodiscard]] bool has_supports() const {
    return !held_directions.empty() || !support_stiffness.empty();
  }
  /// Whether there is more than fixed points and a body force.
  [[nodiscard]] bool has_supports_or_surface_loads() const {
    return has_supports() || !applied_pressure.empty() || !applied_traction.empty();
  }
};

/// The scene under gravity, m/s², not checked.
/// @param rheologies One for each material; their densities are used.
/// @param gravity Zero: the scene is returned as it is.
[[nodiscard]] Scene with_gravity(Scene scene, const std::vector<Rheology>& rheologies,
                                 const Vec3& gravity);

/// The places of the points at rest: those of the mesh, displaced by the loads [num_points], m.
[[nodiscard]] std::vector<Vec3> points_at_rest(const Scene& scene);
[[nodiscard]] Vec3 place_at_rest(const Scene& scene, Index point);

/// Checks the mesh (and orients its cells), the sizes of the arrays, that the body is held, and its
/// loads. Directions become orthonormal, and arrays of zeros empty.
/// @throws InputError says what is wrong, where, and what to do.
void check(Scene& scene);

/// 128-bit hash (XXH3, hexadecimal) of mesh, materials and boundary, and of body force, densities,
/// supports and loads if there are any: two scenes with the same hash have the same equilibria.
/// `touchable` changes no equilibrium, and `settled` follows from the other members, so neither is
/// part of the hash.
[[nodiscard]] std::string hash(const Scene& scene);

}  // namespace palpate
