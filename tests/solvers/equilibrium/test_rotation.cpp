// SPDX-License-Identifier: BSD-3-Clause
// A scene that is turned as a whole has the same answer, turned with it: u, h, v, k and T.
#include <gtest/gtest.h>

#include <string>

#include "equilibrium/equilibrium.h"
#include "interaction/bonded_patch.h"
#include "solvers/equilibrium/options.h"
#include "solvers/support/block.h"
#include "solvers/support/laws.h"
#include "solvers/support/orders.h"
#include "solvers/support/random.h"
#include "solvers/support/solvable.h"

namespace palpate::test::test_rotation {
namespace {

class Rotation : public testing::TestWithParam<Law> {};
INSTANTIATE_TEST_SUITE_P(Each, Rotation, testing::ValuesIn(kLaws), name_of_law);
INSTANTIATE_TEST_SUITE_P(EachIncompressible, Rotation, testing::ValuesIn(kIncompressibleLaws),
                         name_of_law);

/// Places of xxx, xxy, … in Equilibrium::third_derivative by the three axes.
double third_derivative(const Equilibrium& state, int a, int b, int c) {
  constexpr int kPlaces[3][3][3] = {{{0, 1, 2}, {1, 3, 4}, {2, 4, 5}},
                                    {{1, 3, 4}, {3, 6, 7}, {4, 7, 8}},
                                    {{2, 4, 5}, {4, 7, 8}, {5, 8, 9}}};
  return state.third_derivative[kPlaces[a][b][c]];
}

/// T of a scene that was turned by r.
double turned_third_derivative(const Equilibrium& state, const Mat3& r, int a, int b, int c) {
  double sum = 0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      for (int k = 0; k < 3; ++k)
        sum += r(a, i) * r(b, j) * r(c, k) * third_derivative(state, i, j, k);
    }
  }
  return sum;
}

TEST_P(Rotation, OfTheSceneTurnsTheAnswer) {
  // Both states are as near to the equilibrium as rounding allows.
  constexpr double kRounding = 1e-10;
  // The relative error of a third derivative, see third_derivative.cpp, and a margin.
  constexpr double kThird = 1e-5;
  EquilibriumOptions options = with_tolerance(1e-13);
  options.third_derivatives = true;
  Random random(83);
  for (const ElementOrder order : kOrders) {
    const Block block = make_block(GetParam(), {order});
    if (!is_solvable(block.scene)) continue;
    const auto solve = [&](const Scene& scene, const Vec3& t) {
      EquilibriumSolver solver(scene, options);
      solver.set_interaction(bond_nodes({block.corner}));
      return solver.solve(t, solver.rest());
    };
    const Vec3 t(-0.010, 0.006, -0.005);
    const Equilibrium expected = solve(block.scene, t);
    ASSERT_EQ(expected.outcome, Outcome::converged) << expected.summary.message;
    for (int trial = 0; trial < 3; ++trial) {
      const Mat3 r = random.rotation();
      Scene scene = block.scene;
      for (Vec3& point : scene.body.mesh.points) point = r * point;
      const Equilibrium state = solve(scene, r * t);
      ASSERT_EQ(state.outcome, Outcome::converged) << state.summary.message;
      EXPECT_EQ(state.flags, expected.flags);
      EXPECT_NEAR(state.energy, expected.energy, kRounding * expected.energy);
      EXPECT_NEAR(state.minimum_det_f, expected.minimum_det_f, kRounding);
      const Vec3 h = r * expected.reaction;
      EXPECT_LT((state.reaction - h).norm(), kRounding * h.norm());
      const Mat3 k = r * expected.stiffness * r.transpose();
      EXPECT_LT((state.stiffness - k).norm(), kRounding * k.norm());
      for (Index p = 0; p < scene.body.mesh.num_points(); ++p) {
        const Vec3 u = r * expected.u.segment<3>(3 * p);
        EXPECT_LT((state.u.segment<3>(3 * p) - u).norm(), kRounding * t.norm()) << p;
        const Mat3 v = r * expected.v.middleRows<3>(3 * p) * r.transpose();
        EXPECT_LT((state.v.middleRows<3>(3 * p) - v).norm(), 10 * kRounding) << p;
      }
      EXPECT_LT((state.p - expected.p).norm(), kRounding * expected.p.norm() + kRounding);
      for (int a = 0; a < 3; ++a) {
        for (int b = 0; b < 3; ++b) {
          for (int c = 0; c < 3; ++c) {
            EXPECT_NEAR(third_derivative(state, a, b, c),
                        turned_third_derivative(expected, r, a, b, c),
                        kThird * expected.third_derivative.norm());
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace palpate::test::test_rotation
