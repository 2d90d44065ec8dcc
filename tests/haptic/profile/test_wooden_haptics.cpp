// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/profile/wooden_haptics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "haptic/profile/reports.h"

namespace palpate::test::test_wooden_haptics {
namespace {

using test::bytes;
using test::report;

/// Encoders 1000, −500, 6000, and three of the gimbal.
const Report kInput = report({0xE8, 0x03, 0x0C, 0xFE, 0x70, 0x17, 1, 0, 2, 0, 3, 0, 0, 0});
// 2π · counts/2000 · capstan/body.
const Vec3 kAngles(EIGEN_PI / 16, -EIGEN_PI / 24, EIGEN_PI / 2);

DeviceState state_at(const WoodenHaptics& profile, const Vec3& angles) {
  DeviceState state;
  state.joints = angles;
  state.position = profile.position(angles);
  state.calibrated = true;
  return state;
}

/// mA that a report asks for [3].
Vec3 currents(const Report& r) {
  Vec3 mA;
  for (int i = 0; i < 3; ++i) {
    mA[i] = static_cast<std::int16_t>(r.data[1 + 2 * i] | r.data[2 + 2 * i] << 8);
  }
  return mA;
}

TEST(WoodenHaptics, DecodesTheEncoders) {
  const WoodenHaptics profile;
  DeviceState state;
  ASSERT_TRUE(profile.decode(kInput, state));
  EXPECT_TRUE(state.joints.isApprox(kAngles, 1e-14)) << state.joints;
  const double reach = 0.205 * std::sin(-EIGEN_PI / 24) + 0.245;
  const Vec3 expected(std::cos(EIGEN_PI / 16) * reach - 0.22, std::sin(EIGEN_PI / 16) * reach,
                      0.08 + 0.205 * std::cos(EIGEN_PI / 24) - 0.08);
  EXPECT_TRUE(state.position.isApprox(expected, 1e-12)) << state.position;
  EXPECT_EQ(state.buttons, 0U);
}

TEST(WoodenHaptics, IsInTheMiddleWhenCalibrated) {
  // The home position by the published figures: the arm upright, the other link level.
  const WoodenHaptics profile;
  DeviceState state;
  ASSERT_TRUE(profile.decode(report({0, 0, 0, 0, 0x70, 0x17, 0, 0, 0, 0, 0, 0, 0, 0}), state));
  EXPECT_TRUE(state.position.isApprox(Vec3(0.245 - 0.22, 0, 0.205), 1e-12)) << state.position;
}

TEST(WoodenHaptics, JacobianIsTheDerivativeOfThePosition) {
  const WoodenHaptics profile;
  constexpr double kStep = 1e-6;
  for (const Vec3& angles : {Vec3(0.1, 0.2, 1.4), Vec3(-0.7, -0.3, 1.9), Vec3(1.2, 0.9, 0.6)}) {
    const Mat3 jacobian = profile.jacobian(angles);
    for (int i = 0; i < 3; ++i) {
      const Vec3 step = kStep * Vec3::Unit(i);
      const Vec3 difference =
          (profile.position(angles + step) - profile.position(angles - step)) / (2 * kStep);
      // The third derivative is at most a length of the device: step² / 6 and rounding.
      EXPECT_LT((jacobian.col(i) - difference).norm(), 1e-10);
    }
  }
}

TEST(WoodenHaptics, MotorsGiveThePowerThatTheHandTakes) {
  WoodenHapticsGeometry geometry;
  geometry.capstan_diameter[1] *= -1;
  const WoodenHaptics profile(geometry);
  const Vec3 gear = geometry.body_diameter.cwiseQuotient(geometry.capstan_diameter);
  const Vec3 force(0.4, -1.1, 0.8);
  const Vec3 rate(0.7, -0.4, 0.9);
  for (const Vec3& angles : {Vec3(0.1, 0.2, 1.4), Vec3(-0.7, -0.3, 1.9)}) {
    const Vec3 mA = currents(profile.encode(force, state_at(profile, angles)));
    const Vec3 motor_torque = 1e-3 * mA.cwiseProduct(geometry.torque_constant);
    const double motors = motor_torque.dot(gear.cwiseProduct(rate));
    const double hand = force.dot(profile.jacobian(angles) * rate);
    // Currents are cut to whole mA.
    const double cut =
        1e-3 * geometry.torque_constant.cwiseProduct(gear).cwiseAbs().dot(rate.cwiseAbs());
    EXPECT_NEAR(motors, hand, cut);
    EXPECT_GT(std::abs(hand), 10 * cut);
  }
}

TEST(WoodenHaptics, EncodesCurrents) {
  const WoodenHaptics profile;
  // The arm upright and the other link level: each motor has its own direction.
  const DeviceState state = state_at(profile, {0, 0, EIGEN_PI / 2});
  // mA: f · lever · capstan/body / torque constant; cut.
  EXPECT_EQ(bytes(profile.encode({0, 1, 0}, state)),  // 591.2 by a
            bytes(report({0, 0x4F, 0x02, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0})));
  EXPECT_EQ(bytes(profile.encode({-1, 0, 0}, state)),  // −659.6 by b
            bytes(report({0, 0, 0, 0x6D, 0xFD, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0})));
  EXPECT_EQ(bytes(profile.encode({0, 0, 1}, state)),  // 788.3 by c
            bytes(report({0, 0, 0, 0, 0, 0x14, 0x03, 0, 0, 0, 0, 0, 0, 0, 0})));
  EXPECT_EQ(bytes(profile.zero_force(state)), bytes(Report{{}, 15}));
}

TEST(WoodenHaptics, TooMuchCurrentKeepsTheDirection) {
  const WoodenHaptics profile;
  const DeviceState state = state_at(profile, {0.2, 0.1, 1.5});
  const Vec3 force = 4.9 * Vec3(0.3, -0.5, 1).normalized();
  const Vec3 mA = currents(profile.encode(force, state));
  EXPECT_EQ(mA.cwiseAbs().maxCoeff(), 2000);
  const Vec3 quarter = currents(profile.encode(0.25 * force, state));
  EXPECT_LT(quarter.cwiseAbs().maxCoeff(), 2000);
  EXPECT_LT((mA.normalized() - quarter.normalized()).norm(), 3.0 / quarter.norm());
}

TEST(WoodenHaptics, AForceThatMayNotBeIsNone) {
  const WoodenHaptics profile;
  const DeviceState state = state_at(profile, kAngles);
  EXPECT_NE(bytes(profile.encode({0, 5, 0}, state)), bytes(profile.zero_force(state)));
  EXPECT_EQ(bytes(profile.encode({0, 5.001, 0}, state)), bytes(profile.zero_force(state)));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(bytes(profile.encode({nan, 0, 0}, state)), bytes(profile.zero_force(state)));
}

TEST(WoodenHaptics, SwitchIsAnsweredWithACalibrationAndNoForce) {
  WoodenHapticsGeometry geometry;
  geometry.home = {1, -2, 6000, 4, 5, -6};
  const WoodenHaptics profile(geometry);
  Report pressed = kInput;
  pressed.data[12] = 1;
  DeviceState state;
  ASSERT_TRUE(profile.decode(pressed, state));
  EXPECT_EQ(state.buttons, 1U);
  const Report expected = report({0, 4, 0, 5, 0, 0xFA, 0xFF, 1, 0, 1, 0, 0xFE, 0xFF, 0x70, 0x17});
  EXPECT_EQ(bytes(profile.encode({0, 1, 0}, state)), bytes(expected));
  EXPECT_EQ(bytes(profile.zero_force(state)), bytes(expected));
  EXPECT_EQ(profile.displayed({0, 1, 0}, state), Vec3::Zero());
}

// It counts from where it was switched on: where it is nobody knows before.
TEST(WoodenHaptics, NoForceBeforeTheCalibration) {
  const WoodenHaptics profile;
  DeviceState state;
  ASSERT_TRUE(profile.decode(kInput, state));
  EXPECT_EQ(currents(profile.encode({0, 1, 0}, state)), Vec3::Zero());
  Report pressed = kInput;
  pressed.data[12] = 1;
  ASSERT_TRUE(profile.decode(pressed, state));
  ASSERT_TRUE(profile.decode(kInput, state));
  EXPECT_NE(currents(profile.encode({0, 1, 0}, state)), Vec3::Zero());
  EXPECT_EQ(profile.displayed({0, 1, 0}, state), Vec3(0, 1, 0));
}

TEST(WoodenHaptics, RefusesReportsThatAreNotWhole) {
  const WoodenHaptics profile;
  DeviceState state;
  for (const std::size_t size : {0, 13, 15}) {
    Report r = kInput;
    r.size = size;
    EXPECT_FALSE(profile.decode(r, state));
  }
  EXPECT_EQ(state.joints, Vec3::Zero());
}

TEST(WoodenHaptics, Specification) {
  const WoodenHaptics profile;
  const Specification& s = profile.specification();
  EXPECT_EQ(s.pacing, Pacing::lock_step);
  EXPECT_EQ(s.watchdog, std::chrono::milliseconds(500));
  EXPECT_FALSE(s.has_device_time);
  EXPECT_EQ(s.actuated, (std::array<bool, 3>{true, true, true}));
  // A count of c at the end of its link; 1 mA of a.
  EXPECT_NEAR(s.position_resolution, 2 * EIGEN_PI / 2000 / 12 * 0.245, 1e-12);
  EXPECT_NEAR(s.force_resolution, 1e-3 * 0.0259 * 16 / 0.22, 1e-12);
}

TEST(WoodenHaptics, AMotorThatTurnsAgainstItsBody) {
  WoodenHapticsGeometry geometry;
  geometry.capstan_diameter *= -1;
  const WoodenHaptics profile(geometry);
  DeviceState state;
  state.calibrated = true;
  ASSERT_TRUE(profile.decode(report({0, 0, 0, 0, 0x90, 0xE8, 0, 0, 0, 0, 0, 0, 0, 0}), state));
  EXPECT_TRUE(state.position.isApprox(Vec3(0.025, 0, 0.205), 1e-12)) << state.position;
  EXPECT_EQ(currents(profile.encode({0, 1, 0}, state)), Vec3(-591, 0, 0));
  EXPECT_GT(profile.specification().position_resolution, 0);
  EXPECT_GT(profile.specification().force_resolution, 0);
}

}  // namespace
}  // namespace palpate::test::test_wooden_haptics
