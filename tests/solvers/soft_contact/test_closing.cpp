// SPDX-License-Identifier: BSD-3-Clause
// Surfaces that touch themselves: the lips of a slit, and a ring that is pressed flat.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <vector>

#include "equilibrium/equilibrium.h"
#include "interaction/contact_surface.h"
#include "interaction/rigid_capsule.h"
#include "interaction/rigid_contact.h"
#include "materials/material.h"
#include "soft_contact/soft_contact.h"
#include "solvers/support/block.h"
#include "solvers/support/bodies.h"
#include "solvers/support/box_mesh.h"

namespace palpate::test::test_closing {
namespace {

constexpr double kYoungsModulus = 5000;
constexpr double kEdge = 0.005;
const Vec3 kSize(0.04, 0.04, 0.02);

/// Opens a mesh along a sheet between its cells.
/// @param opens Of the points on the sheet, those at which it opens: not those of its front.
/// @param is_beyond Whether a place is on the one side of the sheet.
void cut(TetMesh& mesh, const std::function<bool(const Vec3&)>& opens,
         const std::function<bool(const Vec3&)>& is_beyond) {
  std::map<Index, Index> twin;
  const Index num_points = mesh.num_points();
  for (Index p = 0; p < num_points; ++p) {
    if (!opens(mesh.points[p])) continue;
    twin[p] = mesh.num_points();
    mesh.points.push_back(Vec3(mesh.points[p]));
  }
  ASSERT_FALSE(twin.empty());
  const int nodes = nodes_per_cell(mesh.order);
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    Index* cell = &mesh.cells[static_cast<std::size_t>(c) * static_cast<std::size_t>(nodes)];
    Vec3 middle = Vec3::Zero();
    for (int a = 0; a < 4; ++a) middle += 0.25 * mesh.points[cell[a]];
    if (!is_beyond(middle)) continue;
    for (int a = 0; a < nodes; ++a) {
      const auto found = twin.find(cell[a]);
      if (found != twin.end()) cell[a] = found->second;
    }
  }
}

Scene scene_of(TetMesh mesh, TouchingParts touching, double thickness = 0.06 * kEdge) {
  std::vector<char> fixed;
  for (const Vec3& x : mesh.points) fixed.push_back(x.z() == 0 ? 1 : 0);
  Scene scene =
      make_scene(std::move(mesh), make_isotropic(Law::neo_hookean, kYoungsModulus, 0.4), fixed);
  scene.organ.touching = touching;
  scene.organ.contact = {thickness, 10 * kYoungsModulus, 0};
  return scene;
}

TetMesh block() { return make_box(ElementOrder::quadratic, {8, 8, 4}, kSize); }

/// Forces, N.
struct Pressed {
  double force = 0;
  /// What of it is told as the layer's.
  double of_layer = 0;
};

/// A ball that presses the middle of a block by 2.5 mm.
Pressed press(const Scene& scene) {
  constexpr double kRadius = 0.01;
  constexpr double kThickness = 0.0005;
  EquilibriumOptions options;
  EquilibriumSolver solver(scene, options);
  solver.set_interaction(
      RigidContact(std::make_shared<const ContactSurface>(scene.body, 0.5 * kThickness),
                   make_sphere(kRadius), {kThickness, 2 * kYoungsModulus}));
  const Vec3 clear(0.02, 0.02, kSize.z() + kRadius + 1.1 * kThickness);
  Equilibrium state = solver.rest(clear);
  for (const double depth : {0.0005, 0.0015, 0.0025}) {
    state = solver.solve(Vec3(clear.x(), clear.y(), kSize.z() + kRadius - depth), state);
    EXPECT_EQ(state.outcome, Outcome::converged) << state.summary.message;
    EXPECT_EQ(state.negative_pivots, 0);
  }
  Pressed pressed{-state.reaction[2], 0};
  if (const auto contact = make_soft_contact(scene)) {
    pressed.of_layer = -contact->layer_force(state.u, state.v)[2];
  }
  return pressed;
}

TEST(Closing, AnUprightSlitIsAsStiffAsTheBodyWithoutIt) {
  TetMesh slit = block();
  cut(
      slit,
      [](const Vec3& x) {
        return std::abs(x.x() - 0.02) < 1e-9 && std::abs(x.y() - 0.02) < 0.0149 && x.z() > 0.0101;
      },
      [](const Vec3& x) { return x.x() > 0.02; });
  const double uncut = press(scene_of(block(), TouchingParts::none)).force;
  EXPECT_LT(press(scene_of(slit, TouchingParts::none)).force, 0.97 * uncut);
  EXPECT_NEAR(press(scene_of(slit, TouchingParts::all)).force, uncut, 0.005 * uncut);
}

// Without friction, its lips slide by what is 2 % of the force.
TEST(Closing, ALevelSlitIsNearlyAsStiff) {
  constexpr double kHalfWidth = 0.0075;
  TetMesh slit = block();
  cut(
      slit,
      [](const Vec3& x) {
        return std::abs(x.z() - 0.015) < 1e-9 && std::abs(x.x() - 0.02) < kHalfWidth - 1e-4 &&
               std::abs(x.y() - 0.02) < kHalfWidth - 1e-4;
      },
      [](const Vec3& x) { return x.z() > 0.015; });
  const double uncut = press(scene_of(block(), TouchingParts::none)).force;
  EXPECT_LT(press(scene_of(slit, TouchingParts::none)).force, 0.6 * uncut);
  const Pressed closed = press(scene_of(slit, TouchingParts::all));
  EXPECT_NEAR(closed.force, uncut, 0.06 * uncut);
  const Pressed thin = press(scene_of(slit, TouchingParts::all, 0.02 * kEdge));
  EXPECT_LT(std::abs(thin.of_layer), 0.5 * std::abs(closed.of_layer));
  EXPECT_NEAR(closed.force - closed.of_layer, thin.force - thin.of_layer, 0.005 * uncut);
}

/// A ring in the plane y = 0, from straight edges.
TetMesh ring(double inside, double thickness, double width, int around) {
  TetMesh box = make_box(ElementOrder::linear, {around, 2, 2}, Vec3(1, 1, 1));
  TetMesh ring;
  std::vector<Index> point_of;
  for (std::size_t p = 0; p < box.points.size(); ++p) {
    const Vec3& x = box.points[p];
    if (x.x() == 1) {
      point_of.push_back(point_of[p - static_cast<std::size_t>(around)]);
      continue;
    }
    point_of.push_back(ring.num_points());
    const double angle = 2 * M_PI * x.x();
    const double radius = inside + thickness * x.y();
    ring.points.push_back(
        Vec3(radius * std::sin(angle), width * (x.z() - 0.5), -radius * std::cos(angle)));
  }
  for (const Index p : box.cells) ring.cells.push_back(point_of[static_cast<std::size_t>(p)]);
  check_and_orient(ring);
  return with_midside_nodes(ring);
}

TEST(Closing, ARingIsPressedFlat) {
  constexpr double kInside = 0.012;
  constexpr double kWall = 0.004;
  Scene scene = scene_of(ring(kInside, kWall, 0.008, 24), TouchingParts::all);
  scene.organ.contact = {0.0008, 2 * kYoungsModulus, 0};
  const double outside = kInside + kWall;
  std::vector<Index> top;
  const auto& points = scene.body.mesh.points;
  for (std::size_t p = 0; p < points.size(); ++p) {
    const bool is_outside = std::hypot(points[p].x(), points[p].z()) > 0.95 * outside;
    const bool is_middle = is_outside && std::abs(points[p].x()) < 0.2 * outside;
    scene.body.fixed[p] = is_middle && points[p].z() < 0 ? 1 : 0;
    if (is_middle && points[p].z() > 0) top.push_back(static_cast<Index>(p));
  }
  EquilibriumOptions options;
  options.kept_factors = 3;
  EquilibriumSolver solver(scene, options);
  solver.set_interaction(bond_as_one(top));
  const SoftContact contact(scene);
  Equilibrium state = solver.rest();
  double last = 0;
  const long before = solver.work().factorisations;
  int configurations = 0;
  for (double way = 0.002; way < 2 * kInside + 0.003; way += 0.002) {
    state = solver.solve(Vec3(0, 0, -way), state);
    ASSERT_EQ(state.outcome, Outcome::converged) << way << ": " << state.summary.message;
    EXPECT_EQ(state.negative_pivots, 0) << way;
    EXPECT_GT(state.energy, last);
    last = state.energy;
    ++configurations;
  }
  EXPECT_LE(solver.work().factorisations - before, 1.5 * configurations);
  // Its inner surfaces press each other.
  EXPECT_LT(contact.on_surface(state.u).deepest, 0.5 * contact.reach());
  NodalVector force = NodalVector::Zero(state.u.size());
  EXPECT_GT(contact.add(state.u, force, nullptr), 0);
}

}  // namespace
}  // namespace palpate::test::test_closing
