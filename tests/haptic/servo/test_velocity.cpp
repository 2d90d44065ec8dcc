// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "haptic/servo/velocity.h"

namespace palpate::test::test_velocity {
namespace {

constexpr double kStep = 1e-5;

Vec3 quantised(double x) { return Vec3::Constant(kStep * std::round(x / kStep)); }

TEST(Velocity, ExactlyZeroAtRestThoughTheLastDigitFlickers) {
  VelocityEstimator estimator(kStep);
  for (int i = 0; i < 100; ++i) (void)estimator.add(Vec3::Constant(0.01), 1e-3);
  EXPECT_EQ(estimator.add(Vec3::Constant(0.01), 1e-3), Vec3::Zero());
}

TEST(Velocity, SteadyMotionInSteps) {
  for (double speed : {0.002, 0.02, 0.2}) {
    VelocityEstimator estimator(kStep);
    double worst = 0;
    for (int i = 0; i < 500; ++i) {
      const Vec3 v = estimator.add(quantised(speed * 1e-3 * i), 1e-3);
      if (i > 20) worst = std::max(worst, std::abs(v[0] - speed));
    }
    // A difference of two would be wrong by a step a millisecond.
    EXPECT_LT(worst, 0.15 * kStep / 1e-3) << speed;
  }
}

TEST(Velocity, PromptWhenItTurns) {
  VelocityEstimator estimator(kStep);
  double x = 0;
  for (int i = 0; i < 100; ++i) (void)estimator.add(quantised(x += 0.2e-3), 1e-3);
  for (int i = 0; i < 3; ++i) (void)estimator.add(quantised(x -= 0.2e-3), 1e-3);
  EXPECT_LT(estimator.add(quantised(x -= 0.2e-3), 1e-3)[0], -0.15);
}

TEST(Velocity, UnevenIntervals) {
  VelocityEstimator estimator(kStep);
  double time = 0;
  for (int i = 0; i < 100; ++i) {
    const double interval = i % 3 == 0 ? 3e-3 : 0.5e-3;
    time += interval;
    (void)estimator.add(quantised(0.1 * time), interval);
  }
  EXPECT_NEAR(estimator.add(quantised(0.1 * (time + 1e-3)), 1e-3)[2], 0.1, 2e-3);
  const Vec3 last = estimator.add(quantised(1), 0);
  EXPECT_NEAR(last[0], 0.1, 2e-3) << "no time has passed";
}

}  // namespace
}  // namespace palpate::test::test_velocity
