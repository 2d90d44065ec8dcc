// SPDX-License-Identifier: BSD-3-Clause
#include "interaction/motion_kind.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "base/error.h"
#include "interaction/interaction_spec.h"
#include "solvers/support/block.h"
#include "solvers/support/message_of.h"

namespace palpate::test::test_motion_kind {
namespace {

constexpr auto kTilted = static_cast<ToolMotion>(100);
constexpr auto kTurning = static_cast<ToolMotion>(101);
constexpr auto kUntold = static_cast<ToolMotion>(102);

/// The tool is turned about z by an angle that stays, and moved as it is.
class TiltedPose final : public PoseMap {
 public:
  explicit TiltedPose(double angle)
      : rotation_(Eigen::AngleAxisd(angle, Vec3::UnitZ()).toRotationMatrix()) {}
  [[nodiscard]] int num_coordinates() const noexcept override { return 3; }
  [[nodiscard]] PoseJet evaluate(const Eigen::VectorXd& q, int order) const override {
    PoseJet pose = translated_pose()->evaluate(q, order);
    pose.rotation = rotation_;
    return pose;
  }

 private:
  Mat3 rotation_;
};

class TiltedKind final : public MotionKind {
 public:
  TiltedKind() = default;
  [[nodiscard]] ToolMotion number() const override { return kTilted; }
  [[nodiscard]] PoseMapPtr make(const std::vector<double>& numbers) const override {
    return std::make_shared<const TiltedPose>(numbers.at(0));
  }
};

/// The tool turns about z as it moves along x, and does not say how far its points move.
class TurningPose final : public PoseMap {
 public:
  [[nodiscard]] int num_coordinates() const noexcept override { return 3; }
  [[nodiscard]] PoseJet evaluate(const Eigen::VectorXd& q, int /*order*/) const override {
    PoseJet pose(3);
    pose.turns = true;
    pose.place = q;
    pose.rotation = Eigen::AngleAxisd(q.x(), Vec3::UnitZ()).toRotationMatrix();
    return pose;
  }
};

class TurningKind final : public MotionKind {
 public:
  TurningKind() = default;
  [[nodiscard]] ToolMotion number() const override { return kTurning; }
  [[nodiscard]] PoseMapPtr make(const std::vector<double>& /*numbers*/) const override {
    return std::make_shared<const TurningPose>();
  }
};

RigidTool make_rod(const Vec3& axis) {
  RigidTool rod;
  rod.shape = ToolShape::capsule;
  rod.radius = 0.01;
  rod.axis = axis;
  rod.length = 0.03;
  return rod;
}

/// Φ and −∂Φ/∂q of a tool that presses a block at rest.
Eigen::Vector4d felt(const Scene& scene, Interaction& tool, const Vec3& q) {
  const Eigen::Index size = 3 * static_cast<Eigen::Index>(scene.body.mesh.points.size());
  NodalVector force = NodalVector::Zero(size);
  Eigen::VectorXd of_q = Eigen::VectorXd::Zero(3);
  Eigen::Vector4d result;
  result[0] = tool.potential(q, NodalVector::Zero(size), force, of_q);
  result.tail<3>() = -of_q;
  return result;
}

TEST(MotionKind, AddingOneIsOneClass) {
  add_motion_kind(std::make_unique<TiltedKind>());
  EXPECT_THROW(add_motion_kind(std::make_unique<TiltedKind>()), InputError) << "It is taken.";

  const Block block = make_block(Law::neo_hookean);
  const double angle = 0.6;
  const Vec3 along(std::cos(angle), std::sin(angle), 0);
  RigidTool tilted = make_rod(Vec3::UnitX());
  tilted.motion = kTilted;
  tilted.motion_numbers = {angle};
  const InteractionSpec moved = rigid_contact_spec(with_defaults(tilted, block.scene));
  const InteractionSpec laid = rigid_contact_spec(with_defaults(make_rod(along), block.scene));
  EXPECT_FALSE(moved == laid);
  InteractionFactory tools(block.scene.body, {});
  const auto by_motion = tools.make(moved);
  const auto clear_by_motion = tools.clearance(moved);
  const auto by_shape = tools.make(laid);
  const auto clear_by_shape = tools.clearance(laid);

  const Vec3 q = clear_by_shape->pressed({0.05, 0.03, 0.05}, Vec3::UnitZ(), 0.002);
  const Eigen::Vector4d expected = felt(block.scene, *by_shape, q);
  EXPECT_GT(expected[3], 0);
  EXPECT_LE((felt(block.scene, *by_motion, q) - expected).norm(), 1e-9 * expected.norm());
  // The ways out are of the tool as it is turned.
  EXPECT_LE((clear_by_motion->start_for(q) - clear_by_shape->start_for(q)).norm(), 1e-9);
  EXPECT_NEAR(clear_by_motion->clearance(q), clear_by_shape->clearance(q), 1e-12);
  EXPECT_EQ(clear_by_motion->is_inside(q), clear_by_shape->is_inside(q));
  // The box of a shape is that of its box, and so it may only become larger.
  EXPECT_TRUE(clear_by_motion->bounds().contains(clear_by_shape->bounds()));
}

TEST(MotionKind, OneThatTurnsHasNoWayToABody) {
  add_motion_kind(std::make_unique<TurningKind>());
  const Block block = make_block(Law::neo_hookean);
  RigidTool turning = make_rod(Vec3::UnitX());
  turning.motion = kTurning;
  const InteractionSpec spec = rigid_contact_spec(with_defaults(turning, block.scene));
  InteractionFactory tools(block.scene.body, {});
  EXPECT_EQ(tools.make(spec)->num_coordinates(), 3);
  EXPECT_NE(message_of([&] { (void)tools.clearance(spec); }).find("turns as it moves"),
            std::string::npos);
}

/// It has four coordinates, and does not say what the fourth one is at a place.
class UntoldPose final : public PoseMap {
 public:
  [[nodiscard]] int num_coordinates() const noexcept override { return 4; }
  [[nodiscard]] PoseJet evaluate(const Eigen::VectorXd& /*q*/, int /*order*/) const override {
    return PoseJet(4);
  }
};

class UntoldKind final : public MotionKind {
 public:
  UntoldKind() = default;
  [[nodiscard]] ToolMotion number() const override { return kUntold; }
  [[nodiscard]] PoseMapPtr make(const std::vector<double>& /*numbers*/) const override {
    return std::make_shared<const UntoldPose>();
  }
};

TEST(MotionKind, OneWithMoreCoordinatesSaysWhichTheyAreAtAPlace) {
  add_motion_kind(std::make_unique<UntoldKind>());
  RigidTool tool = make_rod(Vec3::UnitX());
  tool.motion = kUntold;
  EXPECT_NE(message_of([&] { (void)pose_of(tool); }).find("4 coordinates"), std::string::npos);
}

TEST(MotionKind, NumbersThatAreNoneAreRefused) {
  EXPECT_THROW((void)motion_kind(static_cast<ToolMotion>(7)), InputError);
  EXPECT_THROW((void)motion_kind(ToolMotion::translated).make({0.5}), InputError);
}

}  // namespace
}  // namespace palpate::test::test_motion_kind
