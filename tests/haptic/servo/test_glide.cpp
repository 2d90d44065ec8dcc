// SPDX-License-Identifier: BSD-3-Clause
// Slides through the servo loop over a body with a space for a rigid tool. benchmark/glide.cpp does
// the same on an organ.
#include <gtest/gtest.h>

#include "haptic/support/glide.h"
#include "haptic/support/pressed_body.h"

namespace palpate::test::test_glide {
namespace {

class Glide : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    // Small triangles: the way has to keep off those that are in part beyond the space.
    space_ = new TouchSpace(box_space([](int) { return stiffening_spring(1000); }, {}, 16));
    space_->tool_spaces.insert(space_->tool_spaces.begin(), pressed_tool_space());
    body_ = new std::shared_ptr<const Touchable>(std::make_shared<const Touchable>(*space_));
  }
  static void TearDownTestSuite() {
    delete space_;
    delete body_;
  }

  /// @param explained Of a slide, with its figures.
  template <class Check>
  void slide(const TouchSettings& touch, bool passivity_control, Check&& check) const {
    GlideOptions options;
    options.length = 0.02;
    options.depth = 0.005;
    const GlidePaths paths(*space_, **body_, options);
    std::mt19937 random(11);
    GlideRig rig(*body_, touch, passivity_control);
    for (int i = 0; i < 40; ++i) {
      const std::vector<Vec3> way = paths.next(random);
      const GlideFigures figures = rig.slide(way);
      EXPECT_GT(figures.pressing, 100);
      EXPECT_EQ(figures.not_finite, 0);
      EXPECT_EQ(figures.beyond_slew, 0);
      check(figures);
    }
  }

  static TouchSpace* space_;
  static std::shared_ptr<const Touchable>* body_;
};

TouchSpace* Glide::space_ = nullptr;
std::shared_ptr<const Touchable>* Glide::body_ = nullptr;

// Where the space has one energy, a closed slide makes or takes what sampling does, and no more.
TEST_F(Glide, TheEnergyOfAClosedSlideIsBalanced) {
  slide({}, false, [](const GlideFigures& figures) {
    EXPECT_LT(std::abs(figures.dissipated), figures.sampled + 0.01 * figures.largest_energy);
  });
}

TEST_F(Glide, ThePassivityControllerTakesWhatSamplingMakes) {
  slide({}, true,
        [](const GlideFigures& figures) { EXPECT_GT(figures.dissipated, -0.2 * figures.sampled); });
}

TEST_F(Glide, FrictionTakesEnergy) {
  TouchSettings touch;
  touch.friction = 0.3;
  slide(touch, false,
        [](const GlideFigures& figures) { EXPECT_GT(figures.dissipated, -figures.sampled); });
}

TEST_F(Glide, ACouplingMakesNoMore) {
  TouchSettings touch;
  touch.friction = 0.3;
  touch.coupling_stiffness = 1000;
  slide(touch, false, [](const GlideFigures& figures) {
    EXPECT_GT(figures.dissipated, -figures.sampled - 0.01 * figures.largest_energy);
  });
}

}  // namespace
}  // namespace palpate::test::test_glide
