// SPDX-License-Identifier: BSD-3-Clause
// Tools of finite size: patches of the surface that move with the tip of a tool.
#include "interaction/bonded_patch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <string>

#include "base/error.h"
#include "solvers/equilibrium/options.h"
#include "solvers/support/block.h"
#include "solvers/support/finite_difference.h"
#include "solvers/support/laws.h"

namespace palpate::test::test_bonded_patch {
namespace {

/// Reaches over a brick of the block's far end.
constexpr double kRadius = 0.02;

/// Point of the surface nearest to a place.
Index surface_point(const Scene& scene, const Vec3& place) {
  const auto on_surface = boundary_points(scene.body.mesh);
  Index best = -1;
  for (Index p = 0; p < scene.body.mesh.num_points(); ++p) {
    const auto distance = [&](Index q) { return (scene.body.mesh.points[q] - place).norm(); };
    if (on_surface[p] != 0 && (best < 0 || distance(p) < distance(best))) best = p;
  }
  return best;
}

std::string error_of(const Scene& scene, double radius, const std::vector<Index>& nodes) {
  try {
    (void)BondedPatches(scene.body, radius).around_each(nodes);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

void expect_mentions(const std::string& message, const std::vector<std::string>& words) {
  for (const std::string& word : words) {
    EXPECT_NE(message.find(word), std::string::npos) << word << " is not in: " << message;
  }
}

class BondedPatchTest : public testing::Test {
 protected:
  /// Two nodes, one a corner of the far end and one on the side.
  [[nodiscard]] std::vector<Index> two_nodes() const {
    return {block_.corner, surface_point(block_.scene, Vec3(0.06, 0, 0.025))};
  }

  Block block_ = make_block(Law::neo_hookean);
};

TEST_F(BondedPatchTest, WithoutRadiusTheNodesAloneAreBonded) {
  const InteractionList tools = BondedPatches(block_.scene.body, 0).around_each(two_nodes());
  EXPECT_EQ(tools.num_coordinates(), 6);
  const std::vector<PrescribedPoint> points = tools.prescribed_points();
  ASSERT_EQ(points.size(), 2U);
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(points[i].point, two_nodes()[i]);
    EXPECT_EQ(points[i].coordinate, 3 * i);
  }
}

TEST_F(BondedPatchTest, PointsOfAPatchMoveAsOneAndTheirForcesAddUp) {
  const BondedPatch patch = BondedPatches(block_.scene.body, kRadius).around(block_.corner);
  ASSERT_GT(patch.points().size(), 4U);
  const Eigen::VectorXd t = Vec3(0.005, -0.004, 0.006);
  EquilibriumSolver solver(block_.scene, {});
  solver.set_interaction(patch);
  const Equilibrium tip = solver.solve(t, solver.rest());
  ASSERT_EQ(tip.outcome, Outcome::converged) << tip.summary.message;
  for (const Index p : patch.points()) EXPECT_EQ(tip.u.segment<3>(3 * p), t);

  // The same with a tool at each point.
  solver.set_interaction(bond_nodes(patch.points()));
  const auto n = static_cast<Eigen::Index>(patch.points().size());
  const Equilibrium apart = solver.solve(t.replicate(n, 1), solver.rest());
  ASSERT_EQ(apart.outcome, Outcome::converged) << apart.summary.message;
  Vec3 sum = Vec3::Zero();
  Mat3 stiffness = Mat3::Zero();
  for (Eigen::Index a = 0; a < n; ++a) {
    sum += apart.reaction.segment<3>(3 * a);
    for (Eigen::Index b = 0; b < n; ++b) stiffness += apart.stiffness.block<3, 3>(3 * a, 3 * b);
  }
  // Both are solved to 1e-10 of the forces at the points.
  EXPECT_LT((tip.reaction - sum).norm(), 1e-7 * sum.norm());
  EXPECT_LT((tip.stiffness - stiffness).norm(), 1e-7 * stiffness.norm());
  EXPECT_NEAR(tip.energy, apart.energy, 1e-9 * tip.energy);
}

TEST_F(BondedPatchTest, ALargerTipIsStiffer) {
  double last = 0;
  for (const double radius : {0.0, 0.015, kRadius, 0.03}) {
    EquilibriumSolver solver(block_.scene, {});
    solver.set_interaction(BondedPatches(block_.scene.body, radius).around(block_.middle));
    const double stiffness = solver.rest().stiffness.trace();
    EXPECT_GT(stiffness, last) << radius;
    last = stiffness;
  }
}

TEST_F(BondedPatchTest, SeveralToolsSuperposeInALinearScene) {
  const Block linear = make_block(Law::linear);
  EquilibriumSolver solver(linear.scene, {});
  solver.set_interaction(BondedPatches(linear.scene.body, kRadius).around_each(two_nodes()));
  Eigen::VectorXd both(6);
  both << 0.004, 0.002, -0.003, -0.001, 0.0035, 0.002;
  Eigen::VectorXd first = both;
  first.tail<3>().setZero();
  const Equilibrium rest = solver.rest();
  const Equilibrium a = solver.solve(first, rest);
  const Equilibrium b = solver.solve(both - first, rest);
  const Equilibrium sum = solver.solve(both, rest);
  ASSERT_EQ(sum.outcome, Outcome::converged);
  constexpr double kRounding = 1e-9;
  EXPECT_LT((sum.u - a.u - b.u).norm(), kRounding * sum.u.norm());
  EXPECT_LT((sum.reaction - a.reaction - b.reaction).norm(), kRounding * sum.reaction.norm());
  EXPECT_LT((sum.reaction - rest.stiffness * both).norm(), kRounding * sum.reaction.norm());
  EXPECT_NEAR(sum.energy, both.dot(rest.stiffness * both) / 2, kRounding * sum.energy);
}

TEST_F(BondedPatchTest, ForcesAndStiffnessOfSeveralToolsAreDerivativesOfTheEnergy) {
  for (const Law law : {Law::neo_hookean, Law::mooney_rivlin}) {
    const Block block = make_block(law);
    // As in test_derivatives.cpp.
    constexpr double kStep = 2e-4;
    constexpr double kDifference = 1e-7;
    EquilibriumSolver solver(block.scene, with_tolerance(1e-13));
    solver.set_interaction(BondedPatches(block.scene.body, kRadius).around_each(two_nodes()));
    Eigen::VectorXd t(6);
    t << 0.004, 0.002, -0.003, -0.001, 0.0035, 0.002;
    const Equilibrium state = solver.solve(t, solver.rest());
    ASSERT_EQ(state.outcome, Outcome::converged) << state.summary.message;
    const auto moved = [&](Eigen::Index i, double step) {
      return solver.solve(t + step * Eigen::VectorXd::Unit(6, i), state);
    };
    for (Eigen::Index i = 0; i < 6; ++i) {
      const double h = derivative([&](double s) { return moved(i, s).energy; }, kStep);
      EXPECT_NEAR(state.reaction[i], h, kDifference * state.reaction.norm());
      const Eigen::VectorXd k = derivative([&](double s) { return moved(i, s).reaction; }, kStep);
      EXPECT_LT((state.stiffness.col(i) - k).norm(), kDifference * state.stiffness.norm());
    }
  }
}

TEST_F(BondedPatchTest, RefusesPlacesWhereNoTipCanBe) {
  const Scene& scene = block_.scene;
  expect_mentions(error_of(scene, 0, {}), {"No active node"});
  for (const Index node : {-1, scene.body.mesh.num_points()}) {
    expect_mentions(error_of(scene, 0, {node}), {std::to_string(node), "does not exist"});
  }
  const auto on_surface = boundary_points(scene.body.mesh);
  const auto inside =
      static_cast<Index>(std::find(on_surface.begin(), on_surface.end(), 0) - on_surface.begin());
  expect_mentions(error_of(scene, 0, {inside}), {std::to_string(inside), "inside"});
  const auto fixed = static_cast<Index>(
      std::find(scene.body.fixed.begin(), scene.body.fixed.end(), 1) - scene.body.fixed.begin());
  expect_mentions(error_of(scene, 0, {fixed}), {std::to_string(fixed), "fixed"});
  expect_mentions(error_of(scene, kRadius, {block_.corner, block_.corner}), {"named twice"});
  Scene loose = scene;
  loose.body.mesh.points.emplace_back(1, 1, 1);
  loose.body.fixed.push_back(0);
  loose.body.touchable.push_back(0);
  expect_mentions(error_of(loose, 0, {scene.body.mesh.num_points()}), {"no cell"});
  for (const double radius : {-1.0, std::numeric_limits<double>::quiet_NaN()}) {
    expect_mentions(error_of(scene, radius, {block_.corner}), {"tip radius"});
  }
}

TEST_F(BondedPatchTest, RefusesPatchesThatReachAFixedPointOrEachOther) {
  const Scene& scene = block_.scene;
  const Index near_fixed = surface_point(scene, Vec3(0.03, 0, 0));
  ASSERT_EQ(error_of(scene, 0, {near_fixed}), "");
  expect_mentions(error_of(scene, 0.04, {near_fixed}),
                  {std::to_string(near_fixed), "0.04 m", "fixed", "smaller tip radius"});
  EXPECT_EQ(error_of(scene, 0.01, {block_.corner, block_.middle}), "");
  expect_mentions(error_of(scene, 0.03, {block_.corner, block_.middle}),
                  {std::to_string(block_.corner), std::to_string(block_.middle), "0.03 m", "share",
                   "smaller tip radius"});
}

}  // namespace
}  // namespace palpate::test::test_bonded_patch
