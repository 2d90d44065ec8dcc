// SPDX-License-Identifier: BSD-3-Clause
// Two round elastic bodies that press each other, beside Hertz and beside a rigid plane. The
// reduced case of a benchmark.
#include <gtest/gtest.h>

#include "solvers/support/two_half_spaces.h"

namespace palpate::test::test_round_parts {
namespace {

TwoHalfSpacesOptions small() {
  TwoHalfSpacesOptions options;
  options.lower_edges = 3;
  options.upper_edges = 3;
  options.extent = 24;
  return options;
}

/// The stiffness beside Hertz's at the same force, without what the bodies are too stiff for being
/// held at a finite distance (half_space.h).
double stiffness_ratio(const TwoHalfSpacesOptions& options) {
  const TwoHalfSpacesResult found = press_half_spaces(options);
  const double held = 1.2 * found.radius / (0.01 * options.extent);
  return found.stiffness / found.hertz_stiffness / (1 + held);
}

TEST(RoundParts, HaveHertzsStiffnessAtTheSameForce) {
  EXPECT_NEAR(stiffness_ratio(small()), 1, 0.04);
  TwoHalfSpacesOptions options = small();
  options.of_upper = 1;  // on a flat block
  options.stiffer = 4;
  EXPECT_NEAR(stiffness_ratio(options), 1, 0.04);
}

TEST(RoundParts, AreToldWhatTheLayerAdds) {
  // From where the surfaces meet.
  constexpr double kApproach = 0.0025;
  const auto press = [](double thickness) {
    TwoHalfSpacesOptions options = small();
    options.thickness = thickness;
    options.approach = kApproach + thickness * 0.01 / options.lower_edges;
    return press_half_spaces(options);
  };
  const TwoHalfSpacesResult usual = press(0.2);
  const TwoHalfSpacesResult thin = press(0.1);
  EXPECT_GT(usual.layer_force, 0.1 * usual.force);
  EXPECT_NEAR(thin.layer_force / usual.layer_force, 0.5, 0.1);
  const double hard = thin.force - thin.layer_force;
  EXPECT_NEAR(usual.force - usual.layer_force, hard, 0.25 * usual.layer_force);
}

TEST(RoundParts, PressEachOtherAsOnePressesARigidPlane) {
  TwoHalfSpacesOptions options = small();
  const double of_pair = press_half_spaces(options).force;
  options.thickness /= 2;
  options.approach /= 2;
  options.radius *= 2;
  options.is_lower_rigid = true;
  EXPECT_NEAR(press_half_spaces(options).force, of_pair, 0.005 * of_pair);
}

}  // namespace
}  // namespace palpate::test::test_round_parts
