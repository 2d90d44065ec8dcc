// SPDX-License-Identifier: BSD-3-Clause
// A rigid sphere on a half-space, beside the closed form. benchmark/contact.cpp refines further.
#include <gtest/gtest.h>

#include <cmath>

#include "solvers/support/hertz.h"

namespace palpate::test::test_hertz {
namespace {

constexpr double kCoarseThickness = 0.16;

HertzOptions coarse(double thickness) {
  HertzOptions options;
  options.edges = 2;
  options.thickness = thickness;
  options.extent = 64;
  return options;
}

// Of the error of 0.8 % the finite body has 0.5.
TEST(RigidContact, PressesAHalfSpaceAsHertzHasIt) {
  const HertzResult first = press_half_space(coarse(kCoarseThickness));
  const HertzResult second = press_half_space({});
  EXPECT_EQ(first.force_below, 0);
  EXPECT_EQ(second.force_below, 0);
  EXPECT_NEAR(second.force, 1, 0.013);
  // What follows from single points at the border of contact is rougher.
  EXPECT_NEAR(second.stiffness, 1, 0.025);
  EXPECT_NEAR(second.radius, 1, 0.01);
  EXPECT_LT(std::abs(second.force - 1), 0.5 * std::abs(first.force - 1));
  EXPECT_LT(std::abs(second.force_from_middle - 1), 0.5 * std::abs(first.force_from_middle - 1));
}

// Counted from the outside of the layer the depth would be wrong by 0.12 of its thickness, and the
// force by 2 %.
TEST(RigidContact, TheDepthIsCountedWithTheLayer) {
  const double thin = press_half_space(coarse(kCoarseThickness / 4)).force;
  EXPECT_NEAR(press_half_space(coarse(kCoarseThickness)).force, thin, 1e-3);
}

}  // namespace
}  // namespace palpate::test::test_hertz
