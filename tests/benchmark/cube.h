// SPDX-License-Identifier: BSD-3-Clause
// The body of benchmarks of growth: a cube of Tet10, neo-Hookean, held at its bottom, a patch of
// its top that moves as one.
#pragma once

#include <cmath>
#include <utility>
#include <vector>

#include "exploration/precompute_options.h"
#include "interaction/bonded_patch.h"
#include "solvers/support/box_mesh.h"

namespace palpate::benchmarks {

inline constexpr double kEdge = 0.1;  // m
inline constexpr double kPatch = 0.2 * kEdge;

/// @param bricks Along an edge.
inline int num_unknowns(int bricks) {
  const int points = 2 * bricks + 1;
  return 3 * points * points * (points - 1);
}

inline Scene make_cube(int bricks, double nu) {
  Scene scene;
  scene.body.mesh =
      test::make_box(ElementOrder::quadratic, {bricks, bricks, bricks}, Vec3::Constant(kEdge));
  for (const Vec3& p : scene.body.mesh.points) scene.body.fixed.push_back(p.z() == 0 ? 1 : 0);
  scene.body.touchable.assign(scene.body.fixed.size(), 1);
  scene.organ.materials = {
      with_formulation(make_isotropic(Law::neo_hookean, 10e3, nu), Formulation::displacement)};
  return scene;
}

/// Middle of the top, m.
inline Vec3 top_of_cube() { return {kEdge / 2, kEdge / 2, kEdge}; }

inline BondedPatch bond_patch(const TetMesh& mesh) {
  std::vector<Index> points;
  for (Index p = 0; p < mesh.num_points(); ++p) {
    const Vec3& x = mesh.points[p];
    if (std::abs(x.z() - kEdge) < 1e-9 && (x - top_of_cube()).norm() <= kPatch) {
      points.push_back(p);
    }
  }
  return BondedPatch(std::move(points));
}

/// A space of that patch.
inline PrecomputeOptions space_of_patch(const TetMesh& mesh, double half_width, int resolution) {
  PrecomputeOptions options;
  for (Index p = 0; p < mesh.num_points(); ++p) {
    if ((mesh.points[p] - top_of_cube()).norm() < 1e-9) options.active_nodes = {p};
  }
  options.tip_radius = kPatch;
  options.half_width = half_width;
  options.resolution = resolution;
  return options;
}

}  // namespace palpate::benchmarks
