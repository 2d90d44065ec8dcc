// SPDX-License-Identifier: BSD-3-Clause
// The layer of contact that a tool has by default, on a layer of tissue that is 5 R thick and
// bonded to the ground, beside one that is so thin that nothing is left of it to count.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "base/error.h"
#include "interaction/mesh_error.h"
#include "interaction/rigid_tool.h"
#include "solvers/support/bonded_layer.h"
#include "solvers/support/half_space.h"

namespace palpate::test::test_contact_layer {
namespace {

const BondedLayer kLayer;
/// In radii. The deepest is three tenths.
const std::vector<double> kDepths{0.05, 0.1, 0.3};
/// The pressure at single points scatters on this mesh, and with it what is told of the layer: by
/// this share of the force.
constexpr double kScatter = 0.06;

/// The forces at all depths, with the points of integration that a filter takes.
std::vector<LayerPress> press(const Scene& scene, const ContactLaw& law) {
  return press_layer(
      kLayer, scene,
      std::make_shared<const ContactSurface>(scene.body, kSpacingOfThickness * law.thickness), law,
      kDepths);
}

class ContactLayer : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    hard_ = press_layer(kLayer, scene(), hard_surface(scene()), hard_law(kLayer), kDepths);
  }
  [[nodiscard]] static const Scene& scene() {
    static const Scene scene = make_bonded_layer(kLayer);
    return scene;
  }
  [[nodiscard]] static double error(const std::vector<LayerPress>& presses, int i) {
    return presses[i].force / hard_[i].force - 1;
  }

  static std::vector<LayerPress> hard_;
};
std::vector<LayerPress> ContactLayer::hard_;

TEST_F(ContactLayer, PressesAsAHardToolDoes) {
  RigidTool tool;
  tool.radius = kLayer.radius;
  const RigidTool with_layer = with_defaults(tool, scene());
  EXPECT_EQ(with_layer.law.thickness, 0.2 * kLayer.radius);
  EXPECT_GT(with_layer.law.offset, 0.9 * with_layer.law.thickness);
  const std::vector<LayerPress> soft = press(scene(), with_layer.law);
  EXPECT_LT(std::abs(error(soft, 0)), 0.15);
  EXPECT_LT(std::abs(error(soft, 1)), 0.05);
  EXPECT_LT(std::abs(error(soft, 2)), 0.05);
  // And it is told.
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(soft[i].layer_force, soft[i].force - hard_[i].force, kScatter * hard_[i].force)
        << i;
  }
}

// A layer of the default thickness that is given: at a twentieth of the radius the force is seven
// times too strong.
TEST_F(ContactLayer, WhatAThickOneAddsToTheForceIsTold) {
  const std::vector<LayerPress> thick =
      press(scene(), {0.2 * kLayer.radius, 2 * kYoungsModulus, 0});
  EXPECT_GT(error(thick, 0), 3);
  EXPECT_GT(error(thick, 1), 1);
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(thick[i].layer_force / (thick[i].force - hard_[i].force), 1, 0.1) << i;
  }
}

// The body ends aside, too: it is a little stiffer.
TEST_F(ContactLayer, TheHardToolIsThatOfTheClosedForm) {
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(hard_[i].force / closed_form(kLayer, kDepths[i]), 1, 0.04) << i;
  }
}

// A layer of the user's own stays what it was.
TEST_F(ContactLayer, AThicknessThatIsGivenIsKept) {
  RigidTool tool;
  tool.radius = kLayer.radius;
  tool.law.thickness = 0.004;
  ContactLaw law = with_defaults(tool, scene()).law;
  EXPECT_EQ(law.thickness, 0.004);
  EXPECT_NEAR(law.stiffness, 2 * kYoungsModulus, 1e-9 * kYoungsModulus);
  EXPECT_EQ(law.offset, 0);
  tool.law = {0, 1e4};
  law = with_defaults(tool, scene()).law;
  EXPECT_EQ(law, (ContactLaw{0.2 * kLayer.radius, 1e4, 0}));
}

TEST(ContactLaw, AnOffsetIsAtLeastZeroAndLessThanTheThickness) {
  EXPECT_NO_THROW(validate(ContactLaw{0.002, 1e4, 0.001}));
  for (const double offset : {-0.001, 0.002, std::nan("")}) {
    EXPECT_THROW(validate(ContactLaw{0.002, 1e4, offset}), InputError) << offset;
  }
}

// Figures of the page of Solve Equilibrium.
TEST(MeshError, GrowsWithTheEdgesOverTheRadiusOfContact) {
  const double area = M_PI * 0.01 * 0.01;
  const auto error = [&](ElementOrder order, double x) {
    return expected_mesh_error(order, 0.01 * x, area);
  };
  EXPECT_NEAR(error(ElementOrder::quadratic, 1), 0.04, 0.005);
  EXPECT_NEAR(error(ElementOrder::quadratic, 5), 0.66, 0.005);
  EXPECT_NEAR(error(ElementOrder::linear, 1), 0.45, 0.005);
  EXPECT_NEAR(error(ElementOrder::linear, 5), 3.65, 0.05);
  EXPECT_EQ(expected_mesh_error(ElementOrder::linear, 0, 0), 0);
}

// Where the tool slides off there is no depth that the force could belong to.
TEST(ContactLayerForce, IsNotKnownWithoutStiffness) {
  EXPECT_EQ(contact_layer_force(1e-3, Vec3::Zero(), Mat3::Identity()), 0);
  EXPECT_TRUE(std::isnan(contact_layer_force(1e-3, Vec3::UnitZ(), -Mat3::Identity())));
  // F = d^{3/2} at d = 1, of which a part is the layer's.
  EXPECT_NEAR(contact_layer_force(0.2, Vec3::UnitZ(), 1.5 * Mat3::Identity()),
              1 - std::pow(0.8, 1.5), 1e-15);
  EXPECT_EQ(contact_layer_force(2, Vec3::UnitZ(), 1.5 * Mat3::Identity()), 1);
}

}  // namespace
}  // namespace palpate::test::test_contact_layer
