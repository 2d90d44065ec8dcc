// SPDX-License-Identifier: BSD-3-Clause
// h = ∂Π/∂t, k = ∂h/∂t and v = ∂u/∂t against differences of solves.
#include <gtest/gtest.h>

#include <tuple>
#include <utility>

#include "equilibrium/equilibrium.h"
#include "interaction/bonded_patch.h"
#include "solvers/equilibrium/options.h"
#include "solvers/interaction/spring.h"
#include "solvers/support/block.h"
#include "solvers/support/bodies.h"
#include "solvers/support/finite_difference.h"
#include "solvers/support/laws.h"
#include "solvers/support/orders.h"

namespace palpate::test::test_derivatives {
namespace {

/// Solves to 1e-13 of the forces; steps of 2e-4 m, a fiftieth of the displacement, extrapolated to
/// O(h⁶).
constexpr double kStep = 2e-4;
constexpr double kTolerance = 1e-13;
constexpr double kDifference = 1e-7;

class Derivatives : public testing::TestWithParam<std::tuple<ElementOrder, Law>> {
 protected:
  Derivatives() : block_(make_block(std::get<1>(GetParam()), {std::get<0>(GetParam())})) {}

  void check(const Interaction& tool, const Eigen::VectorXd& t) {
    EquilibriumSolver solver(block_.scene, with_tolerance(kTolerance));
    solver.set_interaction(tool);
    const Equilibrium state = solver.solve(t, solver.rest());
    ASSERT_EQ(state.outcome, Outcome::converged) << state.summary.message;
    const auto moved = [&](Eigen::Index i, double step) {
      Equilibrium other = solver.solve(t + step * Eigen::VectorXd::Unit(t.size(), i), state);
      EXPECT_EQ(other.outcome, Outcome::converged);
      return other;
    };
    for (Eigen::Index i = 0; i < t.size(); ++i) {
      const double h = derivative([&](double s) { return moved(i, s).energy; }, kStep);
      EXPECT_NEAR(state.reaction[i], h, kDifference * state.reaction.norm()) << "h, " << i;
      const Eigen::VectorXd k = derivative([&](double s) { return moved(i, s).reaction; }, kStep);
      EXPECT_LT((state.stiffness.col(i) - k).norm(), kDifference * state.stiffness.norm())
          << "k, " << i;
      const Eigen::VectorXd v = derivative([&](double s) { return moved(i, s).u; }, kStep);
      EXPECT_LT((state.v.col(i) - v).norm(), kDifference * state.v.col(i).norm()) << "v, " << i;
    }
  }

  Block block_;
};

INSTANTIATE_TEST_SUITE_P(Each, Derivatives,
                         testing::Combine(testing::ValuesIn(kOrders), testing::ValuesIn(kLaws)),
                         [](const testing::TestParamInfo<std::tuple<ElementOrder, Law>>& each) {
                           return name_of_order({std::get<0>(each.param), 0}) +
                                  letters(to_string(std::get<1>(each.param)));
                         });

TEST_P(Derivatives, OfOneNode) { check(bond_nodes({block_.corner}), Vec3(-0.008, 0.006, 0.007)); }

TEST_P(Derivatives, OfTwoNodes) {
  Eigen::VectorXd t(6);
  t << 0.006, -0.005, 0.004, 0.009, 0.004, -0.003;
  check(bond_nodes({block_.corner, block_.middle}), t);
}

// Several points that move as one, and one beside them.
TEST_P(Derivatives, OfAToolAtSeveralPoints) {
  const TetMesh& mesh = block_.scene.body.mesh;
  const Vec3 centre = mesh.points[block_.middle];
  const std::vector<Index> points =
      points_where(mesh, [&](const Vec3& p) { return (p - centre).norm() < 0.02; });
  ASSERT_GE(points.size(), 2U - (std::get<0>(GetParam()) == ElementOrder::linear));
  InteractionList tools;
  tools.add(BondedPatch({block_.corner}));
  tools.add(BondedPatch(points));
  Eigen::VectorXd t(6);
  t << 0.006, -0.005, 0.004, 0.009, 0.004, -0.003;
  check(tools, t);
}

// A tool on springs beside one that is bonded: of what it adds to the energy there is a share in
// h, k and v.
TEST_P(Derivatives, OfAToolWithAPotential) {
  InteractionList tools;
  tools.add(Spring({block_.corner}, 200));
  tools.add(BondedPatch({block_.middle}));
  Eigen::VectorXd t(6);
  t << 0.016, -0.015, 0.014, 0.009, 0.004, -0.003;
  check(tools, t);
}

}  // namespace
}  // namespace palpate::test::test_derivatives
