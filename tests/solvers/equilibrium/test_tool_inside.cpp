// SPDX-License-Identifier: BSD-3-Clause
// A rigid tool that is small beside the cells of the body goes through its surface when it is
// pressed deep. What presses it inside is no contact, or nothing: that is no equilibrium.
#include <gtest/gtest.h>

#include <string>

#include "equilibrium/equilibrium.h"
#include "interaction/interaction_list.h"
#include "interaction/rigid_tool.h"
#include "interaction/tool_clearance.h"
#include "solvers/support/block.h"
#include "solvers/support/box_mesh.h"
#include "solvers/support/message_of.h"
#include "solvers/support/orders.h"
#include "solvers/support/surfaces.h"

namespace palpate::test::test_tool_inside {
namespace {

constexpr double kHeight = 0.03;
/// Between the points of the mesh.
const Vec3 kAbove(0.0233, 0.0225, kHeight);

/// Edges of 10 mm.
Scene make_coarse(ElementOrder order) {
  const TetMesh mesh = make_box(order, {4, 4, 3}, Vec3(0.04, 0.04, kHeight));
  std::vector<char> fixed;
  for (const Vec3& p : mesh.points) fixed.push_back(p.z() == 0 ? 1 : 0);
  return make_scene(mesh, make_isotropic(Law::neo_hookean, 5000, 0.45), fixed);
}

RigidTool ball(double radius) {
  RigidTool tool;
  tool.radius = radius;
  // A thicker layer needs fewer points.
  tool.law.thickness = 0.4 * radius;
  return tool;
}

/// So deep in the flat surface.
Vec3 at_depth(double half_width, double depth) { return kAbove + Vec3(0, 0, half_width - depth); }

Equilibrium press(const Scene& scene, const RigidTool& tool, const Vec3& end,
                  std::unique_ptr<LinearSolver> linear_solver = make_linear_solver()) {
  const RigidContact contact = make_contact(scene.body, with_defaults(tool, scene));
  EquilibriumSolver solver(scene, {}, std::move(linear_solver));
  solver.set_interaction(contact);
  return solver.solve(end, solver.rest(ToolClearance(scene.body, {}, contact).start_for(end)));
}

/// Told, and the state is that of the last contact on the way.
void expect_inside(const Equilibrium& state, const Vec3& end) {
  EXPECT_EQ(state.outcome, Outcome::tool_inside) << state.summary.message;
  EXPECT_NE(state.summary.message.find("goes through the surface"), std::string::npos)
      << state.summary.message;
  EXPECT_NE(state.summary.message.find("edges of the mesh"), std::string::npos)
      << state.summary.message;
  EXPECT_GT((state.t - end).norm(), 0);
  EXPECT_LT(state.reaction[2], -0.01) << "it was pressed";
}

class ToolInside : public testing::TestWithParam<ElementOrder> {};
INSTANTIATE_TEST_SUITE_P(Each, ToolInside, testing::ValuesIn(kOrders), name_of_order);

TEST_P(ToolInside, ASmallBallIsTold) {
  const Scene scene = make_coarse(GetParam());
  const Vec3 end = at_depth(0.0015, 0.012);
  expect_inside(press(scene, ball(0.0015), end), end);
}

TEST_P(ToolInside, WithoutAFactorToo) {
  const Scene scene = make_coarse(GetParam());
  const Vec3 end = at_depth(0.0015, 0.012);
  expect_inside(press(scene, ball(0.0015), end, nullptr), end);
}

TEST_P(ToolInside, ARodThatLiesIsTold) {
  const Scene scene = make_coarse(GetParam());
  RigidTool rod = ball(0.0015);
  rod.shape = ToolShape::capsule;
  rod.axis = Vec3::UnitX();
  rod.length = 0.002;
  const Vec3 end = at_depth(0.0015, 0.012);
  expect_inside(press(scene, rod, end), end);
}

TEST_P(ToolInside, ASurfaceIsTold) {
  const Scene scene = make_coarse(GetParam());
  RigidTool tool;
  tool.shape = ToolShape::surface;
  const Surface sphere = icosphere(0.0015, 1);
  tool.points = sphere.points;
  tool.triangles = sphere.triangles;
  tool.law.thickness = 0.0006;
  const Vec3 end = at_depth(0.0015, 0.012);
  expect_inside(press(scene, tool, end), end);
}

TEST_P(ToolInside, OneOfTwoIsTold) {
  const Scene scene = make_coarse(GetParam());
  const RigidContact large = make_contact(scene.body, with_defaults(ball(0.008), scene));
  const RigidContact small = make_contact(scene.body, with_defaults(ball(0.0015), scene));
  InteractionList tools;
  tools.add(large);
  tools.add(small);
  EquilibriumSolver solver(scene, {});
  solver.set_interaction(tools);
  const Vec3 aside(0.012, 0.008, 0);
  Eigen::VectorXd start(6);
  start << at_depth(0.008, -0.004) - aside, at_depth(0.0015, -0.004);
  Eigen::VectorXd end(6);
  end << at_depth(0.008, 0.001) - aside, at_depth(0.0015, 0.012);
  EXPECT_EQ(solver.solve(end, solver.rest(start)).outcome, Outcome::tool_inside);
}

// One that the cells resolve is not taken for that, however deep it is.
TEST_P(ToolInside, ALargeBallIsNot) {
  const Scene scene = make_coarse(GetParam());
  const Equilibrium state = press(scene, ball(0.008), at_depth(0.008, 0.008));
  EXPECT_EQ(state.outcome, Outcome::converged) << state.summary.message;
  EXPECT_LT(state.reaction[2], -0.5);
}

// Touched by nothing, it would be taken for one that is clear of the body.
TEST_P(ToolInside, NoRestBeginsThere) {
  const Scene scene = make_coarse(GetParam());
  EquilibriumSolver solver(scene, {});
  solver.set_interaction(make_contact(scene.body, with_defaults(ball(0.001), scene)));
  const std::string message = message_of([&] { (void)solver.rest(at_depth(0.001, 0.015)); });
  EXPECT_NE(message.find("inside the body"), std::string::npos) << message;
}

}  // namespace
}  // namespace palpate::test::test_tool_inside
