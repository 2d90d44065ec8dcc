// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "haptic/touching/friction.h"

namespace palpate::test::test_friction {
namespace {

constexpr double kCoefficient = 0.3;
constexpr double kStiffness = 500;
const Vec3 kPush(0, 0, -2);

/// k_t and the distance at which all of the contact slips, of the test's push.
const double kShear = Friction::kShearRatio * kStiffness;
const double kMost = kCoefficient * kPush.norm();
const double kLongest = 1.5 * kMost / kShear;

Friction pressed() {
  Friction friction;
  friction.move(Vec3::Zero(), kCoefficient, kPush, kStiffness, 0);
  return friction;
}

TEST(Friction, YieldsAsCattaneoAndMindlinHaveIt) {
  Friction friction = pressed();
  const Vec3 aside = Vec3(0.6, 0.8, 0);
  const double step = kLongest / 1000;
  double work = 0;
  for (int i = 1; i <= 1500; ++i) {
    const double before = friction.force().dot(aside);
    friction.move(step * aside, kCoefficient, kPush, kStiffness, 0);
    const double s = std::min(i / 1000.0, 1.0);
    EXPECT_NEAR(friction.force().dot(aside), kMost * (1 - std::pow(1 - s, 1.5)), 1e-9 * kMost);
    EXPECT_NEAR(friction.stiffness(), kShear * std::sqrt(1 - s), 1e-5 * kShear);
    if (i <= 1000) work += 0.5 * step * (before + friction.force().dot(aside));
  }
  EXPECT_NEAR(friction.stretch().norm(), kLongest, 1e-12);
  EXPECT_NEAR(friction.energy(), work, 1e-6 * work);
}

TEST(Friction, AWayAlongThePushIsNotRubbed) {
  Friction friction = pressed();
  friction.move(Vec3(0, 0, -0.01), kCoefficient, kPush, kStiffness, 0);
  EXPECT_EQ(friction.force(), Vec3::Zero());
  EXPECT_EQ(friction.energy(), 0);
}

TEST(Friction, ACouplingIsInSeries) {
  Friction friction;
  friction.move(Vec3::Zero(), kCoefficient, kPush, kStiffness, 100);
  EXPECT_NEAR(friction.stiffness(), 1 / (1 / kShear + 1 / 100.0), 1e-9);
}

// A push that grows and falls while the hand holds still neither pushes it nor stores.
TEST(Friction, APushThatChangesGivesNoEnergy) {
  Friction friction = pressed();
  friction.move(Vec3(0.5 * kLongest, 0, 0), kCoefficient, kPush, kStiffness, 0);
  double energy = friction.energy();
  double force = friction.force().norm();
  for (int i = 0; i < 400; ++i) {
    const double part = 1 + 0.5 * std::sin(0.1 * i);
    friction.move(Vec3::Zero(), kCoefficient, part * kPush, std::cbrt(part) * kStiffness, 0);
    EXPECT_LE(friction.energy(), energy * (1 + 1e-12));
    EXPECT_LE(friction.force().norm(), force * (1 + 1e-12));
    energy = friction.energy();
    force = friction.force().norm();
  }
}

// A trembling hand, 2 % of the push at 10 Hz for a second, that holds a tool on a slope.
TEST(Friction, ATremorDoesNotUndoTheShear) {
  Friction friction = pressed();
  friction.move(Vec3(0.2 * kLongest, 0, 0), kCoefficient, kPush, kStiffness, 0);
  const double force = friction.force().norm();
  for (int i = 0; i < 1000; ++i) {
    const double part = 1 + 0.02 * std::sin(2 * M_PI * 0.01 * i);
    friction.move(Vec3::Zero(), kCoefficient, part * kPush, std::cbrt(part) * kStiffness, 0);
  }
  EXPECT_GT(friction.force().norm(), 0.97 * force);
}

TEST(Friction, WhereTheBodyGivesWayTheShearStays) {
  Friction friction = pressed();
  friction.move(Vec3(0.5 * kLongest, 0, 0), kCoefficient, kPush, kStiffness, 0);
  const Vec3 before = friction.force();
  friction.move(Vec3::Zero(), kCoefficient, kPush, -100, 0);
  EXPECT_EQ(friction.force(), before);
}

// As where a tool glides round an edge.
TEST(Friction, ASurfaceThatTurnsGivesNoEnergy) {
  Friction friction = pressed();
  friction.move(Vec3(0.9 * kLongest, 0, 0), kCoefficient, kPush, kStiffness, 0);
  double energy = friction.energy();
  for (int i = 1; i <= 100; ++i) {
    const double angle = 0.015 * i;
    const Vec3 push = kPush.norm() * Vec3(-std::sin(angle), 0, -std::cos(angle));
    friction.move(Vec3::Zero(), kCoefficient, push, kStiffness, 0);
    EXPECT_LE(friction.energy(), energy);
    EXPECT_NEAR(friction.force().dot(push), 0, 1e-12);
    energy = friction.energy();
  }
}

}  // namespace
}  // namespace palpate::test::test_friction
