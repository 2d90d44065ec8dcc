// SPDX-License-Identifier: BSD-3-Clause
// T = ∂³Π/∂t³ against differences of k between solves.
#include <gtest/gtest.h>

#include "equilibrium/equilibrium.h"
#include "equilibrium/third_derivative.h"
#include "interaction/bonded_patch.h"
#include "solvers/support/block.h"
#include "solvers/support/finite_difference.h"
#include "solvers/support/laws.h"

namespace palpate::test::test_third_derivative {
namespace {

const Vec3 kPull(-0.008, 0.006, 0.007);
/// Of the differences of k: a fiftieth of the pull, extrapolated to O(h⁶).
constexpr double kStep = 2e-4;
/// The strain of a second difference is 3e-4: its error is about the square.
constexpr double kDifference = 1e-6;
/// v of an iterated tangent is off by up to 1e-4, and T by thrice that.
constexpr double kIterated = 3e-4;

EquilibriumOptions with_third_derivatives() {
  EquilibriumOptions options;
  options.tolerance = 1e-13;
  options.third_derivatives = true;
  return options;
}

/// ∂k/∂t_c for c = x, y, z, by differences, in the order of Equilibrium::third_derivative; the
/// largest that two ways to the same component differ by, in `spread`.
Eigen::VectorXd by_differences(EquilibriumSolver& solver, const Equilibrium& state,
                               double& spread) {
  Mat3 of_axis[3];
  for (int c = 0; c < 3; ++c) {
    of_axis[c] = derivative(
        [&](double s) -> Mat3 {
          const Equilibrium moved = solver.solve(state.t + s * Vec3::Unit(c), state);
          EXPECT_EQ(moved.outcome, Outcome::converged);
          return moved.stiffness;
        },
        kStep);
  }
  Eigen::VectorXd t(10);
  int next = 0;
  spread = 0;
  for (int a = 0; a < 3; ++a) {
    for (int b = a; b < 3; ++b) {
      for (int c = b; c < 3; ++c) {
        t[next++] = of_axis[c](a, b);
        spread = std::max({spread, std::abs(of_axis[c](a, b) - of_axis[b](a, c)),
                           std::abs(of_axis[c](a, b) - of_axis[a](b, c))});
      }
    }
  }
  return t;
}

void check(const Block& block, const Interaction& tool) {
  EquilibriumSolver solver(block.scene, with_third_derivatives());
  solver.set_interaction(tool);
  const Equilibrium rest = solver.rest();
  for (const Equilibrium& state : {rest, solver.solve(kPull, rest)}) {
    ASSERT_EQ(state.outcome, Outcome::converged) << state.summary.message;
    ASSERT_EQ(state.third_derivative.size(), 10);
    double spread = 0;
    const Eigen::VectorXd expected = by_differences(solver, state, spread);
    const double scale = expected.norm();
    EXPECT_LT(spread, kDifference * scale);
    EXPECT_LT((state.third_derivative - expected).norm(), kDifference * scale);
  }
}

class ThirdDerivative : public testing::TestWithParam<Law> {};

INSTANTIATE_TEST_SUITE_P(Each, ThirdDerivative, testing::ValuesIn(kNonlinearLaws), name_of_law);

TEST_P(ThirdDerivative, IsThatOfTheStiffness) {
  const Block block = make_block(GetParam());
  check(block, bond_nodes({block.corner}));
}

TEST(ThirdDerivativeOfAPatch, IsThatOfTheStiffness) {
  const Block block = make_block(Law::neo_hookean, {ElementOrder::linear});
  check(block, BondedPatch({block.corner, block.middle}));
}

// The state is (u, p̂).
TEST(ThirdDerivativeOfMixedCells, IsThatOfTheStiffness) {
  const Block block =
      make_block(Law::mooney_rivlin, {ElementOrder::quadratic, {3, 2, 2}, 0.1, 3000, 0.499});
  ASSERT_GT(EquilibriumSolver(block.scene, {}).assembly().num_pressures(), 0);
  check(block, bond_nodes({block.corner}));
}

TEST(ThirdDerivativeOfALinearBody, IsZeroAndCostsNothing) {
  const Block block = make_block(Law::linear);
  EquilibriumSolver solver(block.scene, with_third_derivatives());
  EquilibriumSolver without(block.scene, {});
  for (EquilibriumSolver* each : {&solver, &without})
    each->set_interaction(bond_nodes({block.corner}));
  const Equilibrium state = solver.solve(kPull, solver.rest());
  const Equilibrium other = without.solve(kPull, without.rest());
  EXPECT_EQ(state.third_derivative, Eigen::VectorXd::Zero(10));
  EXPECT_EQ(other.third_derivative.size(), 0);
  EXPECT_EQ(solver.work().residuals, without.work().residuals);
}

TEST(ThirdDerivativeOfAnIteratedTangent, IsAsGoodAsItsSensitivity) {
  const Block block = make_block(Law::st_venant_kirchhoff);
  EquilibriumSolver solver(block.scene, with_third_derivatives());
  solver.set_interaction(bond_nodes({block.corner}));
  const Equilibrium rest = solver.rest();
  const Equilibrium factorised = solver.solve(kPull, rest);
  const Equilibrium iterated = solver.solve(kPull, rest, Tangent::iterated);
  const Equilibrium rough = solver.solve(kPull, rest, Tangent::rough);
  EXPECT_LT((iterated.third_derivative - factorised.third_derivative).norm(),
            kIterated * factorised.third_derivative.norm());
  EXPECT_EQ(rough.third_derivative.size(), 0);
  EXPECT_EQ(rough.reaction, factorised.reaction);
  EXPECT_EQ(rough.energy, factorised.energy);
  EXPECT_LT((rough.stiffness - factorised.stiffness).norm(), 1e-3 * factorised.stiffness.norm());
}

// Where a difference of the usual step would invert a cell it is taken with a shorter one, and a
// solve that ends short of its target has none.
TEST(ThirdDerivativeOfASqueezedBody, IsFiniteWhereTheLawIsAndAbsentWhereTheSolveFails) {
  const Block block = make_block(Law::neo_hookean);
  EquilibriumOptions options = with_third_derivatives();
  options.tolerance = 1e-9;
  EquilibriumSolver solver(block.scene, options);
  solver.set_interaction(bond_nodes({block.corner}));
  const Equilibrium rest = solver.rest();
  const Equilibrium squeezed = solver.solve(Vec3(-0.02, 0, 0), rest);
  ASSERT_EQ(squeezed.outcome, Outcome::converged);
  EXPECT_TRUE(squeezed.third_derivative.allFinite());
  options.max_iterations = 1;
  options.max_halvings = 0;
  options.follow_folds = false;
  EquilibriumSolver hasty(block.scene, options);
  hasty.set_interaction(bond_nodes({block.corner}));
  const Equilibrium failed = hasty.solve(kPull, rest);
  ASSERT_NE(failed.outcome, Outcome::converged);
  EXPECT_EQ(failed.third_derivative.size(), 0);
}

TEST(ThirdDerivativeOfSeveralTools, IsThatOfTheStiffness) {
  const Block block = make_block(Law::neo_hookean, {ElementOrder::linear});
  EquilibriumSolver solver(block.scene, with_third_derivatives());
  solver.set_interaction(bond_nodes({block.corner, block.middle}));
  constexpr Eigen::Index kCoordinates = 6;
  Eigen::VectorXd t(kCoordinates);
  t << 0.01, -0.004, 0.006, 0.003, 0.005, -0.002;
  const Equilibrium here = solver.solve(t, solver.rest());
  ASSERT_EQ(here.outcome, Outcome::converged);
  ASSERT_EQ(here.third_derivative.size(), num_third_derivatives(kCoordinates));
  const double largest = here.third_derivative.cwiseAbs().maxCoeff();
  Eigen::Index next = 0;
  for (Eigen::Index a = 0; a < kCoordinates; ++a) {
    const Eigen::MatrixXd along = derivative(
        [&](double s) -> Eigen::MatrixXd {
          return solver.solve(t + s * Eigen::VectorXd::Unit(kCoordinates, a), here).stiffness;
        },
        1e-5);
    for (Eigen::Index b = a; b < kCoordinates; ++b) {
      for (Eigen::Index c = b; c < kCoordinates; ++c) {
        EXPECT_NEAR(here.third_derivative[next++], along(b, c), 1e-4 * largest);
      }
    }
  }
}

}  // namespace
}  // namespace palpate::test::test_third_derivative
