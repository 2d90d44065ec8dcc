// SPDX-License-Identifier: BSD-3-Clause
// Parts of symmetric bodies between their planes of symmetry: halves, and sectors of a tube and of
// a hollow sphere under a pressure from inside, and what neo-Hookean incompressible ones do by
// their closed forms.
#pragma once

#include <cmath>

#include "assembly/supports.h"
#include "solvers/support/block.h"
#include "solvers/support/box_mesh.h"
#include "solvers/support/laws.h"

namespace palpate::test {

/// Radii at rest, m, pressure from inside and Young's modulus, Pa.
struct Shell {
  double inner = 0.003;
  double outer = 0.004;
  double pressure = 15998.7;
  double youngs_modulus = 3e5;
};

/// A mesh with its mirror image in x = 0; its points come first, and `twin` is that of each on the
/// other side.
inline TetMesh with_mirror_image(const TetMesh& half, std::vector<Index>& twin) {
  TetMesh mesh = half;
  twin.clear();
  for (const Vec3& p : half.points) {
    twin.push_back(p.x() == 0 ? static_cast<Index>(twin.size()) : mesh.num_points());
    if (p.x() != 0) mesh.points.emplace_back(-p.x(), p.y(), p.z());
  }
  // These are left-handed, until check() has turned them round.
  for (const Index p : half.cells) mesh.cells.push_back(twin[p]);
  return mesh;
}

inline void hold_plane(Scene& scene, const Vec3& normal, double offset) {
  scene.body.held_directions.resize(scene.body.mesh.points.size(), HeldDirections::Zero());
  for (Index p = 0; p < scene.body.mesh.num_points(); ++p) {
    if (std::abs(normal.dot(scene.body.mesh.points[p]) - offset) > 1e-12) continue;
    hold_along(normal, scene.body.held_directions[p], scene.body.fixed[p]);
  }
}

inline Scene make_sector(TetMesh mesh, const Shell& shell, const std::vector<char>& inside) {
  Scene scene = make_scene(
      std::move(mesh), make_material(Law::neo_hookean_incompressible, shell.youngs_modulus, 0.5),
      std::vector<char>(inside.size(), 0));
  for (const char is_inside : inside) {
    scene.body.applied_pressure.push_back(is_inside != 0 ? shell.pressure : 0);
  }
  return scene;
}

/// A quarter of a tube along z, whose ends keep their distance.
inline Scene make_tube(const Shell& shell, std::array<int, 3> cells) {
  constexpr double kLength = 0.001;
  TetMesh mesh = make_box(ElementOrder::quadratic, cells, Vec3(1, 1, 1));
  std::vector<char> inside;
  for (const Vec3& p : mesh.points) inside.push_back(p.x() == 0 ? 1 : 0);
  warp_curved(mesh, [&](const Vec3& p) -> Vec3 {
    const double r = shell.inner + (shell.outer - shell.inner) * p.x();
    const double angle = p.y() * std::acos(-1.0) / 2;
    return {r * std::cos(angle), r * std::sin(angle), kLength * p.z()};
  });
  Scene scene = make_sector(std::move(mesh), shell, inside);
  hold_plane(scene, Vec3::UnitX(), 0);
  hold_plane(scene, Vec3::UnitY(), 0);
  hold_plane(scene, Vec3::UnitZ(), 0);
  hold_plane(scene, Vec3::UnitZ(), kLength);
  return scene;
}

/// The 24th part of a hollow sphere, between y = 0, z = 0, x = y and x = z.
inline Scene make_sphere_sector(const Shell& shell, std::array<int, 3> cells) {
  TetMesh mesh = make_box(ElementOrder::quadratic, cells, Vec3(1, 1, 1));
  std::vector<char> inside;
  for (const Vec3& p : mesh.points) inside.push_back(p.x() == 0 ? 1 : 0);
  warp_curved(mesh, [&](const Vec3& p) -> Vec3 {
    const double r = shell.inner + (shell.outer - shell.inner) * p.x();
    const double quarter = std::acos(-1.0) / 4;
    return r * Vec3(1, std::tan(quarter * p.y()), std::tan(quarter * p.z())).normalized();
  });
  Scene scene = make_sector(std::move(mesh), shell, inside);
  hold_plane(scene, Vec3::UnitY(), 0);
  hold_plane(scene, Vec3::UnitZ(), 0);
  hold_plane(scene, Vec3(1, -1, 0).normalized(), 0);
  hold_plane(scene, Vec3(1, 0, -1).normalized(), 0);
  return scene;
}

/// The inner radius, m, at which the pressure that a shell bears is its own: with λ = r/R and the
/// volume of material inside R kept, p = μ ∫ n (λ² − λ^(−2n)) dr / r from inside out, n = 1 of a
/// tube (Rivlin 1949), 2 of a sphere (Green and Shield 1950). By Simpson's rule and bisection.
inline double inflated_radius(const Shell& shell, int n) {
  const double mu = shell.youngs_modulus / 3;
  const auto pressure_at = [&](double a) {
    const double grown = std::pow(a, n + 1) - std::pow(shell.inner, n + 1);
    const double b = std::pow(std::pow(shell.outer, n + 1) + grown, 1.0 / (n + 1));
    constexpr int kIntervals = 400;
    double sum = 0;
    for (int i = 0; i <= kIntervals; ++i) {
      const double r = a + (b - a) * i / kIntervals;
      const double stretch = r / std::pow(std::pow(r, n + 1) - grown, 1.0 / (n + 1));
      const double weight = i == 0 || i == kIntervals ? 1 : i % 2 == 1 ? 4 : 2;
      sum += weight * n * (stretch * stretch - std::pow(stretch, -2.0 * n)) / r;
    }
    return mu * sum * (b - a) / (3 * kIntervals);
  };
  double low = shell.inner;
  double high = 1.5 * shell.inner;
  while (high - low > 1e-15) {
    const double middle = (low + high) / 2;
    (pressure_at(middle) < shell.pressure ? low : high) = middle;
  }
  return low;
}

}  // namespace palpate::test
