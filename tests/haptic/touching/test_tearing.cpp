// SPDX-License-Identifier: BSD-3-Clause
// A hand pulls a body whose cut opens.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "haptic/support/torn_box.h"
#include "haptic/touching/body_touch.h"

namespace palpate::test::test_tearing {
namespace {

class Pulling : public testing::TestWithParam<double> {
 protected:
  Pulling() {
    settings_.bonded = true;
    settings_.release_force = 0;
    settings_.fracture_toughness = kToughness;
    settings_.coupling_stiffness = GetParam();
    (void)at(0.001);
    (void)at(-1e-6);
  }

  /// The hand above the middle of the top, m.
  Contact at(double height) {
    const Vec3 place(0.5 * kBox.x() + 0.001, 0.5 * kBox.y() + 0.002, kBox.z() + height);
    place_ = place;
    last_ = touch_->move({place, Vec3::Zero(), Grasp::no_button, Time{0}}, settings_);
    return last_;
  }
  /// What the hand has done, less what is stored and what was torn, J.
  [[nodiscard]] double excess() const { return last_.hand_work - last_.energy - last_.torn_work; }

  std::shared_ptr<const Touchable> body_ =
      std::make_shared<const Touchable>(torn_box(top_points()));
  std::unique_ptr<Touch> touch_ = make_touch(body_);
  TouchSettings settings_;
  Contact last_;
  Vec3 place_ = Vec3::Zero();
};
INSTANTIATE_TEST_SUITE_P(Couplings, Pulling, testing::Values(0.0, 500.0));

TEST_P(Pulling, TearsAtItsToughnessAndStaysTorn) {
  ASSERT_TRUE(touches(last_.status));
  double first = 0;
  double largest_step = 0;
  for (double height = 0; height < 0.012; height += 2e-6) {
    const double before = last_.torn_area;
    const Contact now = at(height);
    ASSERT_GE(now.torn_area, before);
    largest_step = std::max(largest_step, now.torn_area - before);
    if (first == 0 && now.torn_area > 0) first = now.displacement.norm();
    ASSERT_GT(excess(), -2e-8) << height;
  }
  // ½ q² 8e4 (1 + ½ q²/l²) = G_c, with the springs of the three nodes.
  const double q2 = first * first;
  EXPECT_NEAR(0.5 * q2 * 8e4 * (1 + 0.5 * q2 / (kHalfWidth * kHalfWidth)), kToughness, 0.02);
  EXPECT_NEAR(last_.torn_work, kToughness * last_.torn_area, 1e-15);
  EXPECT_GT(last_.hand_work, last_.torn_work);
  // All of the energy tears at once here, but not in one tick.
  EXPECT_NEAR(last_.torn_area, kAreas.back(), 1e-14);
  EXPECT_LE(largest_step, kAreas.back() / 50 * (1 + 1e-9));
  EXPECT_GT(largest_step, 0);

  // Released, and held again.
  const double torn = last_.torn_area;
  touch_->release();
  EXPECT_EQ(at(0.02).torn_area, torn);
  (void)at(-1e-6);
  ASSERT_TRUE(touches(last_.status));
  EXPECT_EQ(at(0.001).torn_area, torn);
  EXPECT_NEAR(last_.stiffness(2, 2), 28.0 / (GetParam() > 0 ? 1 + 28.0 / GetParam() : 1), 1.5);
}

TEST_P(Pulling, DoesNotTearWithoutAToughness) {
  settings_.fracture_toughness = 0;
  for (double height = 0; height < 0.012; height += 1e-4) EXPECT_EQ(at(height).torn_area, 0);
}

TEST_P(Pulling, AnotherTouchOfTheSameSpaceGoesOnTorn) {
  for (double height = 0; height < 0.012; height += 2e-6) (void)at(height);
  const std::unique_ptr<Touch> next =
      make_touch(std::make_shared<const Touchable>(torn_box(top_points())));
  ASSERT_TRUE(next->take_over(*touch_));
  touch_->release();
  EXPECT_NEAR(next->move({place_, Vec3::Zero(), Grasp::no_button, Time{0}}, settings_).torn_area,
              kAreas.back(), 1e-14);
}

TEST(TornBody, HasTheNodesThatAllStagesHave) {
  const std::vector<Index> nodes = top_points();
  TouchSpace space = torn_box(nodes);
  EXPECT_EQ(Touchable(space).nodes().size(), nodes.size());
  // One of the stages is not explored at one node yet.
  const auto missing = std::find_if(
      space.tool_spaces.begin(), space.tool_spaces.end(), [&](const TouchToolSpace& of) {
        return of.setup.body == 3 && of.setup.interaction.active_node == nodes.front();
      });
  space.tool_spaces.erase(missing);
  const Touchable body(space);
  EXPECT_EQ(body.nodes().size(), nodes.size() - 1);
  EXPECT_EQ(body.find(nodes.front()), -1);
  EXPECT_EQ(body.nodes().front().at_stage.size(), kAreas.size());
}

}  // namespace
}  // namespace palpate::test::test_tearing
