// SPDX-License-Identifier: BSD-3-Clause
// State spaces without any solving: a cube of tetrahedra and displacement fields from formulas.
#pragma once

#include <cmath>
#include <map>
#include <utility>

#include "assembly/pressures.h"
#include "assembly/scene.h"
#include "state_space/state_space.h"

namespace palpate::test {

/// The cube [0, 0.1 m]³ of n³ smaller ones with six tetrahedra each.
inline TetMesh cube_mesh(int n, ElementOrder order) {
  TetMesh mesh;
  mesh.order = order;
  const auto point = [n](int x, int y, int z) { return (x * (n + 1) + y) * (n + 1) + z; };
  for (int x = 0; x <= n; ++x) {
    for (int y = 0; y <= n; ++y) {
      for (int z = 0; z <= n; ++z) mesh.points.push_back(0.1 / n * Vec3(x, y, z));
    }
  }
  std::map<std::pair<Index, Index>, Index> midsides;
  const auto midside = [&](Index a, Index b) {
    const auto [at, added] =
        midsides.emplace(std::minmax(a, b), static_cast<Index>(mesh.points.size()));
    if (added) mesh.points.push_back(0.5 * (mesh.points[a] + mesh.points[b]));
    return at->second;
  };
  constexpr int kPaths[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  for (int cube = 0; cube < n * n * n; ++cube) {
    for (const auto& path : kPaths) {
      int p[3] = {cube / (n * n), cube / n % n, cube % n};
      std::array<Index, 4> corner{point(p[0], p[1], p[2])};
      for (int step = 0; step < 3; ++step) {
        ++p[path[step]];
        corner[step + 1] = point(p[0], p[1], p[2]);
      }
      mesh.cells.insert(mesh.cells.end(), corner.begin(), corner.end());
      if (order == ElementOrder::linear) continue;
      for (const auto& e : kTetEdges) mesh.cells.push_back(midside(corner[e[0]], corner[e[1]]));
    }
  }
  check_and_orient(mesh);
  return mesh;
}

inline Scene cube_scene(int n = 2, ElementOrder order = ElementOrder::quadratic) {
  Scene scene;
  scene.body.mesh = cube_mesh(n, order);
  // One of them has pressures.
  scene.organ.materials = {
      with_formulation(make_isotropic(Law::st_venant_kirchhoff, 2000, 0.4), Formulation::mixed),
      make_isotropic(Law::neo_hookean, 1000, 0.3)};
  for (Index c = 0; c < scene.body.mesh.num_cells(); ++c)
    scene.body.material_of_cell.push_back(c % 2);
  for (const Vec3& p : scene.body.mesh.points) {
    scene.body.fixed.push_back(p.z() == 0 ? 1 : 0);
    scene.body.touchable.push_back(p.z() == 0.1 ? 1 : 0);
  }
  check(scene);
  return scene;
}

/// Gives a configuration pressures, of which no two are alike, and their derivatives.
inline void add_pressures(const Scene& scene, Configuration& c) {
  const Index count = count_pressures(scene);
  c.p = Eigen::VectorXd::LinSpaced(count, -1, 1);
  c.p_v = Eigen::VectorXd::LinSpaced(3 * count, -5, 7).reshaped(count, 3);
}

/// Numbers that fill every member; the field bends and bulges with t, so that its rank is small but
/// not that of a linear body.
inline Configuration example_configuration(const Scene& scene, const ToolSpaceSetup& setup,
                                           const CheckPoint& check_point) {
  Configuration c;
  c.check_point = check_point;
  for (int a = 0; a < 3; ++a) {
    c.t[a] = setup.grid.spacing() * check_point[a];
    c.parent[a] = check_point[a] - (check_point[a] > 0) + (check_point[a] < 0);
  }
  c.energy = 50 * c.t.squaredNorm();
  c.force = 100 * c.t;
  c.stiffness = 100 * Mat3::Identity();
  c.outcome = Outcome::converged;
  c.residual = 1.0 / 3e9;
  c.minimum_det_f = 1 - c.t.norm();
  c.iterations = 4;
  c.seconds = 0.0225;
  const Vec3& centre = scene.body.mesh.points[setup.interaction.active_node];
  const Index n = scene.body.mesh.num_points();
  c.u.resize(3 * n);
  c.v.resize(3 * n, 3);
  for (Index p = 0; p < n; ++p) {
    const Vec3& x = scene.body.mesh.points[p];
    // u = w(t) t + 40 z (t·t) d with w = z/0.1 exp(−(|x − c|² + 0.02 d·t)/0.003), d = x − c.
    const Vec3 d = x - centre;
    const double w = x.z() / 0.1 * std::exp(-(d.squaredNorm() + 0.02 * d.dot(c.t)) / 0.003);
    const double bulge = 40 * x.z() * c.t.squaredNorm();
    c.u.segment<3>(3 * p) = w * c.t + bulge * d;
    c.v.block<3, 3>(3 * p, 0) = w * Mat3::Identity() - 0.02 / 0.003 * w * c.t * d.transpose() +
                                80 * x.z() * d * c.t.transpose();
  }
  return c;
}

/// A third derivative as a configuration at t may have it: no two components are alike.
inline ThirdDerivative example_third_derivative(const Vec3& t) {
  return ThirdDerivative::LinSpaced(-100, 80) * (1 + t.sum());
}

/// So many states on the straight way to a configuration.
inline std::vector<IntermediateState> example_way(const ConfigurationSummary& target, int count) {
  std::vector<IntermediateState> way;
  for (int number = 1; number <= count; ++number) {
    IntermediateState& state = way.emplace_back();
    state.target = target.check_point;
    state.number = number;
    state.t = target.t * number / (count + 1);
    state.energy = 50 * state.t.squaredNorm();
    state.force = 100 * state.t;
    state.outcome = Outcome::converged;
    state.flags = flags::inertia_not_computed;
    state.seconds = 0.01 * number;
  }
  return way;
}

inline ToolSpaceSetup example_setup(Index active_node = 8, std::int32_t resolution = 5) {
  ToolSpaceSetup setup;
  setup.id = active_node;
  setup.interaction.active_node = active_node;
  setup.grid.half_width = 0.012;
  setup.grid.resolution = resolution;
  setup.policy.force_limit = 3;
  setup.interaction.tip_radius = 0.125;
  return setup;
}

template <class F>
void for_each_check_point(const ToolSpaceSetup& setup, F&& f) {
  const std::int32_t r = setup.grid.reach();
  for (std::int32_t i = -r; i <= r; ++i) {
    for (std::int32_t j = -r; j <= r; ++j) {
      for (std::int32_t k = -r; k <= r; ++k) f(CheckPoint{i, j, k});
    }
  }
}

inline StateSpace example_space(const Scene& scene, const std::vector<ToolSpaceSetup>& setups) {
  StateSpace space;
  space.bodies = {make_space_body(scene)};
  space.solver_tolerance = 1e-8;
  for (const ToolSpaceSetup& setup : setups) {
    ToolSpace& added = space.tool_spaces.emplace_back();
    added.setup = setup;
    for_each_check_point(setup, [&](const CheckPoint& c) {
      added.configurations.push_back(example_configuration(scene, setup, c));
    });
  }
  sort(space);
  return space;
}

}  // namespace palpate::test
