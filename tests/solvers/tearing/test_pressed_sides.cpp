// SPDX-License-Identifier: BSD-3-Clause
#include "tearing/pressed_sides.h"

#include <gtest/gtest.h>

#include "cutting/opened_scene.h"
#include "equilibrium/equilibrium.h"
#include "solvers/support/cut_cube.h"

namespace palpate::test::test_pressed_sides {
namespace {

class PressedSides : public testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Ways, PressedSides, testing::Values(-0.02, -0.1, 0.1));

InteractionList make_tool(const Scene& scene) {
  return bond_as_one(points_where(scene.body.mesh,
                                  [](const Vec3& x) { return x.z() > 1 - 1e-9 && x.x() < 0.51; }));
}

/// A cube that is pressed or pulled, and cut while it is held: the equilibrium is that which is
/// found from rest, and is found at once.
TEST_P(PressedSides, AreNearTheEquilibrium) {
  const Scene closed = make_cut_scene(ElementOrder::quadratic);
  const Vec3 way(0, 0, GetParam());
  EquilibriumSolver before(closed, EquilibriumOptions());
  before.set_interaction(make_tool(closed));
  const Equilibrium held = before.solve(way, before.rest());
  ASSERT_EQ(held.outcome, Outcome::converged);

  const OpenedScene opened = open_scene(closed, 3);
  EquilibriumSolver solver(opened.scene, EquilibriumOptions());
  solver.set_interaction(make_tool(opened.scene));
  const Equilibrium from_rest = solver.solve(way, solver.rest());
  ASSERT_EQ(from_rest.outcome, Outcome::converged);
  const auto contact = make_soft_contact(opened.scene);
  Equilibrium near;
  near.t = way;
  near.u = press_sides(opened.scene, solver.assembly(), *contact, opened.carry(held.u));
  const Equilibrium found = solver.settle(near);
  ASSERT_EQ(found.outcome, Outcome::converged);
  EXPECT_NEAR(found.energy / from_rest.energy, 1, 1e-8);
  EXPECT_TRUE(found.reaction.isApprox(from_rest.reaction, 1e-7));
  EXPECT_LE(found.summary.iterations, 20);
  if (GetParam() > 0) return;
  EXPECT_LT(5 * found.summary.iterations, from_rest.summary.iterations);

  // What presses already is hardly moved.
  const NodalVector again = press_sides(opened.scene, solver.assembly(), *contact, found.u);
  const double moved = (again - found.u).lpNorm<Eigen::Infinity>();
  const double first = (near.u - opened.carry(held.u)).lpNorm<Eigen::Infinity>();
  EXPECT_LE(moved, 0.5 * first);
}

}  // namespace
}  // namespace palpate::test::test_pressed_sides
