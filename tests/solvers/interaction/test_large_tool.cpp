// SPDX-License-Identifier: BSD-3-Clause
// A block that a tool larger than itself presses, beside the closed form: without friction, and
// held so that it may spread, it is in uniaxial stress.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "equilibrium/equilibrium.h"
#include "interaction/interaction_spec.h"
#include "solvers/support/block.h"
#include "solvers/support/box_mesh.h"
#include "solvers/support/laws.h"

namespace palpate::test::test_large_tool {
namespace {

constexpr double kModulus = 5000;
constexpr double kThickness = 0.0004;
const Vec3 kSize(0.04, 0.03, 0.02);

/// Of a material whose strain across is zero, the block may be held at its bottom as a whole.
Scene make_pressed_block() {
  TetMesh mesh = make_box(ElementOrder::linear, {8, 6, 4}, kSize);
  std::vector<char> fixed;
  for (const Vec3& p : mesh.points) fixed.push_back(p.z() == 0 ? 1 : 0);
  return make_scene(std::move(mesh), make_isotropic(Law::linear, kModulus, 0), fixed);
}

RigidTool make_plate(const Vec3& size) {
  const TetMesh box = make_box(ElementOrder::linear, {1, 1, 1}, size);
  RigidTool tool;
  tool.shape = ToolShape::surface;
  for (const Vec3& p : box.points) tool.points.emplace_back(p - 0.5 * size);
  tool.triangles = boundary_triangles(box);
  return tool;
}

RigidTool make_ball(double radius) {
  RigidTool tool;
  tool.radius = radius;
  return tool;
}

/// A tool above the middle of the block.
class Press {
 public:
  /// @param below How far the tool reaches down, m.
  Press(const Scene& scene, const RigidTool& tool, double below)
      : spec_(rigid_contact_spec(with_defaults(tool, scene))),
        below_(below),
        factory_(scene.body, {}),
        solver_(scene, {}) {
    solver_.set_interaction(*factory_.make(spec_));
  }

  [[nodiscard]] const ContactLaw& law() const { return spec_.tool.law; }
  /// So deep in the top of the block, to which it comes from where it is clear.
  [[nodiscard]] Equilibrium at(double depth) {
    const Vec3 q(0.5 * kSize.x(), 0.5 * kSize.y(), kSize.z() - depth + below_);
    return solver_.solve(q, solver_.rest(factory_.clearance(spec_)->start_for(q)));
  }

 private:
  InteractionSpec spec_;
  double below_;
  InteractionFactory factory_;
  EquilibriumSolver solver_;
};

/// How far the pressure keeps the surface from the tool: p = κ (1 − (g + offset)/δ)³.
double gap_at(double pressure, const ContactLaw& law) {
  return law.thickness * (1 - std::cbrt(pressure / law.stiffness)) - law.offset;
}

/// The force on the tool where the whole top moves down as one, N: the depth that the block is
/// shortened by is less than that of the tool by the gap.
double uniaxial_force(double depth, const ContactLaw& law) {
  double low = 0;
  double high = kModulus * (depth + law.thickness) / kSize.z();
  for (int i = 0; i < 100; ++i) {
    const double pressure = 0.5 * (low + high);
    const double shortened = depth + gap_at(pressure, law);
    (pressure < kModulus * shortened / kSize.z() ? low : high) = pressure;
  }
  return low * kSize.x() * kSize.y();
}

TEST(LargeTool, APlateGivesUniaxialStress) {
  const Scene scene = make_pressed_block();
  RigidTool plate = make_plate({0.05, 0.04, 0.03});
  plate.law.thickness = 10 * kThickness;
  Press press(scene, plate, 0.015);
  for (const double depth : {0.001, 0.002}) {
    const Equilibrium state = press.at(depth);
    ASSERT_EQ(state.outcome, Outcome::converged) << state.summary.message;
    const double expected = uniaxial_force(depth, press.law());
    // The layer presses the sides of the block too, as far down as it reaches.
    EXPECT_NEAR(-state.reaction[2], expected, 0.01 * expected);
    EXPECT_LE(state.reaction.head<2>().norm(), 1e-3 * expected);
  }
}

// Of a plate nine times as wide as it is thick the layer is thicker than of another tool, as thick
// as the grid of its distance needs, and as stiff; and so is that of one which is thinner than
// that.
TEST(LargeTool, AThinPlateNeedsNoThicknessOfTheUser) {
  const Scene scene = make_pressed_block();
  for (const double thickness : {0.01, 0.001}) {
    SCOPED_TRACE(thickness);
    Press press(scene, make_plate({0.09, 0.09, thickness}), 0.5 * thickness);
    EXPECT_GT(press.law().thickness, kThicknessOfRadius * 0.5 * thickness);
    constexpr double kDepth = 0.002;
    const Equilibrium state = press.at(kDepth);
    ASSERT_EQ(state.outcome, Outcome::converged) << state.summary.message;
    const double expected = uniaxial_force(kDepth, press.law());
    EXPECT_NEAR(-state.reaction[2], expected, 0.01 * expected);
  }
}

// Of a ball of a radius R the face of the block sees a dent of size²/8R. Its layer is a tenth of
// that of the plate above, and so is what the sides of the block feel.
TEST(LargeTool, AVeryLargeBallIsAPlate) {
  constexpr double kRadius = 100;
  constexpr double kDepth = 0.001;
  RigidTool ball = make_ball(kRadius);
  ball.law.thickness = kThickness;
  Press press(make_pressed_block(), ball, kRadius);
  const Equilibrium state = press.at(kDepth);
  ASSERT_EQ(state.outcome, Outcome::converged) << state.summary.message;
  const double expected = uniaxial_force(kDepth, press.law());
  const double dent = kSize.head<2>().squaredNorm() / (8 * kRadius);
  EXPECT_NEAR(-state.reaction[2], expected, (dent / kDepth + 1e-3) * expected);
}

TEST(LargeTool, TheForceIsTheDerivativeOfTheEnergy) {
  const Scene scene = make_pressed_block();
  RigidTool rod = make_ball(0.03);
  rod.shape = ToolShape::capsule;
  rod.axis = Vec3(1, 0.2, 0);
  rod.length = 0.2;
  RigidTool plate = make_plate({0.05, 0.04, 0.03});
  plate.law.thickness = 0.004;
  struct Case {
    RigidTool tool;
    double below;
  };
  for (const Case& each : {Case{make_ball(0.2), 0.2}, Case{rod, 0.03}, Case{plate, 0.015}}) {
    SCOPED_TRACE(name_of(each.tool));
    constexpr double kDepth = 0.002;
    constexpr double kStep = 2e-5;
    Press press(scene, each.tool, each.below);
    const Equilibrium middle = press.at(kDepth);
    const Equilibrium less = press.at(kDepth - kStep);
    const Equilibrium more = press.at(kDepth + kStep);
    for (const Equilibrium& state : {middle, less, more}) {
      ASSERT_EQ(state.outcome, Outcome::converged) << state.summary.message;
    }
    // The difference is wrong by kStep²/6 of the third derivative.
    EXPECT_NEAR((less.energy - more.energy) / (2 * kStep), middle.reaction[2],
                1e-3 * std::abs(middle.reaction[2]));
  }
}

}  // namespace
}  // namespace palpate::test::test_large_tool
