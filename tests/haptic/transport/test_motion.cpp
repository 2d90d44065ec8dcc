// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/transport/motion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <thread>

#include "base/error.h"

namespace palpate::test::test_motion {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

TEST(ScriptedMotion, GoesFromRestToRest) {
  const Vec3 a(0.01, 0, 0);
  const Vec3 b(0.01, 0.02, -0.01);
  ScriptedMotion motion({{milliseconds(100), a}, {milliseconds(300), b}});
  const auto at = [&](Duration time) { return motion.advance(time, Vec3::Ones()).position; };
  EXPECT_EQ(at(milliseconds(0)), a);
  EXPECT_EQ(at(milliseconds(100)), a);
  EXPECT_TRUE(at(milliseconds(200)).isApprox(0.5 * (a + b), 1e-14));
  EXPECT_LT((at(milliseconds(101)) - a).norm(), 1e-7 * (b - a).norm() * 20) << "slowly";
  EXPECT_LT((at(milliseconds(299)) - b).norm(), 1e-7 * (b - a).norm() * 20);
  EXPECT_EQ(at(milliseconds(300)), b);
  EXPECT_EQ(at(std::chrono::hours(1)), b);
}

TEST(ScriptedMotion, Repeats) {
  ScriptedMotion motion({{milliseconds(0), Vec3::Zero()}, {milliseconds(40), Vec3::UnitX()}}, true);
  const auto x = [&](Duration time) { return motion.advance(time, Vec3::Zero()).position[0]; };
  EXPECT_DOUBLE_EQ(x(milliseconds(20)), 0.5);
  EXPECT_DOUBLE_EQ(x(milliseconds(60)), 0.5);
  EXPECT_DOUBLE_EQ(x(milliseconds(80)), 0);
}

TEST(ScriptedMotion, FollowsAFunction) {
  ScriptedMotion motion([](Time time) {
    Motion::Pose pose;
    pose.position[2] = seconds(time);
    pose.buttons = 3;
    return pose;
  });
  const auto pose = motion.advance(milliseconds(250), Vec3::Zero());
  EXPECT_DOUBLE_EQ(pose.position[2], 0.25);
  EXPECT_EQ(pose.buttons, 3);
}

TEST(ScriptedMotion, RefusesAScriptThatIsNone) {
  using Waypoints = std::vector<ScriptedMotion::Waypoint>;
  EXPECT_THROW(ScriptedMotion(Waypoints{}), InputError);
  EXPECT_THROW(ScriptedMotion(Waypoints{{Time(1), {}}, {Time(1), {}}}), InputError);
  EXPECT_THROW(ScriptedMotion(Waypoints{{Time(0), {}}}, true), InputError);
  EXPECT_NO_THROW(ScriptedMotion(Waypoints{{Time(0), {}}}));
}

TEST(MouseMotion, FollowsWithoutAJumpOrOvershoot) {
  MouseMotion motion(milliseconds(15));
  motion.set_target({0.03, 0, 0}, 2);
  double last = 0;
  double last_step = 0;
  for (int i = 1; i <= 400; ++i) {
    const auto pose = motion.advance(milliseconds(i), Vec3::Zero());
    const double step = pose.position[0] - last;
    EXPECT_GE(step, 0);
    // It starts with the acceleration ω² · distance, and never has more.
    EXPECT_LE(std::abs(step - last_step), 1.001 * 0.03 / (15 * 15));
    EXPECT_EQ(pose.buttons, 2);
    last = pose.position[0];
    last_step = step;
  }
  EXPECT_NEAR(last, 0.03, 1e-9);
}

TEST(MouseMotion, IsTheSameInLargeAndSmallSteps) {
  MouseMotion fine;
  MouseMotion coarse;
  fine.set_target({0.01, -0.02, 0.03});
  coarse.set_target({0.01, -0.02, 0.03});
  for (int i = 1; i < 200; ++i) (void)fine.advance(microseconds(100 * i), Vec3::Zero());
  const auto a = fine.advance(milliseconds(20), Vec3::Zero());
  const auto b = coarse.advance(milliseconds(20), Vec3::Zero());
  EXPECT_TRUE(a.position.isApprox(b.position, 1e-12));
}

TEST(MouseMotion, TargetsComeWholeFromAnotherThread) {
  MouseMotion motion(microseconds(1));
  std::thread mouse([&] {
    for (int i = 1; i <= 20000; ++i) motion.set_target(i * Vec3::Ones());
  });
  for (int i = 1; i <= 2000; ++i) {
    const Vec3 p = motion.advance(milliseconds(i), Vec3::Zero()).position;
    ASSERT_NEAR(p[0], p[1], 1e-9);
    ASSERT_NEAR(p[0], p[2], 1e-9);
  }
  mouse.join();
  EXPECT_NEAR(motion.advance(milliseconds(3000), Vec3::Zero()).position[0], 20000, 1e-6);
}

}  // namespace
}  // namespace palpate::test::test_motion
