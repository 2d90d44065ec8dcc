// SPDX-License-Identifier: BSD-3-Clause
// An instrument that pivots about a trocar.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>
#include <string>

#include "base/error.h"
#include "equilibrium/equilibrium.h"
#include "interaction/interaction_spec.h"
#include "interaction/motion_kind.h"
#include "interaction/rigid_contact.h"
#include "interaction/trocar_pose.h"
#include "solvers/interaction/jets.h"
#include "solvers/support/block.h"
#include "solvers/support/finite_difference.h"
#include "solvers/support/message_of.h"

namespace palpate::test::test_trocar_pose {
namespace {

constexpr double kRadius = 0.006;
constexpr double kLength = 0.03;

/// Above the middle of a block, for a rod whose axis is along x when it is made.
Trocar trocar_above(const Vec3& place = {0.09, 0.01, 0.17}) {
  Trocar trocar;
  trocar.place = place;
  trocar.axis = Vec3::UnitX();
  trocar.tip = Vec3(-0.5 * kLength, 0, 0);
  trocar.towards = Vec3(0.1, -0.1, 1).normalized();
  return trocar;
}

RigidTool rod_through(const Trocar& trocar) {
  RigidTool rod;
  rod.shape = ToolShape::capsule;
  rod.radius = kRadius;
  rod.axis = Vec3::UnitX();
  rod.length = kLength;
  rod.motion = ToolMotion::trocar;
  rod.motion_numbers = trocar.numbers();
  return rod;
}

TEST(TrocarPose, TheAxisGoesThroughTheTrocar) {
  const Trocar trocar = trocar_above();
  const PoseMapPtr map = trocar_pose(trocar);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> anywhere(-0.05, 0.05);
  for (int n = 0; n < 100; ++n) {
    const Vec3 q =
        Vec3(0.05, 0.03, 0.06) + Vec3(anywhere(random), anywhere(random), anywhere(random));
    const Pose pose = map->at(q);
    EXPECT_LT((pose.in_scene(trocar.tip) - q).norm(), 1e-15);
    EXPECT_LT((pose.rotation.transpose() * pose.rotation - Mat3::Identity()).norm(), 1e-14);
    EXPECT_NEAR(pose.rotation.determinant(), 1, 1e-14);
    const Vec3 axis = pose.rotation * trocar.axis;
    EXPECT_LT(axis.cross(trocar.place - q).norm(), 1e-15);
    EXPECT_GT(axis.dot(trocar.place - q), 0);
    const PoseJet jet = map->evaluate(q, 0);
    EXPECT_EQ(jet.place, pose.place);
    EXPECT_EQ(jet.rotation, pose.rotation);
  }
}

TEST(TrocarPose, DerivativesAreThoseOfThePose) {
  const PoseMapPtr map = trocar_pose(trocar_above());
  for (const Vec3& q : {Vec3(0.05, 0.03, 0.055), Vec3(0.01, 0.07, 0.02), Vec3(0.2, 0, 0.1)}) {
    const PoseJet jet = map->evaluate(q, 2);
    ASSERT_TRUE(jet.turns);
    for (int i = 0; i < 3; ++i) {
      const auto at = [&](double s) { return map->evaluate(q + s * Vec3::Unit(i), 1); };
      const Vec3 place = derivative([&](double s) { return at(s).place; }, 1e-4);
      const Mat3 rotation = derivative([&](double s) { return at(s).rotation; }, 1e-4);
      EXPECT_LT((jet.place_by[i] - place).norm(), 1e-8);
      EXPECT_LT((jet.rotation_by[i] - rotation).norm(), 1e-6);
      for (int j = 0; j < 3; ++j) {
        const Vec3 place_by = derivative([&](double s) { return at(s).place_by[j]; }, 1e-4);
        const Mat3 turn_by = derivative([&](double s) { return at(s).rotation_by[j]; }, 1e-4);
        EXPECT_LT((jet.place_by_two[i][j] - place_by).norm(), 1e-5);
        EXPECT_LT((jet.rotation_by_two[i][j] - turn_by).norm(), 1e-4);
      }
    }
  }
}

// No point of the tool moves farther than the clearance counts with.
TEST(TrocarPose, StretchBoundsTheWayOfEachPoint) {
  const Trocar trocar = trocar_above();
  const PoseMapPtr map = trocar_pose(trocar);
  const Eigen::AlignedBox3d bounds(Vec3(-0.021, -0.006, -0.006), Vec3(0.021, 0.006, 0.006));
  std::mt19937 random(4);
  std::uniform_real_distribution<double> unit(-1, 1);
  double largest = 0;
  for (int n = 0; n < 2000; ++n) {
    const Vec3 q = Vec3(0.05, 0.03, 0.06) + 0.06 * Vec3(unit(random), unit(random), unit(random));
    const auto [most, within] = map->stretch(q, bounds);
    const Vec3 way = within * Vec3(unit(random), unit(random), unit(random)) / 2;
    const Vec3 y = bounds.center() + 0.5 * bounds.sizes().cwiseProduct(
                                               Vec3(unit(random), unit(random), unit(random)));
    const double moved = (map->at(q + way).in_scene(y) - map->at(q).in_scene(y)).norm();
    EXPECT_LE(moved, most * way.norm());
    largest = std::max(largest, moved / way.norm() / most);
  }
  EXPECT_GT(largest, 0.6);
}

TEST(TrocarPose, ATipBehindTheTrocarAndBadNumbersAreRefused) {
  const PoseMapPtr map = trocar_pose(trocar_above());
  EXPECT_NO_THROW(map->check(Vec3(0.05, 0.03, 0.06)));
  for (const Vec3& q : {Vec3(0.09, 0.01, 0.17), Vec3(0.1, 0.0, 0.4)}) {
    EXPECT_NE(message_of([&] { map->check(q); }).find("TrocarPoint"), std::string::npos);
  }
  std::vector<double> numbers = trocar_above().numbers();
  EXPECT_NO_THROW((void)motion_kind(ToolMotion::trocar).make(numbers));
  numbers[3] = 2;
  EXPECT_THROW((void)motion_kind(ToolMotion::trocar).make(numbers), InputError);
  EXPECT_THROW((void)motion_kind(ToolMotion::trocar).make({1, 2, 3}), InputError);
}

TEST(TrocarPose, ATipBeyondTheConeOrTooDeepIsRefused) {
  Trocar trocar = trocar_above();
  trocar.towards = Vec3::UnitZ();
  trocar.tilt = 0.3;
  trocar.depth = 0.12;
  const PoseMapPtr map = trocar_pose(trocar);
  const auto below = [&](double depth, double tilt) {
    return Vec3(trocar.place - depth * Vec3(std::sin(tilt), 0, std::cos(tilt)));
  };
  const auto error = [&](const Vec3& q) { return message_of([&] { map->check(q); }); };
  for (const auto& [depth, tilt] : {std::pair(0.1, 0.29), {0.11, -0.29}, {0.119, 0.0}}) {
    EXPECT_TRUE(map->allows(below(depth, tilt)));
    EXPECT_NO_THROW(map->check(below(depth, tilt)));
  }
  for (const double tilt : {0.31, -0.31, 1.5, 2.0}) {
    EXPECT_FALSE(map->allows(below(0.1, tilt)));
    EXPECT_NE(error(below(0.1, tilt)).find(tilt < 1.57 ? "MaximumTilt" : "beyond it"),
              std::string::npos);
  }
  EXPECT_FALSE(map->allows(below(0.121, 0)));
  EXPECT_NE(error(below(0.121, 0)).find("MaximumDepth"), std::string::npos);
  EXPECT_FALSE(map->allows(trocar.place));
  trocar.tilt = 1.7;
  EXPECT_THROW((void)Trocar::from(trocar.numbers()), InputError);
}

/// The rod pressed into the top of a block from above, 3 mm deep.
struct Pressed {
  explicit Pressed(const Trocar& trocar, bool third = false)
      : block(make_block(Law::neo_hookean)),
        tool(rigid_contact_spec(with_defaults(rod_through(trocar), block.scene))),
        tools(block.scene.body, {}) {
    EquilibriumOptions options;
    options.third_derivatives = third;
    solver = std::make_unique<EquilibriumSolver>(block.scene, options);
    solver->set_interaction(*tools.make(tool));
    const auto clearance = tools.clearance(tool);
    place = clearance->pressed(Vec3(0.05, 0.03, 0.05), Vec3::UnitZ(), 0.003);
    start = solver->rest(clearance->start_for(place));
  }
  [[nodiscard]] Equilibrium at(const Vec3& q) { return solver->solve(q, start); }

  Block block;
  InteractionSpec tool;
  InteractionFactory tools;
  std::unique_ptr<EquilibriumSolver> solver;
  Vec3 place = Vec3::Zero();
  Equilibrium start;
};

TEST(TrocarPose, ForceStiffnessAndThirdDerivativeAreThoseOfTheEnergy) {
  Pressed pressed(trocar_above(), true);
  const Equilibrium here = pressed.at(pressed.place);
  ASSERT_EQ(here.outcome, Outcome::converged) << here.summary.message;
  EXPECT_GT(here.reaction.norm(), 0.01);
  constexpr double kStep = 2e-5;
  for (int i = 0; i < 3; ++i) {
    const auto moved = [&](double s) { return pressed.at(pressed.place + s * Vec3::Unit(i)); };
    const double force = derivative([&](double s) { return moved(s).energy; }, kStep);
    EXPECT_NEAR(here.reaction[i], force, 1e-4 * here.reaction.norm());
    const Vec3 column = derivative([&](double s) -> Vec3 { return moved(s).reaction; }, kStep);
    EXPECT_LT((here.stiffness.col(i) - column).norm(), 1e-4 * here.stiffness.norm());
    const Mat3 third = derivative([&](double s) -> Mat3 { return moved(s).stiffness; }, kStep);
    RigidShape::Jet jet;
    jet.third = here.third_derivative;
    EXPECT_LT((third_along(jet, i) - third).norm(), 1e-2 * third.norm());
  }
  EXPECT_LT((here.stiffness - here.stiffness.transpose()).norm(), 1e-8 * here.stiffness.norm());
}

// The body is in balance: force and moment of what holds it are those of the tool. The moment of
// the tool about the trocar is (q − o) × h, since it slides there without friction.
TEST(TrocarPose, MomentsAreInBalance) {
  const Trocar trocar = trocar_above();
  Pressed pressed(trocar);
  const Equilibrium here = pressed.at(pressed.place);
  ASSERT_EQ(here.outcome, Outcome::converged) << here.summary.message;
  const RigidContact& contact = pressed.tools.contact(pressed.tool.tool);
  NodalVector force = NodalVector::Zero(here.u.size());
  Eigen::VectorXd of_q = Eigen::VectorXd::Zero(3);
  (void)contact.potential(pressed.place, here.u, force, of_q);
  Vec3 sum = Vec3::Zero(), moment = Vec3::Zero();
  const auto& points = pressed.block.scene.body.mesh.points;
  for (std::size_t p = 0; p < points.size(); ++p) {
    const auto at = 3 * static_cast<Eigen::Index>(p);
    // On the tool.
    const Vec3 f = force.segment<3>(at);
    sum += f;
    moment += (points[p] + here.u.segment<3>(at) - trocar.place).cross(f);
  }
  const Vec3 h = of_q;
  EXPECT_LT((h - here.reaction).norm(), 1e-6 * h.norm());
  const Vec3 torque = (pressed.place - trocar.place).cross(h);
  EXPECT_LT((torque + moment).norm(), 1e-6 * torque.norm())
      << torque.transpose() << " | " << moment.transpose();
  // Along the axis nothing turns, so that force and generalised force agree.
  const Vec3 axis = (trocar.place - pressed.place).normalized();
  EXPECT_NEAR(axis.dot(h), -axis.dot(sum), 1e-6 * h.norm());
}

}  // namespace
}  // namespace palpate::test::test_trocar_pose
