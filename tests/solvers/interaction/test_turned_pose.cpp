// SPDX-License-Identifier: BSD-3-Clause
// A tool that is turned freely: force and torque.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>
#include <string>

#include "base/error.h"
#include "equilibrium/equilibrium.h"
#include "equilibrium/third_derivative.h"
#include "interaction/interaction_spec.h"
#include "interaction/motion_kind.h"
#include "interaction/rigid_contact.h"
#include "interaction/turned_pose.h"
#include "solvers/support/block.h"
#include "solvers/support/box_mesh.h"
#include "solvers/support/finite_difference.h"
#include "solvers/support/message_of.h"

namespace palpate::test::test_turned_pose {
namespace {

constexpr double kRadius = 0.006;
constexpr double kLength = 0.03;

Eigen::Quaterniond turn(double degrees, const Vec3& about) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(degrees * M_PI / 180, about.normalized()));
}

/// For a rod along x that stands where it is not turned. Its reference point is on the axis: the
/// torque about the centre of a round end that alone is pressed is zero.
Turning standing(bool is_round) {
  Turning turning;
  if (is_round) turning.axis = Vec3::UnitX();
  turning.point = Vec3(0.1 * kLength, 0, 0);
  turning.orientation = turn(-90, Vec3::UnitY());
  turning.lever = 0.02;
  turning.farthest = 2;
  return turning;
}

RigidTool rod(const Turning& turning) {
  RigidTool rod;
  rod.shape = ToolShape::capsule;
  rod.radius = kRadius;
  rod.axis = Vec3::UnitX();
  rod.length = kLength;
  rod.motion = ToolMotion::turned;
  rod.motion_numbers = turning.numbers();
  return rod;
}

Eigen::VectorXd random_coordinates(const Turning& turning, std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1, 1);
  Eigen::VectorXd q(3 + turning.num_angles());
  for (double& x : q) x = 0.02 * unit(random);
  return q;
}

TEST(TurnedPose, IsARotationAboutTheReferencePoint) {
  std::mt19937 random(5);
  for (const bool is_round : {true, false}) {
    const Turning turning = standing(is_round);
    const PoseMapPtr map = turned_pose(turning);
    ASSERT_EQ(map->num_coordinates(), is_round ? 5 : 6);
    for (int n = 0; n < 50; ++n) {
      const Eigen::VectorXd q = random_coordinates(turning, random);
      const Pose pose = map->at(q);
      EXPECT_LT((pose.in_scene(turning.point) - q.head<3>()).norm(), 1e-16);
      EXPECT_LT((pose.rotation.transpose() * pose.rotation - Mat3::Identity()).norm(), 1e-14);
      const Vec3 angles = turning.angles_at(q);
      EXPECT_LT((turning.coordinates(q.head<3>(), angles) - q).norm(), 1e-16);
      const Vec3 w = turning.axes() * angles;
      const Mat3 expected =
          Eigen::AngleAxisd(w.norm(), w.normalized()) * turning.orientation.toRotationMatrix();
      EXPECT_LT((pose.rotation - expected).norm(), 1e-14);
      EXPECT_LT((turning.orientation_at(angles).toRotationMatrix() - expected).norm(), 1e-14);
      EXPECT_LT((turning.angles_of(Eigen::Quaterniond(expected)) - angles).norm(), 1e-14);
      if (is_round) {
        // Rolling it about its own axis changes nothing.
        const Eigen::Quaterniond rolled = Eigen::Quaterniond(expected) * turn(70, turning.axis);
        EXPECT_LT((turning.angles_of(rolled) - angles).norm(), 1e-14);
      }
    }
  }
}

TEST(TurnedPose, DerivativesAreThoseOfThePose) {
  std::mt19937 random(6);
  for (const bool is_round : {true, false}) {
    const Turning turning = standing(is_round);
    const PoseMapPtr map = turned_pose(turning);
    const int d = map->num_coordinates();
    for (int n = 0; n < 4; ++n) {
      // Where nothing is turned, too.
      Eigen::VectorXd q = random_coordinates(turning, random);
      if (n == 0) q.tail(d - 3).setZero();
      if (n == 3) q.tail(d - 3) *= 3;
      const PoseJet jet = map->evaluate(q, 2);
      ASSERT_TRUE(jet.turns);
      for (int i = 0; i < d; ++i) {
        const auto at = [&](double s) {
          return map->evaluate(q + s * Eigen::VectorXd::Unit(d, i), 1);
        };
        const Vec3 place = derivative([&](double s) { return at(s).place; }, 1e-5);
        const Mat3 rotation = derivative([&](double s) { return at(s).rotation; }, 1e-5);
        EXPECT_LT((jet.place_by[i] - place).norm(), 1e-8);
        EXPECT_LT((jet.rotation_by[i] - rotation).norm(), 1e-8 / turning.lever);
        for (int j = 0; j < d; ++j) {
          const Vec3 place_by = derivative([&](double s) { return at(s).place_by[j]; }, 1e-5);
          const Mat3 turn_by = derivative([&](double s) { return at(s).rotation_by[j]; }, 1e-5);
          EXPECT_LT((jet.place_by_two[i][j] - place_by).norm(), 1e-8 / turning.lever);
          EXPECT_LT((jet.rotation_by_two[i][j] - turn_by).norm(),
                    1e-8 / (turning.lever * turning.lever));
        }
      }
    }
  }
}

// No point of the tool moves farther than the clearance counts with.
TEST(TurnedPose, StretchBoundsTheWayOfEachPoint) {
  const Turning turning = standing(false);
  const PoseMapPtr map = turned_pose(turning);
  const Eigen::AlignedBox3d bounds(Vec3(-0.021, -0.006, -0.006), Vec3(0.021, 0.006, 0.006));
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(-1, 1);
  double largest = 0;
  for (int n = 0; n < 2000; ++n) {
    const Eigen::VectorXd q = random_coordinates(turning, random);
    const Eigen::VectorXd way = random_coordinates(turning, random);
    const double most = map->stretch(q, bounds).most;
    const Vec3 y = bounds.center() + 0.5 * bounds.sizes().cwiseProduct(
                                               Vec3(unit(random), unit(random), unit(random)));
    const double moved = (map->at(q + way).in_scene(y) - map->at(q).in_scene(y)).norm();
    EXPECT_LE(moved, most * way.norm());
    largest = std::max(largest, moved / way.norm() / most);
  }
  EXPECT_GT(largest, 0.6);
}

TEST(TurnedPose, ATurnTooFarAndBadNumbersAreRefused) {
  Turning turning = standing(true);
  turning.farthest = 0.5;
  const PoseMapPtr map = turned_pose(turning);
  Eigen::VectorXd q = map->coordinates(Vec3::Zero());
  EXPECT_NO_THROW(map->check(q));
  q[3] = 0.51 * turning.lever;
  EXPECT_FALSE(map->allows(q));
  EXPECT_NE(message_of([&] { map->check(q); }).find("MaximumTurn"), std::string::npos);
  const MotionKind& kind = motion_kind(ToolMotion::turned);
  EXPECT_NO_THROW((void)kind.make(turning.numbers()));
  for (const auto& [number, value] :
       {std::pair(0, 2.0), {6, 0.9}, {10, 0.0}, {11, 4.0}, {12, 3.2}, {14, 0.1}}) {
    std::vector<double> numbers = turning.numbers();
    numbers[static_cast<std::size_t>(number)] = value;
    EXPECT_THROW((void)kind.make(numbers), InputError) << number;
  }
  EXPECT_THROW((void)kind.make({1, 2, 3}), InputError);
}

/// A rod that is pressed into the top of a block from above.
struct Pressed {
  Pressed(Scene scene_, const RigidTool& rod, const Vec3& top, double depth, bool third = false)
      : scene(std::move(scene_)),
        tool(rigid_contact_spec(with_defaults(rod, scene))),
        tools(scene.body, {}) {
    EquilibriumOptions options;
    options.third_derivatives = third;
    solver = std::make_unique<EquilibriumSolver>(scene, options);
    solver->set_interaction(contact());
    const auto clearance = tools.clearance(tool);
    const Vec3 end = clearance->pressed(top, Vec3::UnitZ(), depth);
    place = contact().coordinates(end);
    start = solver->rest(contact().coordinates(clearance->start_for(end)));
  }
  [[nodiscard]] const RigidContact& contact() { return tools.contact(tool.tool); }
  [[nodiscard]] Equilibrium at(const Eigen::VectorXd& q) { return solver->solve(q, start); }

  Scene scene;
  InteractionSpec tool;
  InteractionFactory tools;
  std::unique_ptr<EquilibriumSolver> solver;
  Eigen::VectorXd place;
  Equilibrium start;
};

Pressed pressed_aslant(Turning turning, bool third = false) {
  turning.angles.head<2>() = Eigen::Vector2d(0.3, -0.2);
  return {make_block(Law::neo_hookean).scene, rod(turning), Vec3(0.05, 0.03, 0.05), 0.003, third};
}

TEST(TurnedPose, ForceStiffnessAndThirdDerivativeAreThoseOfTheEnergy) {
  for (const bool is_round : {true, false}) {
    Pressed pressed = pressed_aslant(standing(is_round), true);
    const Equilibrium here = pressed.at(pressed.place);
    ASSERT_EQ(here.outcome, Outcome::converged) << here.summary.message;
    EXPECT_GT(here.reaction.norm(), 0.01);
    const Eigen::Index d = pressed.place.size();
    ASSERT_EQ(here.third_derivative.size(), num_third_derivatives(d));
    constexpr double kStep = 2e-5;
    std::vector<Eigen::MatrixXd> third;
    for (Eigen::Index i = 0; i < d; ++i) {
      const auto moved = [&](double s) {
        return pressed.at(pressed.place + s * Eigen::VectorXd::Unit(d, i));
      };
      const double force = derivative([&](double s) { return moved(s).energy; }, kStep);
      EXPECT_NEAR(here.reaction[i], force, 1e-4 * here.reaction.norm()) << i;
      const Eigen::VectorXd column =
          derivative([&](double s) -> Eigen::VectorXd { return moved(s).reaction; }, kStep);
      EXPECT_LT((here.stiffness.col(i) - column).norm(), 1e-4 * here.stiffness.norm()) << i;
      third.push_back(
          derivative([&](double s) -> Eigen::MatrixXd { return moved(s).stiffness; }, kStep));
    }
    double largest = 0;
    for (const Eigen::MatrixXd& of : third) largest = std::max(largest, of.cwiseAbs().maxCoeff());
    Eigen::Index next = 0;
    for (Eigen::Index a = 0; a < d; ++a) {
      for (Eigen::Index b = a; b < d; ++b) {
        for (Eigen::Index c = b; c < d; ++c) {
          EXPECT_NEAR(here.third_derivative[next++], third[a](b, c), 1e-2 * largest);
        }
      }
    }
    EXPECT_LT((here.stiffness - here.stiffness.transpose()).norm(), 1e-8 * here.stiffness.norm());
  }
}

/// Force and moment about the origin of what the tool does to the points of the body.
std::pair<Vec3, Vec3> acting(const Pressed& pressed, const RigidContact& contact,
                             const Equilibrium& here) {
  NodalVector force = NodalVector::Zero(here.u.size());
  Eigen::VectorXd of_q = Eigen::VectorXd::Zero(here.t.size());
  (void)contact.potential(here.t, here.u, force, of_q);
  Vec3 sum = Vec3::Zero(), moment = Vec3::Zero();
  const auto& points = pressed.scene.body.mesh.points;
  for (std::size_t p = 0; p < points.size(); ++p) {
    const auto at = 3 * static_cast<Eigen::Index>(p);
    const Vec3 f = -force.segment<3>(at);
    sum += f;
    moment += (points[p] + here.u.segment<3>(at)).cross(f);
  }
  return {sum, moment};
}

// The tool's force and torque are those of the forces on the surface.
TEST(TurnedPose, MomentsAreInBalance) {
  for (const bool is_round : {true, false}) {
    Pressed pressed = pressed_aslant(standing(is_round));
    const Equilibrium here = pressed.at(pressed.place);
    ASSERT_EQ(here.outcome, Outcome::converged) << here.summary.message;
    const auto [force, moment] = acting(pressed, pressed.contact(), here);
    const Vec3 h = here.reaction.head<3>();
    EXPECT_LT((h - force).norm(), 1e-8 * h.norm());
    const Vec3 torque = *torque_of(pressed.tool.tool, here.t, here.reaction);
    const Vec3 expected = moment - Vec3(here.t.head<3>()).cross(force);
    EXPECT_GT(expected.norm(), 0.01 * h.norm() * kRadius);
    EXPECT_LT((torque - expected).norm(), 1e-8 * h.norm() * kRadius)
        << torque.transpose() << " | " << expected.transpose();
  }
}

// Without a factor, five and six coordinates are solved for in columns of three and of one.
TEST(TurnedPose, IsTheSameWithoutAFactor) {
  for (const bool is_round : {true, false}) {
    Pressed pressed = pressed_aslant(standing(is_round));
    const Equilibrium expected = pressed.at(pressed.place);
    EquilibriumSolver solver(pressed.scene, {}, nullptr);
    solver.set_interaction(pressed.contact());
    const Equilibrium found = solver.solve(pressed.place, pressed.start);
    ASSERT_EQ(found.outcome, Outcome::converged) << found.summary.message;
    EXPECT_LT((found.reaction - expected.reaction).norm(), 1e-6 * expected.reaction.norm());
    EXPECT_LT((found.stiffness - expected.stiffness).norm(), 1e-5 * expected.stiffness.norm());
  }
}

TEST(TurnedPose, ARotatedSceneHasTheRotatedAnswer) {
  const Block block = make_block(Law::neo_hookean);
  const Mat3 by = turn(50, Vec3(1, -2, 3)).toRotationMatrix();
  Turning turning = standing(true);
  turning.orientation = turn(20, Vec3::UnitX()) * turning.orientation;
  Turning rotated = turning;
  rotated.orientation = Eigen::Quaterniond(by) * turning.orientation;
  Scene turned = block.scene;
  for (Vec3& p : turned.body.mesh.points) p = by * p;

  Pressed one(block.scene, rod(turning), Vec3(0.05, 0.03, 0.05), 0.003);
  const Equilibrium here = one.at(one.place);
  InteractionFactory tools(turned.body, {});
  const InteractionSpec spec = rigid_contact_spec(with_defaults(rod(rotated), turned));
  const RigidContact& contact = tools.contact(spec.tool);
  EquilibriumSolver solver(turned, {});
  solver.set_interaction(contact);
  const Equilibrium there =
      solver.solve(contact.coordinates(by * one.place.head<3>()),
                   solver.rest(contact.coordinates(by * one.start.t.head<3>())));
  ASSERT_EQ(here.outcome, Outcome::converged);
  ASSERT_EQ(there.outcome, Outcome::converged);
  EXPECT_NEAR(there.energy, here.energy, 1e-9 * here.energy);
  const Vec3 force = by * here.reaction.head<3>();
  EXPECT_LT((there.reaction.head<3>() - force).norm(), 1e-8 * force.norm());
  const Vec3 torque = by * *torque_of(one.tool.tool, here.t, here.reaction);
  EXPECT_GT(torque.norm(), 1e-3 * force.norm() * kRadius);
  EXPECT_LT((*torque_of(spec.tool, there.t, there.reaction) - torque).norm(),
            1e-8 * force.norm() * kRadius);
}

/// A mesh of linear cells and what it is on the other side of a plane through the origin.
TetMesh with_mirror_image(const TetMesh& mesh, int axis) {
  TetMesh both = mesh;
  std::vector<Index> image;
  for (const Vec3& p : mesh.points) {
    if (std::abs(p[axis]) < 1e-12) {
      image.push_back(static_cast<Index>(image.size()));
      continue;
    }
    image.push_back(both.num_points());
    both.points.push_back(p);
    both.points.back()[axis] *= -1;
  }
  for (std::size_t c = 0; c < mesh.cells.size(); c += 4) {
    for (const std::size_t corner : {1, 0, 2, 3}) {
      both.cells.push_back(image[static_cast<std::size_t>(mesh.cells[c + corner])]);
    }
  }
  return both;
}

// The forces on a round end go through its centre.
TEST(TurnedPose, ARoundEndHasNoTorqueAboutItsCentre) {
  Turning turning = standing(true);
  turning.point = Vec3(-0.5 * kLength, 0, 0);
  Pressed pressed = pressed_aslant(turning);
  const Equilibrium here = pressed.at(pressed.place);
  ASSERT_EQ(here.outcome, Outcome::converged) << here.summary.message;
  const double force = here.reaction.head<3>().norm();
  EXPECT_GT(force, 0.01);
  EXPECT_LT(torque_of(pressed.tool.tool, here.t, here.reaction)->norm(), 1e-12 * force * kRadius);
}

TEST(TurnedPose, APressInThePlanesOfSymmetryHasNoTorque) {
  TetMesh mesh = make_box(ElementOrder::linear, {3, 3, 4}, Vec3(0.03, 0.03, 0.04));
  mesh = with_midside_nodes(with_mirror_image(with_mirror_image(mesh, 0), 1));
  std::vector<char> fixed;
  for (const Vec3& p : mesh.points) fixed.push_back(p.z() < 1e-9 ? 1 : 0);
  const Scene scene =
      make_scene(mesh, make_block(Law::neo_hookean).scene.organ.materials.front(), fixed);
  for (const bool is_round : {true, false}) {
    Pressed pressed(scene, rod(standing(is_round)), Vec3(0, 0, 0.04), 0.003);
    const Equilibrium here = pressed.at(pressed.place);
    ASSERT_EQ(here.outcome, Outcome::converged) << here.summary.message;
    const double force = here.reaction.head<3>().norm();
    EXPECT_GT(force, 0.01);
    EXPECT_LT(torque_of(pressed.tool.tool, here.t, here.reaction)->norm(), 1e-8 * force * kRadius);
  }
}

}  // namespace
}  // namespace palpate::test::test_turned_pose
