// SPDX-License-Identifier: BSD-3-Clause
// A tool with a potential: it is felt through its springs.
#include "interaction/interaction.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "equilibrium/equilibrium.h"
#include "interaction/bonded_patch.h"
#include "solvers/interaction/spring.h"
#include "solvers/support/block.h"
#include "solvers/support/finite_difference.h"

namespace palpate::test::test_interaction {
namespace {

constexpr double kStiffness = 150;
/// Equilibria are solved to 1e-10 of the forces at the points.
constexpr double kSolved = 1e-8;

// A body and springs in a row: their compliances add up.
TEST(Spring, IsFeltTogetherWithTheBody) {
  const Block block = make_block(Law::linear);
  EquilibriumSolver bonded(block.scene, {});
  bonded.set_interaction(BondedPatch({block.corner}));
  const Mat3 of_body = bonded.rest().stiffness;
  EquilibriumSolver solver(block.scene, {});
  solver.set_interaction(Spring({block.corner}, kStiffness));
  const Mat3 expected = (of_body.inverse() + Mat3::Identity() / kStiffness).inverse();
  const Equilibrium rest = solver.rest();
  EXPECT_LT((rest.stiffness - expected).norm(), kSolved * expected.norm());
  const Vec3 q(0.01, -0.005, 0.002);
  const Equilibrium pulled = solver.solve(q, rest);
  ASSERT_EQ(pulled.outcome, Outcome::converged) << pulled.summary.message;
  EXPECT_LT((pulled.reaction - expected * q).norm(), kSolved * (expected * q).norm());
  EXPECT_NEAR(pulled.energy, q.dot(expected * q) / 2, kSolved * pulled.energy);
}

// Springs that are stiff beside the body hold it as a bonded patch does.
TEST(Spring, ThatIsStiffBondsTheNodeInALargeDeformation) {
  const Block block = make_block(Law::neo_hookean);
  const Vec3 q(0.01, -0.02, 0.015);
  EquilibriumSolver solver(block.scene, {});
  const auto solve = [&](const Interaction& tool) {
    solver.set_interaction(tool);
    Equilibrium state = solver.solve(q, solver.rest());
    EXPECT_EQ(state.outcome, Outcome::converged) << state.summary.message;
    return state;
  };
  const Equilibrium bonded = solve(BondedPatch({block.corner}));
  double last = 1;
  for (const double stiffness : {1e4, 1e5, 1e6}) {
    const Equilibrium sprung = solve(Spring({block.corner}, stiffness));
    const double difference = (sprung.u - bonded.u).norm() / bonded.u.norm();
    EXPECT_LT(difference, 0.2 * last) << stiffness;
    last = difference;
  }
  EXPECT_LT(last, 1e-3);
}

// Where one was before says nothing of where it is now: a factor belongs to a place of the tool.
TEST(Spring, ASolveDoesNotDependOnThoseBefore) {
  const Block block = make_block(Law::neo_hookean);
  const Vec3 first(0.01, 0, 0);
  const Vec3 second(0.02, 0.01, 0);
  EquilibriumSolver fresh(block.scene, {});
  fresh.set_interaction(Spring({block.corner}, kStiffness));
  const Equilibrium expected = fresh.solve(second, fresh.rest());
  EquilibriumSolver used(block.scene, {});
  used.set_interaction(Spring({block.corner}, kStiffness));
  const Equilibrium rest = used.rest();
  (void)used.solve(first, rest);
  const Equilibrium again = used.solve(second, rest);
  EXPECT_EQ(again.energy, expected.energy);
  EXPECT_EQ(again.u, expected.u);
  EXPECT_EQ(again.stiffness, expected.stiffness);
}

TEST(InteractionList, HasTheCoordinatesOfItsToolsOneAfterTheOther) {
  InteractionList tools;
  EXPECT_EQ(tools.num_coordinates(), 0);
  EXPECT_FALSE(tools.has_potential());
  tools.add(BondedPatch({4, 7}));
  tools.add(BondedPatch({9}));
  EXPECT_FALSE(tools.has_potential());
  tools.add(Spring({3}, kStiffness));
  EXPECT_TRUE(tools.has_potential());
  EXPECT_EQ(tools.num_coordinates(), 9);
  const auto points = tools.prescribed_points();
  ASSERT_EQ(points.size(), 3U);
  EXPECT_EQ(points[1].point, 7);
  EXPECT_EQ(points[1].coordinate, 0);
  EXPECT_EQ(points[2].point, 9);
  EXPECT_EQ(points[2].coordinate, 3);
  Eigen::VectorXd q = Eigen::VectorXd::Zero(9);
  q[4] = -0.3;
  EXPECT_EQ(tools.displacement_scale(q), 0.3);
  EXPECT_EQ(tools.describe(q),
            "a displacement of 0 m and a displacement of 0.3 m and springs at 0.000000 m");
}

}  // namespace
}  // namespace palpate::test::test_interaction
