// SPDX-License-Identifier: BSD-3-Clause
// v and k without a factor of their own, against those with one.
#include <gtest/gtest.h>

#include "equilibrium/equilibrium.h"
#include "interaction/bonded_patch.h"
#include "solvers/support/block.h"
#include "solvers/support/laws.h"

namespace palpate::test::test_iterated_tangent {
namespace {

const Vec3 kPull(0.006, 0.004, -0.005);
/// v is iterated to 1e-4; the error of k is the square of that.
constexpr double kSensitivity = 2e-4;
constexpr double kStiffness = 1e-7;

class IteratedTangent : public testing::TestWithParam<Law> {};

INSTANTIATE_TEST_SUITE_P(Each, IteratedTangent, testing::ValuesIn(kNonlinearLaws), name_of_law);

TEST_P(IteratedTangent, AgreesWithTheFactorisedOneAndCostsNoFactorisation) {
  const Block block = make_block(GetParam());
  EquilibriumSolver solver(block.scene, {});
  const InteractionList tool = bond_nodes({block.corner});
  solver.set_interaction(tool);
  const Equilibrium rest = solver.rest();
  const long before = solver.work().factorisations;
  const Equilibrium iterated = solver.solve(kPull, rest, Tangent::iterated);
  EXPECT_EQ(solver.work().factorisations, before);
  const Equilibrium factorised = solver.solve(kPull, rest);
  EXPECT_EQ(solver.work().factorisations, before + 1);
  ASSERT_EQ(iterated.outcome, Outcome::converged);
  EXPECT_EQ(iterated.flags, flags::inertia_not_computed);
  EXPECT_EQ(iterated.u, factorised.u);
  EXPECT_EQ(iterated.energy, factorised.energy);
  EXPECT_EQ(iterated.reaction, factorised.reaction);
  EXPECT_LT((iterated.v - factorised.v).norm(), kSensitivity * factorised.v.norm());
  EXPECT_LT((iterated.stiffness - factorised.stiffness).norm(),
            kStiffness * factorised.stiffness.norm());
}

TEST(MixedTangent, IsLeftToAFactorWherePressuresMakeItASaddle) {
  const Block block =
      make_block(Law::neo_hookean, {ElementOrder::quadratic, {3, 2, 2}, 0.1, 3000, 0.49});
  EquilibriumSolver solver(block.scene, {});
  solver.set_interaction(bond_nodes({block.corner}));
  ASSERT_GT(solver.assembly().num_pressures(), 0);
  const Equilibrium state = solver.solve(kPull, solver.rest(), Tangent::iterated);
  EXPECT_EQ(state.outcome, Outcome::converged);
  EXPECT_EQ(state.flags & flags::inertia_not_computed, 0);
}

}  // namespace
}  // namespace palpate::test::test_iterated_tangent
