// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "haptic/servo/force_limiter.h"
#include "haptic/servo/tick.h"

namespace palpate::test::test_force_limiter {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

TEST(ForceLimiter, WithinTheLimitsNothingHappens) {
  std::uint32_t limited = 0;
  EXPECT_EQ(limit_force(Vec3(1, 2, 2), Vec3::Zero(), 3, 3, limited), Vec3(1, 2, 2));
  EXPECT_EQ(limited, 0U);
}

TEST(ForceLimiter, MagnitudeKeepsTheDirection) {
  std::uint32_t limited = 0;
  const Vec3 force = limit_force(Vec3(10, 20, 20), Vec3::Zero(), 3, 100, limited);
  EXPECT_LT((force - Vec3(1, 2, 2)).norm(), 1e-15);
  EXPECT_EQ(limited, limits::magnitude);
}

TEST(ForceLimiter, SlewStepsTowards) {
  Vec3 force = Vec3::Zero();
  for (int i = 1; i <= 6; ++i) {
    std::uint32_t limited = 0;
    force = limit_force(Vec3(0, 3, 0), force, 5, 0.5, limited);
    EXPECT_LT((force - Vec3(0, 0.5 * i, 0)).norm(), 1e-15);
    EXPECT_EQ(limited, i < 6 ? limits::slew : 0U);
  }
}

TEST(ForceLimiter, WhatIsNotFiniteIsZeroAtOnce) {
  const Vec3 bad[] = {{std::nan(""), 0, 0}, {0, kInf, 0}, {0, 0, -kInf}};
  std::uint32_t limited = 0;
  for (const Vec3& force : bad) {
    limited = 0;
    EXPECT_EQ(limit_force(force, Vec3(1, 1, 1), 5, 0.1, limited), Vec3::Zero());
    EXPECT_EQ(limited, limits::not_finite);
  }
  EXPECT_EQ(limit_force(Vec3(1, 1, 1), Vec3::Zero(), std::nan(""), 1, limited), Vec3::Zero());
  EXPECT_EQ(limit_force(Vec3(1, 1, 1), Vec3::Zero(), 1, -1, limited), Vec3::Zero());
}

TEST(ForceLimiter, AnythingGoesInAndTheLimitsHold) {
  std::mt19937 random(1);
  std::normal_distribution<double> direction;
  std::uniform_real_distribution<double> exponent(-310, 308);
  std::uniform_real_distribution<double> limit(0, 10);
  Vec3 before = Vec3::Zero();
  for (int i = 0; i < 200000; ++i) {
    const Vec3 wanted = std::pow(10, exponent(random)) *
                        Vec3(direction(random), direction(random), direction(random));
    const double largest = limit(random);
    std::uint32_t limited = 0;
    const Vec3 force = limit_force(wanted, before, largest, 0.5, limited);
    ASSERT_TRUE(force.allFinite());
    ASSERT_LE(force.norm(), largest * (1 + 1e-15));
    // A limit that was lowered is kept at once.
    if (largest >= before.norm() + 0.5) {
      ASSERT_LE((force - before).norm(), 0.5 * (1 + 1e-12));
    }
    before = force;
  }
}

}  // namespace
}  // namespace palpate::test::test_force_limiter
