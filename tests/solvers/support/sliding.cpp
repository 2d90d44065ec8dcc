// SPDX-License-Identifier: BSD-3-Clause
#include "solvers/support/sliding.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "base/error.h"
#include "equilibrium/equilibrium.h"
#include "interaction/rigid_tool.h"
#include "solvers/support/block.h"
#include "solvers/support/bodies.h"
#include "solvers/support/random.h"

namespace palpate::test {
namespace {

constexpr double kYoungsModulus = 5000;
constexpr double kPoissonsRatio = 0.4;
constexpr double kRadius = 0.01;
constexpr double kDepth = 0.004;
/// Of the block, m.
constexpr double kWidth = 0.16;
constexpr double kHeight = 0.08;
/// Squares are of one size so far from the middle of the top, m; then their sides double.
constexpr double kEven = 0.02;
/// Of two triangles that make a square the mean edge is longer than its side by this.
constexpr double kMeanEdge = (2 + M_SQRT2) / 3;
/// Corners lie off a regular mesh by up to this share of a side of a square.
constexpr double kIrregular = 0.2;

/// Distances from 0 to `size`.
std::vector<double> graded(double side, double size) {
  std::vector<double> at{0};
  while (at.back() < kEven - side / 2) at.push_back(at.back() + side);
  for (double next = 2 * side; at.back() + 1.5 * next < size; next *= 2) {
    at.push_back(at.back() + next);
  }
  at.push_back(size);
  return at;
}

/// Shares of a size, from 0 to 1, that are the same to both sides of the middle.
std::vector<double> to_both_sides(const std::vector<double>& distances) {
  std::vector<double> shares;
  for (auto d = distances.rbegin(); d != distances.rend(); ++d) {
    shares.push_back(0.5 - 0.5 * *d / distances.back());
  }
  for (std::size_t i = 1; i < distances.size(); ++i) {
    shares.push_back(0.5 + 0.5 * distances[i] / distances.back());
  }
  return shares;
}

/// A block around the z axis under the plane z = 0, of an irregular mesh, held at its bottom.
Scene make_irregular_block(const SlidingOptions& options) {
  const double side = options.edge / kMeanEdge;
  const std::vector<double> across = to_both_sides(graded(side, kWidth / 2));
  std::vector<double> up;
  const std::vector<double> down = graded(side, kHeight);
  for (auto d = down.rbegin(); d != down.rend(); ++d) up.push_back(1 - *d / kHeight);
  const Vec3 size(kWidth, kWidth, kHeight);
  TetMesh mesh = make_graded_box(ElementOrder::quadratic, {across, across, up}, size);
  Random random(static_cast<std::uint64_t>(options.seed));
  warp_straight(mesh, [&](const Vec3& p) {
    Vec3 moved = p;
    for (int i = 0; i < 3; ++i) {
      const double by = random.uniform(-kIrregular, kIrregular) * side;
      if (p[i] > 1e-9 && p[i] < size[i] - 1e-9) moved[i] += by;
    }
    return Vec3(moved - Vec3(kWidth / 2, kWidth / 2, kHeight));
  });
  std::vector<char> fixed;
  for (const Vec3& p : mesh.points) fixed.push_back(p.z() < -0.999 * kHeight ? 1 : 0);
  return make_scene(std::move(mesh),
                    make_isotropic(Law::neo_hookean, kYoungsModulus, kPoissonsRatio), fixed);
}

}  // namespace

SlidingResult slide(const SlidingOptions& options) {
  const Scene scene = make_irregular_block(options);
  EquilibriumSolver solver(scene, {});
  RigidTool tool;
  tool.radius = kRadius;
  tool.law.thickness = options.thickness;
  const RigidContact contact = make_contact(scene.body, with_defaults(tool, scene));
  solver.set_interaction(contact);
  const auto solve = [&](const Vec3& place, const Equilibrium& from) {
    Equilibrium state = solver.solve(place, from);
    if (state.outcome != Outcome::converged)
      throw InputError("The sliding sphere: " + state.summary.message);
    return state;
  };
  const Vec3 step = kSlidingStep * Vec3(0.8, 0.6, 0);
  Vec3 place = Vec3(0, 0, kRadius - kDepth) - options.steps / 2.0 * step;

  SlidingResult result;
  result.num_unknowns = solver.assembly().pattern().size;
  const double above = kDepth + 1.01 * contact.law().reach();
  Equilibrium state = solve(place, solver.rest(place + above * Vec3::UnitZ()));
  std::vector<Vec3> forces{state.reaction};
  for (int i = 0; i < options.steps; ++i) {
    place += step;
    Equilibrium next = solve(place, state);
    result.stiffness_jump = std::max(
        result.stiffness_jump, (next.stiffness - state.stiffness).norm() / state.stiffness.norm());
    forces.push_back(next.reaction);
    state = std::move(next);
  }
  for (std::size_t i = 0; i < forces.size(); ++i) {
    const Vec3& force = forces[i];
    result.lateral = std::max(result.lateral, force.head<2>().norm() / std::abs(force.z()));
    if (i == 0 || i + 1 == forces.size()) continue;
    const Vec3 off = force - (forces[i - 1] + forces[i + 1]) / 2;
    result.roughness = std::max(result.roughness, off.norm() / force.norm());
  }
  return result;
}

}  // namespace palpate::test
