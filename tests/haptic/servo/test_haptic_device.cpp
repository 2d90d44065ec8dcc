// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/servo/haptic_device.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "haptic/transport/simulated_board.h"

namespace palpate::test::test_haptic_device {
namespace {

using namespace std::chrono_literals;

/// A device that somebody else's loop drives at 1 kHz.
class HapticDeviceTest : public testing::Test {
 protected:
  HapticDevice& make(const HapticDeviceOptions& options = {}, BoardFaults faults = {}) {
    BoardOptions board_options;
    board_options.faults = faults;
    board_options.feature.flags |= palpate_report::kSensesRotation;
    // 0.1 m/s along x, turned by 0.5 about z, a button from 50 ms on.
    auto hand = std::make_shared<ScriptedMotion>([](Time time) {
      Motion::Pose pose;
      pose.position = {0.1 * seconds(time), 0.01, -0.02};
      pose.rotation = Eigen::AngleAxisd(0.5, Vec3::UnitZ());
      pose.buttons = time >= 50ms ? 1 : 0;
      return pose;
    });
    auto board = std::make_unique<SimulatedBoard>(clock_, hand, board_options);
    board_ = board.get();
    std::shared_ptr<const Profile> profile =
        make_profile(ProfileKind::palpate_report, board->feature());
    return device_.emplace(std::move(board), profile, clock_, options);
  }

  /// Rounds of the loop.
  void run(int num_rounds, const Vec3& force) {
    for (int i = 0; i < num_rounds; ++i) {
      clock_->advance(1ms);
      fresh_ = device_->getPosition(position_);
      taken_ = device_->setForce(force);
      largest_ = std::max(largest_, board_->status().force.norm());
    }
    clock_->advance(1ms);
  }

  std::shared_ptr<VirtualClock> clock_ = std::make_shared<VirtualClock>();
  SimulatedBoard* board_ = nullptr;
  std::optional<HapticDevice> device_;
  Vec3 position_ = Vec3::Zero();
  bool fresh_ = false;
  bool taken_ = false;
  double largest_ = 0;
};

TEST_F(HapticDeviceTest, GivesWhatTheDeviceSaysAndSendsTheForce) {
  HapticDevice& device = make();
  EXPECT_EQ(device.getSpecifications().max_linear_force, 7.9);
  EXPECT_FALSE(device.getPosition(position_));
  EXPECT_FALSE(device.setForce({1, 0, 0}));
  EXPECT_TRUE(device.open());
  EXPECT_FALSE(device.open());

  bool is_down = true;
  run(45, {1, 2, -2});
  EXPECT_TRUE(device.getUserSwitch(0, is_down));
  EXPECT_FALSE(is_down);
  run(55, {1, 2, -2});
  EXPECT_TRUE(fresh_);
  EXPECT_TRUE(taken_);
  // The report may be a tick old; the steps of the position are 10 µm.
  const double now = seconds(clock_->now());
  EXPECT_NEAR(position_.x(), 0.1 * now, 3e-4);
  EXPECT_NEAR(position_.y(), 0.01, 1e-5);
  EXPECT_NEAR(position_.z(), -0.02, 1e-5);
  Vec3 velocity;
  EXPECT_TRUE(device.getLinearVelocity(velocity));
  EXPECT_NEAR(velocity.x(), 0.1, 0.01);
  EXPECT_NEAR(velocity.y(), 0, 0.002);
  Mat3 rotation;
  EXPECT_TRUE(device.getRotation(rotation));
  EXPECT_NEAR((rotation * Vec3::UnitX() - Vec3(std::cos(0.5), std::sin(0.5), 0)).norm(), 0, 1e-4);
  EXPECT_TRUE(device.getUserSwitch(0, is_down));
  EXPECT_TRUE(is_down);
  EXPECT_TRUE(device.getUserSwitch(1, is_down));
  EXPECT_FALSE(is_down);
  EXPECT_TRUE(device.getUserSwitch(-1, is_down));
  EXPECT_FALSE(is_down);
  std::uint32_t switches = 0;
  EXPECT_TRUE(device.getUserSwitches(switches));
  EXPECT_EQ(switches, 1U);
  EXPECT_NEAR((board_->status().force - Vec3(1, 2, -2)).norm(), 0, 0.002);
  EXPECT_EQ(device.getForce(), Vec3(1, 2, -2));
}

TEST_F(HapticDeviceTest, ClosingSendsZeroForceAndOpeningBeginsAnew) {
  HapticDevice& device = make();
  device.open();
  run(50, {0, 0, 3});
  EXPECT_TRUE(board_->status().motors_on);
  EXPECT_TRUE(device.close());
  EXPECT_FALSE(device.close());
  clock_->advance(1ms);
  EXPECT_FALSE(board_->status().motors_on);
  EXPECT_EQ(board_->status().cuts, 0U) << "it was the watchdog";
  EXPECT_FALSE(device.getPosition(position_));
  EXPECT_EQ(device.getForce(), Vec3::Zero());
  EXPECT_TRUE(device.open());
  run(50, {0, 0, 3});
  EXPECT_NEAR(board_->status().force.z(), 3, 0.002);
}

TEST_F(HapticDeviceTest, LimitsTheForceAndItsChange) {
  HapticDeviceOptions options;
  options.force_limit = 2;
  options.slew_limit = 100;
  make(options).open();
  run(12, {0, 300, 0});
  EXPECT_GT(largest_, 0.5);
  EXPECT_LT(largest_, 1.3) << "0.1 N a round";
  run(30, {0, 300, 0});
  EXPECT_NEAR(largest_, 2, 0.002);
  EXPECT_LE(device_->getForce().norm(), 2 + 1e-12);
  run(1, {0, std::nan(""), 0});
  EXPECT_FALSE(taken_);
  EXPECT_EQ(board_->status().force, Vec3::Zero());
}

TEST_F(HapticDeviceTest, NeverExceedsTheDevice) {
  HapticDeviceOptions options;
  options.force_limit = 1000;
  options.slew_limit = 1e9;
  make(options).open();
  run(20, {-500, 0, 0});
  EXPECT_NEAR(largest_, 7.9, 0.002);
}

TEST_F(HapticDeviceTest, ASilentDeviceGetsNoForce) {
  BoardFaults faults;
  faults.silent = {50ms, 80ms};
  make({}, faults).open();
  run(45, {0, 0, 1});
  EXPECT_NEAR(board_->status().force.z(), 1, 0.002);
  run(20, {0, 0, 1});
  EXPECT_FALSE(fresh_);
  EXPECT_FALSE(taken_);
  EXPECT_EQ(board_->status().force, Vec3::Zero());
  run(40, {0, 0, 1});
  EXPECT_TRUE(fresh_);
  EXPECT_FALSE(taken_) << "not before the caller has asked for zero";
  EXPECT_EQ(board_->status().force, Vec3::Zero());
  run(1, {0, 0, 0});
  run(20, {0, 0, 1});
  EXPECT_TRUE(taken_);
  EXPECT_NEAR(board_->status().force.z(), 1, 0.002);
}

TEST_F(HapticDeviceTest, AnUnpluggedDeviceIsTold) {
  BoardFaults faults;
  faults.unplugged = 50ms;
  make({}, faults).open();
  run(60, {0, 0, 1});
  EXPECT_FALSE(fresh_);
  EXPECT_FALSE(taken_);
  EXPECT_FALSE(device_->problem().empty());
}

TEST_F(HapticDeviceTest, OptionsAreChecked) {
  const auto with = [](auto&& change) {
    HapticDeviceOptions options;
    change(options);
    return options;
  };
  EXPECT_THROW(make(with([](auto& o) { o.stale_after = Duration(0); })), InputError);
  EXPECT_THROW(make(with([](auto& o) { o.release_after = Duration(0); })), InputError);
  EXPECT_THROW(make(with([](auto& o) { o.force_limit = -1; })), InputError);
  EXPECT_THROW(make(with([](auto& o) { o.slew_limit = 0; })), InputError);
}

}  // namespace
}  // namespace palpate::test::test_haptic_device
