// SPDX-License-Identifier: BSD-3-Clause
// Bodies of which a piece floats, or a part turns: each solve says which, and comes to an end.
#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <memory>
#include <tuple>
#include <utility>

#include "equilibrium/equilibrium.h"
#include "interaction/bonded_patch.h"
#include "interaction/rigid_tool.h"
#include "solvers/support/block.h"
#include "solvers/support/bodies.h"
#include "solvers/support/laws.h"

namespace palpate::test::test_unheld_pieces {
namespace {

const Vec3 kSize(0.04, 0.02, 0.02);
constexpr double kRadius = 0.008;
const Vec3 kAboveTheFirst(0.01, 0.01, kSize.z() + kRadius);

using Where = std::function<bool(const Vec3&)>;

bool at_bottom(const Vec3& p) { return p.z() == 0; }

/// A box and a copy of it that is moved, fixed where `held` says.
Scene make_two(const Vec3& shift, const Where& held) {
  TetMesh mesh = make_box(ElementOrder::linear, {4, 2, 2}, kSize);
  add_copy(mesh, shift);
  std::vector<char> fixed;
  for (const Vec3& p : mesh.points) fixed.push_back(held(p) ? 1 : 0);
  return make_scene(std::move(mesh), make_isotropic(Law::neo_hookean, 5000, 0.3), fixed);
}

/// Points at the same place are one.
void merge_points(TetMesh& mesh) {
  std::map<std::tuple<double, double, double>, Index> first;
  for (Index& p : mesh.cells) {
    const Vec3& at = mesh.points[p];
    p = first.emplace(std::tuple(at.x(), at.y(), at.z()), p).first->second;
  }
}

RigidContact make_sphere_for(const Scene& scene) {
  RigidTool tool;
  tool.radius = kRadius;
  return make_contact(scene.body, with_defaults(tool, scene));
}

std::unique_ptr<LinearSolver> solver_named(bool is_direct) {
  return is_direct ? make_linear_solver() : nullptr;
}

/// What is wrong with pressing a sphere into the top of the first box; empty where it converges.
std::string press(const Scene& scene, bool is_direct) {
  EquilibriumSolver solver(scene, {}, solver_named(is_direct));
  solver.set_interaction(make_sphere_for(scene));
  const Equilibrium rest = solver.rest(kAboveTheFirst + Vec3(0, 0, 0.01));
  EXPECT_TRUE(rest.outcome == Outcome::converged || !rest.summary.message.empty());
  const Equilibrium state = solver.solve(kAboveTheFirst - Vec3(0, 0, 0.002), rest);
  EXPECT_TRUE(state.u.allFinite());
  return state.outcome == Outcome::converged ? "" : state.summary.message;
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

class AnySolver : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(UnheldPieces, AnySolver, testing::Bool(),
                         [](const auto& each) { return each.param ? "Direct" : "Iterative"; });

TEST_P(AnySolver, APieceThatNothingHoldsIsNamed) {
  const std::string message = press(make_two({0, 0, 0.05}, at_bottom), GetParam());
  EXPECT_TRUE(contains(message, "96 cells, 1.6e-05 m³, around (0.02, 0.01, 0.06) m")) << message;
}

TEST(UnheldPieces, ItsWeightFindsNoRest) {
  Scene scene = make_two({0, 0, 0.05}, at_bottom);
  scene.organ.body_force = Vec3(0, 0, -9.81);
  scene.organ.densities = {1000};
  const EquilibriumSolver solver(scene, {});
  EXPECT_NE(solver.settled().outcome, Outcome::converged);
  EXPECT_TRUE(contains(solver.settled().summary.message, "one of them is not held"))
      << solver.settled().summary.message;
}

// It follows the tool as a rigid body.
TEST(UnheldPieces, ABondedPatchHoldsOne) {
  const Scene scene = make_two({0, 0, 0.05}, at_bottom);
  EquilibriumSolver solver(scene, {});
  const Index node = nearest_point(scene.body.mesh, {0.02, 0.01, 0.07});
  solver.set_interaction(BondedPatches(scene.body, 0.011).around(node));
  const Vec3 way(0.002, 0.001, 0.003);
  const Equilibrium state = solver.solve(way, solver.rest());
  ASSERT_EQ(state.outcome, Outcome::converged) << state.summary.message;
  EXPECT_LE(state.reaction.norm(), 1e-10);
  const Index far = nearest_point(scene.body.mesh, {0, 0, 0.05});
  EXPECT_LE((state.u.segment<3>(3 * far) - way).norm(), 1e-9);
}

TEST_P(AnySolver, APieceThatTurnsIsNamed) {
  const auto on_a_line = [](const Vec3& p) { return p.z() == 0.05 && p.y() == 0; };
  const Scene scene =
      make_two({0, 0, 0.05}, [&](const Vec3& p) { return at_bottom(p) || on_a_line(p); });
  const std::string message = press(scene, GetParam());
  EXPECT_TRUE(contains(message, "around (0.02, 0.01, 0.06) m is not held but along one line"))
      << message;
  EXPECT_TRUE(contains(message, "Fix three points")) << message;
}

// The points of one edge are shared.
TEST_P(AnySolver, APartThatTurnsIsNamed) {
  Scene scene = make_two({kSize.x(), 0, kSize.z()}, at_bottom);
  merge_points(scene.body.mesh);
  const std::string message = press(scene, GetParam());
  EXPECT_TRUE(contains(message, "around (0.06, 0.01, 0.03) m is not held but along one line"))
      << message;
  EXPECT_TRUE(contains(message, "shares no face")) << message;
}

TEST_P(AnySolver, TwoPiecesThatAreHeldArePressed) {
  const Scene scene =
      make_two({0, 0, 0.05}, [](const Vec3& p) { return p.z() == 0 || p.z() == 0.05; });
  EXPECT_EQ(press(scene, GetParam()), "");
}

}  // namespace
}  // namespace palpate::test::test_unheld_pieces
