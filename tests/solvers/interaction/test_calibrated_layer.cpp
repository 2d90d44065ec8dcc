// SPDX-License-Identifier: BSD-3-Clause
// The layer of contact that a tool has by default, on a layer of tissue that is 5 R thick and
// bonded to the ground, beside one that is so thin that nothing is left of it to count.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "base/error.h"
#include "equilibrium/equilibrium.h"
#include "interaction/interaction_list.h"
#include "interaction/mesh_error.h"
#include "interaction/rigid_capsule.h"
#include "interaction/rigid_tool.h"
#include "solvers/support/half_space.h"

namespace palpate::test {
namespace {

/// So that the mesh is even under all contacts: to a = 0.55 R.
constexpr double kRadius = 2 * kContactRadius;
constexpr double kPoissonsRatio = 0.4;
/// Half-widths. The deepest is three tenths.
constexpr double kDepths[] = {0.05, 0.1, 0.3};
/// How deep the tool is pushed in one solve, half-widths: a thin layer allows no more.
constexpr double kStep = 0.025;
/// The parts of an edge for the integration of contact: for the default, points that are as far
/// apart as half of its spacing, which edges of that length ask for; and for a thin layer.
constexpr int kDivisions = 1;
constexpr int kFineDivisions = 4;
/// The pressure at single points scatters on this mesh, and with it what is told of the layer: by
/// this share of the force.
constexpr double kScatter = 0.06;
/// 4 edges in a, 5 R deep and wide, one sector of 16.
const HalfSpaceOptions kSector{4, 10, 16, 1};

struct Press {
  double force = 0;
  double layer_force = 0;
};

/// The forces of a sphere at all depths.
std::vector<Press> press(const Scene& scene, const ContactLaw& law, int divisions) {
  const RigidContact contact(
      std::make_shared<const ContactSurface>(ContactSurface::divided(scene, divisions)),
      make_sphere(kRadius), law);
  InteractionList tools;
  tools.add(contact);
  tools.add(SymmetryPlanes(scene.mesh, kSector));
  EquilibriumOptions options;
  // Rounding in the stiff springs allows no less.
  options.tolerance = 1e-8;
  EquilibriumSolver solver(scene, options);
  solver.set_interaction(tools);
  double now = -1.01 * law.reach() / kRadius;
  Equilibrium state = solver.rest(Vec3(0, 0, kRadius * (1 - now)));
  std::vector<Press> presses;
  for (const double depth : kDepths) {
    while (now < depth) {
      now = std::min(now + kStep, depth);
      state = solver.solve(Vec3(0, 0, kRadius * (1 - now)), state);
      EXPECT_EQ(state.outcome, Outcome::converged) << state.message;
    }
    const Vec3 force = kSector.sectors * state.reaction.z() * Vec3::UnitZ();
    const Mat3 stiffness = kSector.sectors * state.stiffness;
    presses.push_back({-force.z(), contact_layer_force(contact.patch(state.t, state.u).layer_depth,
                                                       force, stiffness)});
  }
  return presses;
}

/// Of a sphere on a layer of a height that is bonded to the ground, over Hertz's force (Dimitriadis
/// et al., Biophys. J. 82, 2002, eq. 12).
double finite_thickness(double depth, double height) {
  const double nu = kPoissonsRatio;
  const double chi = std::sqrt(kRadius * depth) / height;
  const double alpha = -(1.2876 - 1.4678 * nu + 1.3442 * nu * nu) / (1 - nu);
  const double beta = (0.6387 - 1.0277 * nu + 1.5164 * nu * nu) / (1 - nu);
  const double pi = M_PI;
  return 1 - 2 * alpha / pi * chi + 4 * alpha * alpha / (pi * pi) * chi * chi -
         8 / std::pow(pi, 3) * (std::pow(alpha, 3) + 4 * pi * pi / 15 * beta) * std::pow(chi, 3) +
         16 * alpha / std::pow(pi, 4) * (std::pow(alpha, 3) + 3 * pi * pi / 5 * beta) *
             std::pow(chi, 4);
}

class CalibratedLayer : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    hard_ = press(scene(), {0.01 * kRadius, 20 * kYoungsModulus, 0.0083 * kRadius}, kFineDivisions);
  }
  [[nodiscard]] static const Scene& scene() {
    static const Scene scene = make_half_space(kSector, kPoissonsRatio);
    return scene;
  }
  [[nodiscard]] static double error(const std::vector<Press>& presses, int i) {
    return presses[i].force / hard_[i].force - 1;
  }

  static std::vector<Press> hard_;
};
std::vector<Press> CalibratedLayer::hard_;

TEST_F(CalibratedLayer, PressesAsAHardToolDoes) {
  RigidTool tool;
  tool.radius = kRadius;
  const RigidTool with_layer = with_defaults(tool, scene());
  EXPECT_EQ(with_layer.law.thickness, 0.2 * kRadius);
  EXPECT_GT(with_layer.law.offset, 0.9 * with_layer.law.thickness);
  const std::vector<Press> soft = press(scene(), with_layer.law, kDivisions);
  EXPECT_LT(std::abs(error(soft, 0)), 0.15);
  EXPECT_LT(std::abs(error(soft, 1)), 0.05);
  EXPECT_LT(std::abs(error(soft, 2)), 0.05);
  // And it is told.
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(soft[i].layer_force, soft[i].force - hard_[i].force, kScatter * hard_[i].force)
        << i;
  }
}

// What earlier versions chose, at a twentieth of the radius five times too strong.
TEST_F(CalibratedLayer, ALayerThatIsNotIsTold) {
  const std::vector<Press> thick =
      press(scene(), {0.2 * kRadius, 2 * kYoungsModulus, 0}, kDivisions);
  EXPECT_GT(error(thick, 0), 3);
  EXPECT_GT(error(thick, 1), 1);
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(thick[i].layer_force / (thick[i].force - hard_[i].force), 1, 0.1) << i;
  }
}

// The body ends aside, too: it is a little stiffer.
TEST_F(CalibratedLayer, TheHardToolIsThatOfTheClosedForm) {
  const double modulus = kYoungsModulus / (1 - kPoissonsRatio * kPoissonsRatio);
  for (int i = 0; i < 3; ++i) {
    const double depth = kDepths[i] * kRadius;
    const double hertz = 4.0 / 3 * modulus * std::sqrt(kRadius) * std::pow(depth, 1.5);
    EXPECT_NEAR(hard_[i].force / (hertz * finite_thickness(depth, 5 * kRadius)), 1, 0.04) << i;
  }
}

// A layer of the user's own stays what it was.
TEST_F(CalibratedLayer, AThicknessThatIsGivenIsKept) {
  RigidTool tool;
  tool.radius = kRadius;
  tool.law.thickness = 0.004;
  ContactLaw law = with_defaults(tool, scene()).law;
  EXPECT_EQ(law.thickness, 0.004);
  EXPECT_NEAR(law.stiffness, 2 * kYoungsModulus, 1e-9 * kYoungsModulus);
  EXPECT_EQ(law.offset, 0);
  tool.law = {0, 1e4};
  law = with_defaults(tool, scene()).law;
  EXPECT_EQ(law, (ContactLaw{0.2 * kRadius, 1e4, 0}));
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
}  // namespace palpate::test
