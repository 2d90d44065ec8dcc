// SPDX-License-Identifier: BSD-3-Clause
// Friction beside a sphere on a half-space in closed form, and beside finite elements of a tool
// that does not slip at all. benchmark/contact.cpp has more of Poisson's ratios and refines
// further.
#include <gtest/gtest.h>

#include "haptic/support/mindlin.h"
#include "solvers/support/bonded_disc.h"

namespace palpate::test::test_friction_reference {
namespace {

/// P and k_n differ from the closed form by up to 1.5 % in this mesh.
constexpr double kMeshError = 0.016;

FrictionResult move_aside(double poissons_ratio) {
  HertzOptions options;
  options.edges = 2;
  options.thickness = 0.16;
  options.poissons_ratio = poissons_ratio;
  return move_aside(press_half_space(options), poissons_ratio, 0.5);
}

// The constant k_t/k_n is 0.862 and 1.051 of Mindlin's at these ends. The largest error of Q
// follows, at two thirds of the way to slipping: √3/3 of that of k_t, 8.0 and 2.9 %. That P and k_n
// are a little too large makes the first smaller and the second larger.
TEST(Friction, YieldsAsOnAHalfSpace) {
  const FrictionResult compressible = move_aside(0.3);
  EXPECT_NEAR(compressible.stiffness, 0.862, kMeshError);
  EXPECT_NEAR(compressible.slipping, 1, kMeshError);
  EXPECT_LT(compressible.error, 0.08);
  const FrictionResult nearly_incompressible = move_aside(0.49);
  EXPECT_NEAR(nearly_incompressible.stiffness, 1.051, kMeshError);
  EXPECT_NEAR(nearly_incompressible.slipping, 1, kMeshError);
  EXPECT_LT(nearly_incompressible.error, 0.029 + kMeshError);
}

// Where ν is that of the constant. The finite body makes the disc stiffer by 1.9 % against being
// pressed in and by 1.5 % against being moved along.
TEST(Friction, BeginsAsABondedToolIs) {
  BondedDiscOptions options;
  options.poissons_ratio = 0.45;
  const BondedDiscResult coarse = move_bonded_disc(options);
  options.edges *= 2;
  const BondedDiscResult bonded = extrapolate(coarse, move_bonded_disc(options));
  EXPECT_NEAR(bonded.into, 1.019, 0.003);
  EXPECT_NEAR(bonded.along, 1.015, 0.003);
  const FrictionResult friction = move_aside(options.poissons_ratio);
  EXPECT_LT(friction.error, kMeshError);
  EXPECT_NEAR(friction.stiffness, 1, kMeshError);
  EXPECT_NEAR(friction.stiffness / bonded.along, 1, kMeshError);
}

}  // namespace
}  // namespace palpate::test::test_friction_reference
