// SPDX-License-Identifier: BSD-3-Clause
// A hand draws a blade through a cut.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <vector>

#include "cutting/opened_scene.h"
#include "haptic/support/torn_box.h"
#include "haptic/touching/body_touch.h"
#include "solvers/support/cut_cube.h"

namespace palpate::test::test_blade {
namespace {

constexpr double kAll = std::numeric_limits<double>::infinity();
/// A tick at 20 mm/s, m.
constexpr double kTick = 2e-5;

class SheetOfCube : public testing::TestWithParam<ElementOrder> {
 protected:
  const Scene closed_ = make_cut_scene(GetParam());
  const Surface surface_ = make_surface(open_scene(closed_, 3).scene.body);
  const CutSheet sheet_{surface_, closed_.body.cut.areas};
};
INSTANTIATE_TEST_SUITE_P(Orders, SheetOfCube,
                         testing::Values(ElementOrder::linear, ElementOrder::quadratic));

TEST_P(SheetOfCube, HasTheAreaBehindEachPlace) {
  for (double x = 0.03; x < 0.75; x += 0.09) {
    for (double y = 0.04; y < 1; y += 0.13) {
      const CutSheet::Nearest at = sheet_.nearest(Vec3(x, y, 0.6), kAll);
      EXPECT_NEAR(at.area, x, 1e-12);
      EXPECT_NEAR((at.point - Vec3(x, y, 0.5)).norm(), 0, 1e-12);
      EXPECT_NEAR((at.rise - Vec3::UnitX()).norm(), 0, 1e-12);
      EXPECT_NEAR((at.follows - Mat3(Vec3(1, 1, 0).asDiagonal())).norm(), 0, 1e-9);
    }
  }
  EXPECT_NEAR(sheet_.nearest(Vec3(2, 0.4, 0.5), kAll).area, 0.75, 1e-12);
  EXPECT_EQ(sheet_.nearest(Vec3(std::nan(""), 0, 0), kAll).triangle, -1);
}

TEST_P(SheetOfCube, FindsTheNearestPlaceOfWhatIsOpen) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> anywhere(-0.3, 1.3);
  for (int n = 0; n < 500; ++n) {
    const double open = std::clamp(anywhere(random), 0.0, 0.75);
    const Vec3 place(anywhere(random), anywhere(random), anywhere(random));
    const CutSheet::Nearest at = sheet_.nearest(place, open);
    const Vec3 right(std::clamp(place.x(), 0.0, open), std::clamp(place.y(), 0.0, 1.0), 0.5);
    ASSERT_GE(at.triangle, 0);
    ASSERT_NEAR((at.point - right).norm(), 0, 1e-9) << open << " " << place.transpose();
    ASSERT_NEAR(at.distance, (place - right).norm(), 1e-9);
  }
}

TEST_P(SheetOfCube, MovesAsThePlaceDoes) {
  std::mt19937 random(6);
  std::uniform_real_distribution<double> anywhere(-0.3, 1.3);
  constexpr double kStep = 1e-6;
  for (int n = 0; n < 300; ++n) {
    const Vec3 place(anywhere(random), anywhere(random), anywhere(random));
    const Mat3 follows = sheet_.nearest(place, kAll).follows;
    for (int a = 0; a < 3; ++a) {
      const Vec3 aside = kStep * Vec3::Unit(a);
      const Vec3 moved =
          sheet_.nearest(place + aside, kAll).point - sheet_.nearest(place - aside, kAll).point;
      EXPECT_NEAR((moved / (2 * kStep) - follows.col(a)).norm(), 0, 1e-6) << place.transpose();
    }
  }
}

TEST_P(SheetOfCube, MeetsTheSurfaceInItsMouth) {
  double length = 0;
  for (const auto& [a, b] : mouth_of_cut(surface_)) {
    EXPECT_EQ(a.z(), 0.5);
    EXPECT_EQ(b.z(), 0.5);
    const Vec3 middle = (a + b) / 2;
    EXPECT_TRUE(middle.x() == 0 || middle.y() == 0 || middle.y() == 1) << middle.transpose();
    length += (b - a).norm();
  }
  // Of both lips.
  EXPECT_NEAR(length, 2 * (1 + 2 * 0.75), 1e-12);
}

TEST(SheetOfOneStage, BeginsAtTheSurface) {
  Scene scene = make_cut_scene(ElementOrder::linear);
  for (OpenedFaces& faces : scene.body.cut.faces) {
    for (std::int32_t& stage : faces) stage = std::min(stage, 1);
  }
  scene.body.cut.areas = {0, 0.75};
  const CutSheet sheet(make_surface(open_scene(scene, 1).scene.body), scene.body.cut.areas);
  EXPECT_NEAR(sheet.nearest(Vec3(0, 0.5, 0.5), kAll).area, 0, 1e-12);
  EXPECT_NEAR(sheet.nearest(Vec3(0.3, 0, 0.5), kAll).area, 0, 1e-12);
  EXPECT_NEAR(sheet.nearest(Vec3(0.75, 0.5, 0.5), kAll).area, 0.75, 1e-12);
}

class Cutting : public testing::Test {
 protected:
  Cutting() {
    settings_.bonded = true;
    settings_.release_force = 0;
    settings_.coupling_stiffness = 500;
    settings_.is_blade = true;
    settings_.blade_toughness = kToughness;
    settings_.blade_friction = kFriction;
  }

  static constexpr double kFriction = 0.004;

  /// The hand beside the sheet, which is at y = 0.
  Contact at(double x, double y = 0, double z = -0.001) {
    return move(Vec3(x, 0.5 * kBox.y() + y, kBox.z() + z));
  }
  Contact move(const Vec3& place) {
    last_ = touch_->move({place, Vec3::Zero(), Grasp::no_button, Time{0}}, settings_);
    return last_;
  }
  void go(double from, double to) {
    const double step = to > from ? kTick : -kTick;
    for (double x = from; (to - x) * step > 0; x += step) (void)at(x);
  }
  void enter() {
    (void)at(-0.001);
    (void)at(0);
  }
  [[nodiscard]] double excess() const {
    return last_.hand_work - last_.energy - last_.torn_work - last_.friction_work;
  }

  std::shared_ptr<const Touchable> body_ =
      std::make_shared<const Touchable>(torn_box(top_points()));
  std::unique_ptr<Touch> touch_ = make_touch(body_);
  TouchSettings settings_;
  Contact last_;
};

TEST_F(Cutting, FeelsTheToughnessOfTheFrontAndTheFriction) {
  EXPECT_EQ(at(-0.001).status, ContactStatus::free);
  EXPECT_EQ(at(0).status, ContactStatus::cutting);
  EXPECT_EQ(last_.force.norm(), 0);
  EXPECT_EQ(last_.torn_area, 0);
  go(0, 0.025);
  (void)at(0.025);
  const double force = kToughness * kFrontLength + kFriction;
  EXPECT_NEAR(last_.force.x(), -force, 1e-9);
  EXPECT_NEAR(last_.force.tail<2>().norm(), 0, 1e-12);
  EXPECT_NEAR(last_.torn_area, kFrontLength * (0.025 - force / 500), 1e-12);
  EXPECT_NEAR(last_.anchor.x() * kFrontLength, last_.torn_area, 1e-12);
  EXPECT_NEAR(last_.torn_work, kToughness * last_.torn_area, 1e-15);
  EXPECT_NEAR(last_.friction_work, kFriction * last_.anchor.x(), 1e-12);
  // Half of k |Δx|² is lost in each of eight steps of a tick.
  EXPECT_NEAR(excess(), 0.5 * 500 * kTick / 8 * 0.025, 0.1 * excess());
  EXPECT_GE(excess(), 0);

  // Back through what is cut there is the friction alone, and nothing more opens.
  const double torn = last_.torn_area;
  go(0.025, 0.01);
  EXPECT_NEAR(last_.force.x(), kFriction, 1e-9);
  EXPECT_EQ(last_.torn_area, torn);
  // To the end, beyond which the body is whole.
  go(0.01, 0.042);
  (void)at(0.042);
  EXPECT_NEAR(last_.torn_area, kAreas.back(), 1e-15);
  EXPECT_NEAR(last_.anchor.x(), 0.04, 1e-9);
  EXPECT_NEAR(last_.force.x(), -500 * 0.002, 1e-9);
  EXPECT_GE(excess(), 0);
}

TEST_F(Cutting, IsHelpedByABodyThatIsPulledOpen) {
  settings_.is_blade = false;
  const Vec3 held(0.5 * kBox.x(), 0.5 * kBox.y(), kBox.z());
  constexpr double kPulled = 0.004;
  (void)move(held + 0.001 * Vec3::UnitZ());
  (void)move(held);
  ASSERT_EQ(last_.status, ContactStatus::attached);
  for (double height = 0; height < kPulled; height += kTick)
    (void)move(held + height * Vec3::UnitZ());
  const Contact pulled = last_;
  settings_.is_blade = true;
  EXPECT_EQ(at(-0.001).status, ContactStatus::free);
  EXPECT_EQ(last_.displacement, pulled.displacement) << "the body is held as it was";
  EXPECT_EQ(last_.force.norm(), 0);
  touch_->release();
  enter();
  const double before = excess();
  go(0, 0.025);
  const double q2 = pulled.displacement.squaredNorm();
  const double released = 0.5 * q2 * 8e4 * (1 + 0.5 * q2 / (kHalfWidth * kHalfWidth));
  EXPECT_GT(released, 0.5 * kToughness);
  EXPECT_NEAR(-last_.force.x(), (kToughness - released) * kFrontLength + kFriction, 2e-5);
  EXPECT_GE(excess() - before, 0);
  EXPECT_EQ(last_.displacement, pulled.displacement);

  // Without the blade the body is let go, and stays cut.
  settings_.is_blade = false;
  const double torn = last_.torn_area;
  EXPECT_FALSE(touches(at(0.025).status));
  EXPECT_EQ(last_.torn_area, torn);
  EXPECT_EQ(last_.displacement.norm(), 0);
}

TEST_F(Cutting, ForceIsTheDerivativeOfTheEnergy) {
  enter();
  go(0, 0.02);
  // The friction holds the blade, and it opens nothing where the hand goes back a little.
  const Contact there = at(0.02 - 2e-6);
  EXPECT_NEAR(there.stiffness(0, 0), 500, 1e-6);
  EXPECT_NEAR(there.stiffness(1, 1), 0, 1e-6);
  const double before = at(0.02 - 3e-6).energy;
  const double after = at(0.02 - 1e-6).energy;
  EXPECT_NEAR((after - before) / 2e-6, -there.force.x(), 1e-9);
}

TEST_F(Cutting, MakesNoEnergyOnRandomWays) {
  std::mt19937 random(8);
  std::normal_distribution<double> push(0, 1);
  settings_.fracture_toughness = 5 * kToughness;
  for (int way = 0; way < 15; ++way) {
    touch_ = make_touch(std::make_shared<const Touchable>(torn_box(top_points())));
    enter();
    Vec3 place(0, 0, -0.001);
    Vec3 velocity = Vec3::Zero();
    double torn = 0;
    for (int tick = 0; tick < 3000; ++tick) {
      const Vec3 back = Vec3(0.015, 0, -0.003) - place;
      velocity +=
          3e-6 * Vec3(push(random), push(random), push(random)) - 0.02 * velocity + 1e-5 * back;
      place += velocity;
      (void)at(place.x(), place.y(), place.z());
      ASSERT_GE(last_.torn_area, torn);
      torn = last_.torn_area;
      // Where q(x) comes to the border of the sheet, the hand's work has an error.
      ASSERT_GE(excess(), -1e-6 * kToughness * kAreas.back()) << way << " " << tick;
      if (last_.status == ContactStatus::cutting) {
        ASSERT_LE(last_.anchor.x() * kFrontLength, torn + 1e-12);
      }
    }
    EXPECT_GT(torn, 0) << way;
  }
}

TEST_F(Cutting, BeginsAtTheCutAlone) {
  // Far from the mouth the blade does not go in, and a body without a toughness is not cut.
  (void)at(0.03, 0.03, 0.001);
  EXPECT_EQ(at(0.03, 0.03, -0.0001).status, ContactStatus::inside);
  settings_.reach = 0.002;
  (void)at(0.03, 0, 0.001);
  EXPECT_EQ(at(0.03, 0, -0.0001).status, ContactStatus::inside);
  settings_.blade_toughness = 0;
  enter();
  go(0, 0.01);
  EXPECT_EQ(last_.status, ContactStatus::cutting);
  EXPECT_EQ(last_.torn_area, 0);
  EXPECT_NEAR(last_.force.x(), -500 * 0.01, 0.02);
}

TEST_F(Cutting, LeavesAsideAndGoesOnInAnotherSpace) {
  settings_.reach = 0.004;
  enter();
  go(0, 0.02);
  const Contact there = last_;
  const std::unique_ptr<Touch> next =
      make_touch(std::make_shared<const Touchable>(torn_box(top_points())));
  ASSERT_TRUE(next->take_over(*touch_));
  const Contact on = next->move(
      {Vec3(0.02, 0.5 * kBox.y(), kBox.z() - 0.001), Vec3::Zero(), Grasp::no_button, Time{0}},
      settings_);
  EXPECT_EQ(on.status, ContactStatus::cutting);
  EXPECT_NEAR((on.force - there.force).norm(), 0, 0.011);
  // Across the sheet nothing is felt until the blade leaves.
  for (double y = 0; y < 0.0039; y += 1e-4) {
    ASSERT_NEAR(std::abs(at(0.02, y).force.y()), 0, 1e-12);
    ASSERT_EQ(last_.status, ContactStatus::cutting);
  }
  EXPECT_EQ(at(0.02, 0.0041).status, ContactStatus::inside);
  EXPECT_EQ(last_.force.norm(), 0);
  EXPECT_GE(last_.torn_area, there.torn_area);
  touch_->release();
  EXPECT_FALSE(touches(at(0.02).status));
}

}  // namespace
}  // namespace palpate::test::test_blade
