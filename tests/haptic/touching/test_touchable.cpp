// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "base/error.h"
#include "haptic/support/analytic_body.h"

namespace palpate::test::test_touchable {
namespace {

TEST(Touchable, FindsItsNodes) {
  const TouchSpace space = test::box_space([](int) { return test::stiffening_spring(200); });
  const Touchable body(space);
  ASSERT_EQ(body.nodes().size(), 9U);
  for (std::size_t n = 0; n < body.nodes().size(); ++n) {
    const Touchable::Node& node = body.nodes()[n];
    EXPECT_EQ(body.find(node.mesh_point), static_cast<std::int32_t>(n));
    EXPECT_EQ(body.node_of_surface_point(node.surface_point), static_cast<std::int32_t>(n));
    EXPECT_EQ(body.nearest(node.rest_position + Vec3(0.003, -0.002, 0), 0.01),
              static_cast<std::int32_t>(n));
  }
  EXPECT_EQ(body.find(0), -1);
  EXPECT_EQ(body.node_of_surface_point(0), -1);
  EXPECT_EQ(body.nearest(Vec3::Zero(), 0.01), -1);
  EXPECT_GT(body.bytes(), 343U * 9 * sizeof(double));
}

TEST(Touchable, LargestStiffnessIsThatOfTheConfigurations) {
  double largest = 0;
  const TouchToolSpace tool_space = test::analytic_space(test::stiffening_spring(200));
  for (const ConfigurationSummary& c : tool_space.configurations) {
    largest = std::max(largest, c.stiffness.operatorNorm());
  }
  EXPECT_NEAR(test::box_body(200)->largest_stiffness(), largest, 1e-9 * largest);
}

TEST(Touchable, BadSpaces) {
  TouchSpace space = test::box_space([](int) { return test::stiffening_spring(200); });
  const auto refuses = [](const TouchSpace& bad, const char* word) {
    try {
      const Touchable body(bad);
      ADD_FAILURE() << "accepted: " << word;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
    }
  };
  TouchSpace without = space;
  without.tool_spaces.clear();
  refuses(without, "no active node");
  space.tool_spaces[0].setup.interaction.active_node = 100000;
  refuses(space, "not on the surface");
}

}  // namespace
}  // namespace palpate::test::test_touchable
