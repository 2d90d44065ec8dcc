// SPDX-License-Identifier: BSD-3-Clause
// A tool that slides over a flat surface. benchmark/contact.cpp has more meshes.
#include <gtest/gtest.h>

#include "solvers/support/sliding.h"

namespace palpate::test::test_sliding {
namespace {

/// A fifth of the radius.
constexpr double kThick = 0.002;

// Edges are as long as the radius. The bounds are such that the rule of six points on faces that
// are not divided, with 0.76 % and 0.60 %, is too coarse. What is divided has 0.52 % and 0.25 %.
TEST(RigidContact, FeelsLittleOfTheMeshWhereItSlides) {
  const SlidingResult result = slide({0.01, 12, 1, kThick});
  EXPECT_LT(result.lateral, 0.007);
  EXPECT_LT(result.stiffness_jump, 0.004);
}

// The layer that is calibrated is stiffer, and more of the mesh is felt through it.
TEST(RigidContact, FeelsMoreOfTheMeshByDefault) {
  const SlidingResult result = slide({});
  EXPECT_LT(result.lateral, 0.03);
  EXPECT_LT(result.stiffness_jump, 0.02);
}

}  // namespace
}  // namespace palpate::test::test_sliding
