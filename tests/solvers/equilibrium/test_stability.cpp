// SPDX-License-Identifier: BSD-3-Clause
// Equilibria that are not stable, or not held, are told.
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "equilibrium/equilibrium.h"
#include "solvers/equilibrium/soundness.h"
#include "solvers/support/block.h"
#include "solvers/support/box_mesh.h"
#include "solvers/support/laws.h"
#include "solvers/support/orders.h"

namespace palpate::test {
namespace {

class Stability : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Each, Stability, testing::ValuesIn(linear_solver_names()),
                         [](const auto& each) { return letters(each.param); });

/// A column along x of St. Venant–Kirchhoff with ν = 0, fixed at one end; the other end is one
/// site. Under compression it has the uniform state for an equilibrium, exactly and on any mesh:
/// there is no lateral stress. It is stable until the column buckles.
struct Column {
  static constexpr double kYoungsModulus = 1000;
  Scene scene;
  Constraint end;
};

Column make_column(ElementOrder order) {
  TetMesh mesh = make_box(order, {6, 1, 1}, {6, 1, 1});
  std::vector<char> fixed;
  Column column;
  column.end.num_sites = 1;
  for (Index p = 0; p < mesh.num_points(); ++p) {
    fixed.push_back(mesh.points[p].x() == 0 ? 1 : 0);
    if (mesh.points[p].x() == 6) {
      column.end.points.push_back(p);
      column.end.site_of_point.push_back(0);
    }
  }
  column.scene = make_scene(
      std::move(mesh),
      make_isotropic(Law::st_venant_kirchhoff, Column::kYoungsModulus, 0), fixed);
  return column;
}

TEST_P(Stability, AColumnThatShouldBuckleIsUnstable) {
  for (ElementOrder order : kOrders) {
    const Column column = make_column(order);
    EquilibriumSolver solver(column.scene, {}, make_linear_solver(GetParam()));
    solver.hold(column.end);
    const Equilibrium rest = solver.rest();
    for (double strain : {0.02, 0.4}) {
      const Equilibrium state = solver.solve(Vec3(-6 * strain, 0, 0), rest);
      ASSERT_EQ(state.outcome, Outcome::converged) << state.message;
      const double f = 1 - strain;
      const double force = Column::kYoungsModulus * f * (f * f - 1) / 2;
      EXPECT_LT((state.reaction - Vec3(force, 0, 0)).norm(), 1e-9 * std::abs(force));
      EXPECT_NEAR(state.energy, 6 * Column::kYoungsModulus * std::pow((f * f - 1) / 2, 2) / 2,
                  1e-9 * state.energy);
      EXPECT_NEAR(state.minimum_det_f, f, 1e-9);
      const bool buckles = strain > 0.1;
      EXPECT_EQ((state.flags & flags::unstable) != 0, buckles) << "strain " << strain;
      EXPECT_EQ(state.message.find("not stable") != std::string::npos, buckles);
      expect_sound(state, solver, column.end);
    }
  }
}

// Without a factor of its own an unstable equilibrium shows by negative curvature.
TEST_P(Stability, AnIteratedTangentSeesThatItShouldBuckle) {
  const Column column = make_column(ElementOrder::quadratic);
  EquilibriumSolver solver(column.scene, {}, make_linear_solver(GetParam()));
  solver.hold(column.end);
  const Equilibrium rest = solver.rest();
  EXPECT_EQ(solver.solve(Vec3(-0.12, 0, 0), rest, Tangent::iterated).flags,
            flags::inertia_not_computed);
  EXPECT_EQ(solver.solve(Vec3(-2.4, 0, 0), rest, Tangent::iterated).flags, flags::unstable);
}

TEST(Inertia, IsTheSameForEverySolver) {
  if (linear_solver_names().size() < 2) GTEST_SKIP() << "one solver was built in";
  const Column column = make_column(ElementOrder::quadratic);
  std::vector<int> negative_pivots;
  for (const std::string& name : linear_solver_names()) {
    EquilibriumSolver solver(column.scene, {}, make_linear_solver(name));
    solver.hold(column.end);
    negative_pivots.push_back(solver.solve(Vec3(-2.4, 0, 0), solver.rest()).negative_pivots);
  }
  EXPECT_GT(negative_pivots[0], 0);
  EXPECT_EQ(negative_pivots[0], negative_pivots[1]);
}

/// The message says what to do; nothing that is not a number comes out; and a solve from there says
/// the same.
void expect_floats(const Scene& scene, Index active, const std::string& solver_name) {
  EquilibriumSolver solver(scene, {}, make_linear_solver(solver_name));
  const Constraint constraint = hold_nodes({active});
  solver.hold(constraint);
  const Equilibrium rest = solver.rest();
  EXPECT_EQ(rest.outcome, Outcome::tangent_not_factorised);
  EXPECT_NE(rest.message.find("not held"), std::string::npos) << rest.message;
  expect_sound(rest, solver, constraint);
  const Equilibrium state = solver.solve(Vec3(0.01, 0, 0), rest);
  EXPECT_EQ(state.outcome, Outcome::tangent_not_factorised);
  EXPECT_FALSE(state.message.empty()) << "why there is no solution is lost";
}

/// A block, and another beside it that nothing holds.
Scene make_two_pieces(ElementOrder order, Law law, Index& active_in_first) {
  Block block = make_block(law, {order});
  active_in_first = block.corner;
  Scene& scene = block.scene;
  const TetMesh first = scene.mesh;
  for (const Vec3& p : first.points) {
    scene.mesh.points.push_back(p + Vec3(0.3, 0, 0));
    scene.fixed.push_back(0);
    scene.touchable.push_back(1);
  }
  for (Index p : first.cells) scene.mesh.cells.push_back(p + first.num_points());
  return std::move(block.scene);
}

TEST_P(Stability, APieceThatNothingHoldsIsTold) {
  for (ElementOrder order : kOrders) {
    for (Law law : {Law::linear, Law::neo_hookean}) {
      Index active = -1;
      const Scene scene = make_two_pieces(order, law, active);
      expect_floats(scene, active, GetParam());
    }
  }
}

// Held at one point and touched at another, a body can still turn about the two.
TEST_P(Stability, ABodyThatCanTurnIsTold) {
  for (ElementOrder order : kOrders) {
    Block block = make_block(Law::neo_hookean, {order});
    std::fill(block.scene.fixed.begin(), block.scene.fixed.end(), 0);
    block.scene.fixed[0] = 1;
    expect_floats(block.scene, block.corner, GetParam());
  }
}

TEST_P(Stability, TwoFixedPointsAndTheActiveNodeHoldABody) {
  for (ElementOrder order : kOrders) {
    Block block = make_block(Law::neo_hookean, {order});
    std::fill(block.scene.fixed.begin(), block.scene.fixed.end(), 0);
    block.scene.fixed[0] = block.scene.fixed[4] = 1;
    EquilibriumSolver solver(block.scene, {}, make_linear_solver(GetParam()));
    solver.hold(hold_nodes({block.corner}));
    EXPECT_EQ(solver.rest().outcome, Outcome::converged);
  }
}

}  // namespace
}  // namespace palpate::test
