// SPDX-License-Identifier: BSD-3-Clause
// Where a hand may be soon.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "following/hand_prediction.h"

namespace palpate::test::test_hand_prediction {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

/// A cube around a place, with half its side, m.
Eigen::AlignedBox3d cube(const Vec3& centre, double half) {
  return {Vec3(centre - Vec3::Constant(half)), Vec3(centre + Vec3::Constant(half))};
}

TEST(HandPrediction, AHandAtRestMayMoveAnywhereSlowly) {
  const HandPrediction hand({Vec3(1, 2, 3), Vec3::Zero()}, {0.4, 0.35, 0.02});
  const double acceleration = 0.02 / 0.35;
  EXPECT_EQ(hand.time_until(cube(Vec3(1, 2, 3), 0)), 0);
  EXPECT_EQ(hand.time_until(cube(Vec3(1, 2, 3.001), 0.002)), 0);
  for (const Vec3& away : {Vec3::UnitX().eval(), Vec3::UnitZ().eval()}) {
    const double time = hand.time_until(cube(Vec3(1, 2, 3) + 0.003 * away, 0.001));
    EXPECT_NEAR(time, std::sqrt(2 * 0.002 / acceleration), 1e-5);
  }
  EXPECT_EQ(hand.time_until(cube(Vec3(1, 2, 3.1), 0.001)), kNever);
}

TEST(HandPrediction, WhatLiesAheadIsNeededSooner) {
  const HandPrediction hand({Vec3::Zero(), Vec3(0.1, 0, 0)});
  const double ahead = hand.time_until(cube(Vec3(0.02, 0, 0), 0.002));
  const double aside = hand.time_until(cube(Vec3(0, 0.02, 0), 0.002));
  EXPECT_LT(ahead, 0.18);
  EXPECT_GT(ahead, 0.1);
  EXPECT_GT(aside, ahead);
  EXPECT_EQ(hand.time_until(cube(Vec3(-0.05, 0, 0), 0.002)), kNever);
  // The farther ahead, the later.
  double last = 0;
  for (double x = 0.005; x < 0.05; x += 0.005) {
    const double time = hand.time_until(cube(Vec3(x, 0, 0), 0.002));
    EXPECT_GT(time, last);
    last = time;
  }
}

TEST(HandPrediction, TheBoxHasAllPlacesThatMayBeReached) {
  const HandPrediction hand({Vec3(0.01, 0, 0), Vec3(0.05, -0.1, 0.02)});
  const Eigen::AlignedBox3d box = hand.box();
  for (int i = 0; i < 20000; ++i) {
    const Vec3 place = 0.1 * Vec3(std::sin(i), std::sin(2.3 * i), std::cos(1.7 * i));
    if (hand.time_until(cube(place, 0)) < kNever) {
      EXPECT_TRUE(box.contains(place)) << place.transpose();
    }
  }
}

}  // namespace
}  // namespace palpate::test::test_hand_prediction
