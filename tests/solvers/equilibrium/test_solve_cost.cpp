// SPDX-License-Identifier: BSD-3-Clause
// What solves are expected to take. Times are not compared: a machine that tests is not quiet.
#include "equilibrium/solve_cost.h"

#include <gtest/gtest.h>

#include "assembly/assembly.h"
#include "linear/linear_solver.h"
#include "solvers/support/box_mesh.h"

namespace palpate::test::test_solve_cost {
namespace {

Scene make_cube(int bricks) {
  Scene scene;
  scene.body.mesh = test::make_box(ElementOrder::quadratic, {bricks, bricks, bricks}, Vec3::Ones());
  for (const Vec3& p : scene.body.mesh.points) scene.body.fixed.push_back(p.z() == 0 ? 1 : 0);
  scene.body.touchable.assign(scene.body.fixed.size(), 1);
  scene.organ.materials = {make_isotropic(Law::neo_hookean, 10e3, 0.4)};
  return scene;
}

TEST(SolveCost, IsOfTheWholeBodyAlsoWhereAPartIsTimed) {
  for (const int bricks : {3, 8}) {  // 882 and 13 872 unknowns, of which 7 500 are timed
    const Scene scene = make_cube(bricks);
    const Assembly assembly(scene);
    const std::unique_ptr<LinearSolver> solver = make_linear_solver();
    solver->analyse(assembly.pattern());
    const SolveCost cost = measure_solve_cost(scene, solver->name());
    EXPECT_TRUE(cost.has_factor());
    EXPECT_EQ(cost.num_unknowns, assembly.pattern().size);
    EXPECT_EQ(cost.state_size, assembly.state_size());
    EXPECT_GE(cost.factor_bytes, static_cast<double>(solver->factor_bytes()));
    EXPECT_LE(cost.factor_bytes, 2 * static_cast<double>(solver->factor_bytes()));
    for (const double seconds : {cost.residual_seconds, cost.assembly_seconds,
                                 cost.factorisation_seconds, cost.solve_seconds}) {
      EXPECT_GT(seconds, 0);
    }
  }
}

TEST(SolveCost, OfALargeBodyIsThatWithoutAFactor) {
  EXPECT_TRUE(measure_solve_cost(make_cube(3)).has_factor());
  const Scene scene = make_cube(8);
  const SolveCost cost = measure_solve_cost(scene);
  EXPECT_FALSE(cost.has_factor());
  EXPECT_EQ(cost.num_unknowns, Assembly(scene).pattern().size);
  EXPECT_EQ(cost.factor_bytes, 0);
  EXPECT_GT(seconds_of(work_of_equilibrium(), cost, false), 0);
  EXPECT_LT(solver_bytes(cost, 10, false),
            solver_bytes(measure_solve_cost(scene, make_linear_solver()->name()), 10, false));
}

TEST(SolveCost, IsToldOfABodyThatIsHeldNowhereOrThroughout) {
  Scene floating = make_cube(2);
  floating.body.fixed.assign(floating.body.fixed.size(), 0);
  EXPECT_GT(measure_solve_cost(floating).factorisation_seconds, 0);
  Scene held = make_cube(2);
  held.body.fixed.assign(held.body.fixed.size(), 1);
  const SolveCost cost = measure_solve_cost(held);
  EXPECT_EQ(cost.num_unknowns, 0);
  EXPECT_EQ(cost.factorisation_seconds, 0);
  EXPECT_EQ(cost.factor_bytes, 0);
}

TEST(SolveCost, AddsUpByWhatIsDone) {
  SolveCost cost;
  cost.factorisation_seconds = 10;
  cost.solve_seconds = 1;
  cost.residual_seconds = 0.1;
  cost.assembly_seconds = 0.5;
  cost.factor_bytes = 1000;
  cost.body_bytes = 100;
  EXPECT_DOUBLE_EQ(seconds_of({2, 3, 4, 5}, cost, false), 20 + 3 + 0.4 + 2.5);
  EXPECT_LT(seconds_of({2, 3, 4, 5}, cost, true), seconds_of({2, 3, 4, 5}, cost, false));
  EXPECT_DOUBLE_EQ(solver_bytes(cost, 3, false), 3100);
  EXPECT_DOUBLE_EQ(solver_bytes(cost, 3, true), 1600);
}

}  // namespace
}  // namespace palpate::test::test_solve_cost
