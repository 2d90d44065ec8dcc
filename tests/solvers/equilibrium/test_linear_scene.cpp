// SPDX-License-Identifier: BSD-3-Clause
// A linear scene: one factorisation serves all, and force is stiffness × displacement.
#include <gtest/gtest.h>

#include "equilibrium/equilibrium.h"
#include "interaction/bonded_patch.h"
#include "solvers/equilibrium/soundness.h"
#include "solvers/support/block.h"
#include "solvers/support/laws.h"
#include "solvers/support/orders.h"
#include "solvers/support/random.h"

namespace palpate::test::test_linear_scene {
namespace {

/// Rounding times a condition number of some 1e4.
constexpr double kRounding = 1e-11;

class LinearScene : public testing::TestWithParam<ElementOrder> {};
INSTANTIATE_TEST_SUITE_P(Each, LinearScene, testing::ValuesIn(kOrders), name_of_order);

TEST_P(LinearScene, ForceIsStiffnessTimesDisplacement) {
  const Block block = make_block(Law::linear, {GetParam()});
  const InteractionList tool = bond_nodes({block.corner});
  EquilibriumSolver solver(block.scene, {});
  solver.set_interaction(tool);
  const Equilibrium rest = solver.rest();
  Random random(61);
  Equilibrium last = rest;
  for (double size : {1e-12, 1e-6, 0.01, 1.0, 1e6}) {
    for (int i = 0; i < 5; ++i) {
      const Vec3 t = random.vector(3, size);
      const Equilibrium from_rest = solver.solve(t, rest);
      const Equilibrium from_last = solver.solve(t, last);
      const Vec3 expected = rest.stiffness * t;
      ASSERT_EQ(from_rest.outcome, Outcome::converged);
      ASSERT_EQ(from_last.outcome, Outcome::converged);
      EXPECT_LT((from_rest.reaction - expected).norm(), kRounding * expected.norm());
      EXPECT_LT((from_rest.u - rest.v * t).norm(), kRounding * (rest.v * t).norm());
      EXPECT_NEAR(from_rest.energy, expected.dot(t) / 2, kRounding * expected.norm() * t.norm());
      EXPECT_EQ(from_rest.stiffness, rest.stiffness);
      // A body that moves by 1e6 m and back keeps the rounding of 1e6 m.
      const double scale = std::max(t.norm(), last.t.norm());
      EXPECT_LT((from_last.reaction - expected).norm(), kRounding * rest.stiffness.norm() * scale);
      last = from_last;
    }
  }
}

TEST_P(LinearScene, OneFactorisationServesAll) {
  const Block block = make_block(Law::linear, {GetParam()});
  EquilibriumSolver solver(block.scene, {});
  solver.set_interaction(bond_nodes({block.corner}));
  Equilibrium state = solver.rest();
  const Work after_rest = solver.work();
  EXPECT_EQ(after_rest.factorisations, 1);
  EXPECT_EQ(after_rest.assemblies, 1);
  Random random(62);
  for (int i = 0; i < 50; ++i) state = solver.solve(random.vector(3, 0.05), state);
  EXPECT_EQ(solver.work().factorisations, 1);
  EXPECT_EQ(solver.work().analyses, 1);
  EXPECT_EQ(solver.work().assemblies, 1);
  solver.set_interaction(bond_nodes({block.middle}));
  state = solver.rest();
  for (int i = 0; i < 5; ++i) state = solver.solve(random.vector(3, 0.05), state);
  EXPECT_EQ(solver.work().factorisations, 1) << "it serves other tools as well";
  EXPECT_EQ(solver.work().analyses, 1);
  EXPECT_EQ(solver.work().assemblies, 1);
}

TEST_P(LinearScene, AnEquilibriumCostsNoSolve) {
  const Block block = make_block(Law::linear, {GetParam()});
  EquilibriumSolver solver(block.scene, {});
  solver.set_interaction(bond_nodes({block.corner}));
  Equilibrium state = solver.rest();
  EXPECT_LT(state.displacement_error, kRounding);
  const long solves = solver.work().right_hand_sides;
  Random random(63);
  for (int i = 0; i < 20; ++i) {
    const Vec3 t = random.vector(3, 0.05);
    state = solver.solve(t, state, i % 2 == 0 ? Tangent::factorised : Tangent::iterated);
    ASSERT_EQ(state.outcome, Outcome::converged);
    expect_sound(state, solver, bond_nodes({block.corner}));
    EXPECT_EQ(state.flags & ~flags::inverted, 0);
  }
  EXPECT_EQ(solver.work().right_hand_sides, solves);
}

TEST_P(LinearScene, ANonlinearCellMakesItNonlinear) {
  Block block = make_block(Law::linear, {GetParam()});
  block.scene.organ.materials.push_back(make_material(Law::neo_hookean, 3000, 0.35));
  block.scene.body.material_of_cell.assign(block.scene.body.mesh.num_cells(), 0);
  block.scene.body.material_of_cell.back() = 1;
  EquilibriumSolver solver(block.scene, {});
  solver.set_interaction(bond_nodes({block.corner}));
  const Equilibrium rest = solver.rest();
  const Equilibrium state = solver.solve(Vec3(0.01, 0, 0.01), rest);
  EXPECT_EQ(state.outcome, Outcome::converged);
  EXPECT_GT(solver.work().factorisations, 1);
  EXPECT_GT((state.stiffness - rest.stiffness).norm(), 1e-6 * rest.stiffness.norm());
  expect_sound(state, solver, bond_nodes({block.corner}));
}

}  // namespace
}  // namespace palpate::test::test_linear_scene
