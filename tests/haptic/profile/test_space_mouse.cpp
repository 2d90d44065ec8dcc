// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/profile/space_mouse.h"

#include <gtest/gtest.h>

#include "haptic/profile/reports.h"

namespace palpate::test::test_space_mouse {
namespace {

using test::report;

constexpr int kFull = 350 - 256;  // low byte of 350; the high one is 1
const double kStep = SpaceMouse::kFullSpeed / (SpaceMouse::kFullDeflection - SpaceMouse::kDeadZone);

TEST(SpaceMouse, TranslationIsARateInOurAxes) {
  const SpaceMouse profile;
  DeviceState state;
  // To the right, full.
  ASSERT_TRUE(profile.decode(report({1, kFull, 1, 0, 0, 0, 0}), state));
  EXPECT_TRUE(state.rate.isApprox(Vec3(0, 0.1, 0), 1e-15)) << state.rate;
  // Towards the user 12, and up 300: the device's third axis points down.
  ASSERT_TRUE(profile.decode(report({1, 0, 0, 12, 0, 0xD4, 0xFE}), state));
  EXPECT_TRUE(state.rate.isApprox(kStep * Vec3(2, 0, 290), 1e-14)) << state.rate;
  EXPECT_EQ(state.angular_rate, Vec3::Zero());
  EXPECT_EQ(state.position, Vec3::Zero());
}

TEST(SpaceMouse, RotationIsARateInOurAxes) {
  const SpaceMouse profile;
  DeviceState state;
  ASSERT_TRUE(profile.decode(report({2, kFull, 1, 0, 0, 0, 0}), state));
  EXPECT_TRUE(state.angular_rate.isApprox(Vec3(0, 1.5, 0), 1e-15));
  ASSERT_TRUE(profile.decode(report({2, 0, 0, 0xA2, 0xFE, 0, 0}), state));
  EXPECT_TRUE(state.angular_rate.isApprox(Vec3(-1.5, 0, 0), 1e-15));
  ASSERT_TRUE(profile.decode(report({2, 0, 0, 0, 0, kFull, 1}), state));
  EXPECT_TRUE(state.angular_rate.isApprox(Vec3(0, 0, -1.5), 1e-15));
  EXPECT_EQ(state.rate, Vec3::Zero());
}

TEST(SpaceMouse, NewerReportHoldsBoth) {
  const SpaceMouse profile;
  DeviceState state;
  ASSERT_TRUE(profile.decode(report({1, 0, 0, kFull, 1, 0, 0, 0, 0, 0, 0, 0xA2, 0xFE}), state));
  EXPECT_TRUE(state.rate.isApprox(Vec3(0.1, 0, 0), 1e-15));
  EXPECT_TRUE(state.angular_rate.isApprox(Vec3(0, 0, 1.5), 1e-15));
}

TEST(SpaceMouse, ACapThatIsNearlyAtRestIsAtRest) {
  const SpaceMouse profile;
  DeviceState state;
  state.rate = Vec3::Ones();
  ASSERT_TRUE(profile.decode(report({1, 10, 0, 0xF6, 0xFF, 0, 0}), state));
  EXPECT_EQ(state.rate, Vec3::Zero());
  ASSERT_TRUE(profile.decode(report({1, 11, 0, 0xF5, 0xFF, 0, 0}), state));
  EXPECT_TRUE(state.rate.isApprox(kStep * Vec3(-1, 1, 0), 1e-14)) << "and does not jump there";
}

TEST(SpaceMouse, Buttons) {
  const SpaceMouse profile;
  DeviceState state;
  ASSERT_TRUE(profile.decode(report({3, 2, 0}), state));
  EXPECT_EQ(state.buttons, 2U);
  ASSERT_TRUE(profile.decode(report({3, 1, 0, 0x80, 0x40}), state));
  EXPECT_EQ(state.buttons, 0x40800001U);
  Report stale = report({3, 1, 0});
  stale.data[3] = 0xFF;
  ASSERT_TRUE(profile.decode(stale, state));
  EXPECT_EQ(state.buttons, 1U) << "what lies behind the report is no part of it";
}

TEST(SpaceMouse, RefusesOtherReports) {
  const SpaceMouse profile;
  DeviceState state;
  for (const Report& r : {report({1, 9, 9, 9, 9, 9}), report({1, 9, 9, 9, 9, 9, 9, 9}),
                          report({2, 9, 9, 9}), report({3}), report({0x17, 50, 0}), Report{}}) {
    EXPECT_FALSE(profile.decode(r, state));
  }
  EXPECT_EQ(state.rate, Vec3::Zero());
  EXPECT_EQ(state.buttons, 0U);
}

TEST(SpaceMouse, RatesBecomeAPlaceWithinTheWorkspace) {
  const SpaceMouse profile;
  DeviceState state;
  state.rate = Vec3(0.03, -0.04, 0);
  state.angular_rate = Vec3(0, 0, 1);
  for (int i = 0; i < 1000; ++i) profile.advance(state, std::chrono::milliseconds(1));
  EXPECT_TRUE(state.position.isApprox(Vec3(0.03, -0.04, 0), 1e-12)) << state.position;
  const Eigen::Quaterniond turned(std::cos(0.5), 0, 0, std::sin(0.5));
  EXPECT_TRUE(state.rotation.isApprox(turned, 1e-12));
  profile.advance(state, std::chrono::seconds(100));
  EXPECT_TRUE(state.position.isApprox(Vec3(0.06, -0.08, 0), 1e-12)) << "stays at its edge";
}

TEST(SpaceMouse, TurnsAboutTheDevicesAxes) {
  const SpaceMouse profile;
  DeviceState state;
  state.rotation = Eigen::AngleAxisd(EIGEN_PI / 2, Vec3::UnitX());
  state.angular_rate = Vec3(0, 0, EIGEN_PI / 2);
  profile.advance(state, std::chrono::seconds(1));
  // The tool's z went to −y and from there, about the device's z, to x.
  EXPECT_TRUE((state.rotation * Vec3::UnitZ()).isApprox(Vec3::UnitX(), 1e-12));
}

TEST(SpaceMouse, HasNoMotors) {
  const SpaceMouse profile;
  EXPECT_EQ(profile.specification().max_linear_force, 0);
  EXPECT_EQ(profile.specification().pacing, Pacing::on_change);
  EXPECT_EQ(profile.encode(Vec3::Zero(), {}).size, 0U);
  EXPECT_EQ(profile.encode(Vec3::Ones(), {}).size, 0U);
  EXPECT_EQ(profile.zero_force({}).size, 0U);
}

}  // namespace
}  // namespace palpate::test::test_space_mouse
