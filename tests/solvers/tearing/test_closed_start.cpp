// SPDX-License-Identifier: BSD-3-Clause
#include "tearing/closed_start.h"

#include <gtest/gtest.h>

#include "cutting/opened_scene.h"
#include "equilibrium/tangent_solver.h"
#include "solvers/support/cut_cube.h"

namespace palpate::test::test_closed_start {
namespace {

InteractionList make_tool(const Scene& scene) {
  return bond_as_one(points_where(scene.body.mesh,
                                  [](const Vec3& x) { return x.z() > 1 - 1e-9 && x.x() < 0.51; }));
}

class ClosedStartOf : public testing::TestWithParam<ElementOrder> {};
INSTANTIATE_TEST_SUITE_P(Orders, ClosedStartOf,
                         testing::Values(ElementOrder::linear, ElementOrder::quadratic));

TEST_P(ClosedStartOf, LeadsToTheEquilibriumThatIsFoundFromRest) {
  const Scene closed = make_cut_scene(GetParam());
  const Scene scene = open_scene(closed, 3).scene;
  ASSERT_TRUE(ClosedStart::helps(scene));
  EquilibriumSolver solver(scene, EquilibriumOptions());
  solver.set_interaction(make_tool(scene));
  ClosedStart start(scene, EquilibriumOptions(), make_linear_solver());
  // The closed body has the cells of that before the cut, and its points.
  EXPECT_EQ(start.closed().body.mesh.cells, closed.body.mesh.cells);
  start.set_interaction(make_tool(closed), Vec3::Zero());
  for (const Vec3& way : {Vec3(0, 0, -0.05), Vec3(0.03, 0, -0.08), Vec3(0, 0, 0.1)}) {
    const Equilibrium right = solver.solve(way, solver.rest());
    ASSERT_EQ(right.outcome, Outcome::converged);
    const auto found = start.solve(solver, way);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->energy / right.energy, 1, 1e-8);
    EXPECT_TRUE(found->reaction.isApprox(right.reaction, 1e-6));
    EXPECT_TRUE(found->stiffness.isApprox(right.stiffness, 1e-4));
    EXPECT_LT(found->summary.iterations, 40);
  }
}

TEST(ClosedStart, IsOfUseForAnOpenCutWithoutLoads) {
  const Scene closed = make_cut_scene(ElementOrder::linear);
  EXPECT_FALSE(ClosedStart::helps(closed));
  Scene scene = open_scene(closed, 2).scene;
  EXPECT_TRUE(ClosedStart::helps(scene));
  scene.organ.touching = TouchingParts::none;
  EXPECT_FALSE(ClosedStart::helps(scene));
  scene = open_scene(closed, 2).scene;
  scene.organ.body_force = Vec3(0, 0, -9.81);
  scene.organ.densities = {1000};
  EXPECT_FALSE(ClosedStart::helps(scene));
}

TEST(ClosedStart, NothingIsSaidWhereTheClosedBodyFindsNoEquilibrium) {
  const Scene scene = open_scene(make_cut_scene(ElementOrder::linear), 3).scene;
  EquilibriumSolver solver(scene, EquilibriumOptions());
  solver.set_interaction(make_tool(scene));
  EquilibriumOptions options;
  options.abort_requested = [] { return true; };
  ClosedStart start(scene, options, make_linear_solver());
  start.set_interaction(make_tool(start.closed()), Vec3::Zero());
  EXPECT_FALSE(start.solve(solver, Vec3(0, 0, -0.05)));
}

}  // namespace
}  // namespace palpate::test::test_closed_start
