// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "haptic/support/moved_tool.h"
#include "haptic/support/pressed_body.h"
#include "haptic/touching/pressing_range.h"
#include "solvers/support/two_sides.h"

namespace palpate::test::test_press {
namespace {

using test::kPressedDepth;
using test::kPressedWidth;
using test::kTouching;
using test::MovedTool;

/// Of the interpolation beside the formula, as a share of the force.
constexpr double kInterpolated = 0.02;

/// The force on the tool by the formula, N.
Vec3 exact_force(const Vec3& place) {
  return -test::contact_energy(test::pressed_top(), place).first;
}

Vec3 below(double depth, const Vec3& aside = Vec3::Zero()) {
  return kTouching + aside - Vec3(0, 0, depth);
}

/// A tool that has come from above to a depth, m, in steps of a fifth of a millimetre.
struct Pressing {
  explicit Pressing(const TouchSettings& touch = {},
                    std::shared_ptr<const Touchable> its_body = shared_body())
      : body(std::move(its_body)), settings(touch) {
    (void)at(below(-0.003));
  }
  static std::shared_ptr<const Touchable> shared_body() {
    static const std::shared_ptr<const Touchable> body = test::pressed_body();
    return body;
  }

  const Contact& at(const Vec3& place, bool grasps = false) {
    contact = tool.move(body.get(), place, settings, grasps);
    return contact;
  }
  const Contact& go(const Vec3& from, const Vec3& to, bool grasps = false) {
    const int steps = 1 + static_cast<int>((to - from).norm() / 2e-4);
    for (int i = 1; i <= steps; ++i) {
      (void)at(from + (static_cast<double>(i) / steps) * (to - from), grasps);
    }
    return contact;
  }
  const Contact& press(double depth, const Vec3& aside = Vec3::Zero()) {
    return go(below(-0.003, aside), below(depth, aside));
  }

  std::shared_ptr<const Touchable> body;
  TouchSettings settings;
  MovedTool tool;
  Contact contact;
};

TEST(Press, FeelsTheForceOfItsPlaceAndGlides) {
  Pressing p;
  EXPECT_EQ(p.contact.status, ContactStatus::free);
  EXPECT_NEAR(p.contact.distance, 0.013, 1e-12);
  EXPECT_EQ(p.contact.force, Vec3::Zero());
  (void)p.press(0.004);
  for (double x = 0; x < 0.015; x += 0.0005) {
    const Vec3 place = below(0.004, Vec3(x, 0.3 * x, 0));
    const Contact& contact = p.at(place);
    ASSERT_EQ(contact.status, ContactStatus::pressing);
    EXPECT_EQ(contact.anchor, place);
    EXPECT_EQ(contact.support, Support::inside);
    const Vec3 exact = exact_force(place);
    EXPECT_LT((contact.force - exact).norm(), kInterpolated * exact.norm());
    const TouchResult at = p.body->force_on_tool()->evaluate(place);
    EXPECT_EQ(contact.force, -at.force);
    EXPECT_EQ(contact.energy, at.energy);
    EXPECT_EQ(contact.stiffness, at.stiffness);
  }
  (void)p.at(below(-0.003));
  EXPECT_EQ(p.contact.status, ContactStatus::free);
  EXPECT_EQ(p.contact.force, Vec3::Zero());
}

TEST(Press, WhatBeginsInsideIsNotThrownOut) {
  Pressing p;
  p.tool.release();
  EXPECT_EQ(p.at(below(0.003)).status, ContactStatus::inside);
  EXPECT_EQ(p.contact.force, Vec3::Zero());
  EXPECT_EQ(p.at(below(0.001)).status, ContactStatus::inside);
  EXPECT_EQ(p.at(below(-0.003)).status, ContactStatus::free);
  EXPECT_EQ(p.at(below(0.001)).status, ContactStatus::pressing);
}

TEST(Press, DeeperThanTheSpaceItGoesOnAndBesideItTheForceEnds) {
  Pressing p;
  (void)p.press(kPressedDepth);
  const double force = p.contact.force.norm();
  (void)p.go(below(kPressedDepth), below(kPressedDepth + 0.006));
  ASSERT_EQ(p.contact.status, ContactStatus::pressing);
  EXPECT_EQ(p.contact.support, Support::extrapolated);
  EXPECT_GT(p.contact.force.norm(), force);
  (void)p.go(below(kPressedDepth + 0.006), below(0.003));
  EXPECT_EQ(p.contact.support, Support::inside);

  const Vec3 border = below(0.003, Vec3(kPressedWidth, 0, 0));
  (void)p.go(below(0.003), border - Vec3(1e-4, 0, 0));
  EXPECT_EQ(p.contact.status, ContactStatus::pressing);
  (void)p.go(border, border + Vec3(2 * test::kPressedCell, 0, 0));
  EXPECT_EQ(p.contact.status, ContactStatus::inside);
  EXPECT_EQ(p.contact.force, Vec3::Zero());
  EXPECT_EQ(p.contact.support, Support::extrapolated);
  // Back where the space is it would be thrown out.
  EXPECT_EQ(p.at(below(0.003)).status, ContactStatus::inside);
  (void)p.at(below(-0.003));
  EXPECT_EQ(p.at(below(0.003)).status, ContactStatus::pressing);
}

TEST(Press, WhereTheSpaceKnowsNothingNothingIsFelt) {
  Pressing p;
  const Vec3 away(0.033, 0, 0);
  (void)p.go(below(-0.003, away), below(0.002, away));
  EXPECT_EQ(p.contact.status, ContactStatus::inside);
  EXPECT_EQ(p.contact.force, Vec3::Zero());
  // Into the part that has a space, from below the surface.
  (void)p.go(below(0.002, away), below(0.002));
  EXPECT_EQ(p.contact.status, ContactStatus::inside);
}

// Nothing that touches is near: what is extrapolated is zero, and the tool is not free for that.
TEST(Press, WhereItHasGoneThroughTheSurfaceItIsNotFree) {
  Pressing p({}, test::pierced_body(0.5 * test::kPressedCell));
  for (double depth = 2e-4; depth < kPressedDepth; depth += 2e-4) {
    const Contact& contact = p.press(depth);
    ASSERT_EQ(contact.status, ContactStatus::inside) << depth;
    EXPECT_EQ(contact.support, Support::extrapolated);
    EXPECT_EQ(contact.force, Vec3::Zero());
  }
  EXPECT_EQ(p.at(below(-0.003)).status, ContactStatus::free);
  EXPECT_EQ(p.contact.support, Support::inside);
}

// What was felt above it goes on, and is told as extrapolated.
TEST(Press, BelowWhatItHasTouchedItIsFeltOnWhereItHasGoneThroughTheSurface) {
  Pressing p({}, test::pierced_body(1.5 * test::kPressedCell));
  (void)p.press(0.9 * test::kPressedCell);
  ASSERT_EQ(p.contact.status, ContactStatus::pressing);
  EXPECT_EQ(p.contact.support, Support::inside);
  const double felt = p.contact.force[2];
  for (double depth = 1.1 * test::kPressedCell; depth < kPressedDepth; depth += 2e-4) {
    (void)p.go(below(depth - 2e-4), below(depth));
    ASSERT_EQ(p.contact.status, ContactStatus::pressing) << depth;
    EXPECT_EQ(p.contact.support, Support::extrapolated);
    EXPECT_GT(p.contact.force[2], felt) << depth;
  }
}

TEST(Press, GoesOnInASpaceThatHasGrown) {
  Pressing p({}, test::pressed_body(0.01));
  (void)p.press(0.003);
  const Vec3 before = p.contact.force;
  p.body = Pressing::shared_body();
  EXPECT_EQ(p.at(below(0.003)).status, ContactStatus::pressing);
  EXPECT_LT((p.contact.force - before).norm(), 1e-2 * before.norm());
  (void)p.go(below(0.003), below(0.003, Vec3(0.015, 0, 0)));
  EXPECT_EQ(p.contact.status, ContactStatus::pressing);
  TouchSpace other = test::pressed_space();
  other.scene_hash = "other";
  p.body = std::make_shared<const Touchable>(other);
  EXPECT_EQ(p.at(below(0.003)).status, ContactStatus::inside) << "another body is come into";
}

/// A body of another scene, twice as stiff, at the same places.
std::shared_ptr<const Touchable> stiffer_body() {
  TouchSpace space = test::pressed_space();
  space.scene_hash = "stiffer";
  for (TouchToolSpace& tool_space : space.tool_spaces) {
    for (ConfigurationSummary& c : tool_space.configurations) {
      c.energy *= 2;
      c.force *= 2;
      c.stiffness *= 2;
      c.third_derivative = {};
    }
  }
  return std::make_shared<const Touchable>(space);
}

TEST(Press, InABodyThatChangesInTheHandTheForceGoesOver) {
  const Vec3 place = below(0.003);
  const auto soft = make_touch(Pressing::shared_body());
  HandState hand;
  const auto move = [&](Touch& touch, const Vec3& to) {
    hand.place = to;
    hand.time += std::chrono::milliseconds(1);
    return touch.move(hand, {});
  };
  (void)move(*soft, below(-0.003));
  const Contact before = move(*soft, place);
  ASSERT_EQ(before.status, ContactStatus::pressing);

  const auto stiff = make_touch(stiffer_body(), Relation::changed);
  EXPECT_FALSE(stiff->take_over(*soft)) << "its energy is another one";
  double last = before.force.norm();
  for (int tick = 0; tick < 200; ++tick) {
    const Contact contact = move(*stiff, place);
    ASSERT_EQ(contact.status, ContactStatus::pressing);
    EXPECT_GE(contact.force.norm(), last - 1e-9);
    EXPECT_LT(contact.force.norm() - last, 0.01 * before.force.norm());
    last = contact.force.norm();
  }
  const Contact after = move(*stiff, place);
  EXPECT_LT((after.force - 2 * before.force).norm(), kInterpolated * after.force.norm());
  // What was free stays free, and is felt at once.
  (void)move(*stiff, below(-0.003));
  const auto again = make_touch(stiffer_body(), Relation::changed);
  (void)again->take_over(*stiff);
  EXPECT_EQ(move(*again, below(-0.003)).status, ContactStatus::free);
  EXPECT_LT((move(*again, place).force - after.force).norm(), 1e-9);

  // A tool that began inside stays out of it.
  const auto inside = make_touch(Pressing::shared_body());
  EXPECT_EQ(move(*inside, place).status, ContactStatus::inside);
  const auto changed = make_touch(stiffer_body(), Relation::changed);
  (void)changed->take_over(*inside);
  EXPECT_EQ(move(*changed, place).status, ContactStatus::inside);
  EXPECT_EQ(move(*changed, place).force, Vec3::Zero());
}

TEST(Press, WhereTheSpaceBecomesKnownTheForceComesIn) {
  const Vec3 place = below(0.003, Vec3(0.015, 0, 0));
  for (const bool grows : {false, true}) {
    TouchSettings settings;
    settings.grows = grows;
    Pressing p(settings, test::pressed_body(0.01));
    (void)p.go(below(-0.003, Vec3(0.015, 0, 0)), place);
    ASSERT_EQ(p.contact.status, ContactStatus::inside);
    ASSERT_EQ(p.contact.force, Vec3::Zero());
    p.body = Pressing::shared_body();
    if (!grows) {
      EXPECT_EQ(p.at(place).status, ContactStatus::inside);
      continue;
    }
    const double full = exact_force(place).norm();
    double before = 0;
    for (int tick = 0; tick < 200; ++tick) {
      ASSERT_EQ(p.at(place).status, ContactStatus::pressing);
      const double force = p.contact.force.norm();
      EXPECT_GE(force, before);
      EXPECT_LT(force - before, 0.01 * full);
      before = force;
    }
    EXPECT_LT((p.at(place).force - exact_force(place)).norm(), kInterpolated * full);
  }
}

TEST(Press, WhereConfigurationsAreNearThereIsAForceWithoutACell) {
  TouchableOptions options;
  options.interpolation.reach_of_states = 2 * test::kPressedCell;
  Pressing p({}, test::pressed_body(0.01, options));
  const Vec3 away(0.01 + 1.2 * test::kPressedCell, 0, 0);
  (void)p.go(below(-0.003, away), below(0.003, away));
  ASSERT_EQ(p.contact.status, ContactStatus::pressing);
  EXPECT_EQ(p.contact.support, Support::extrapolated);
  const Vec3 exact = exact_force(below(0.003, away));
  EXPECT_LT((p.contact.force - exact).norm(), 0.1 * exact.norm());
  // Into the cells, and out of all that is known.
  const double most = 0.1 * exact.norm();
  Vec3 before = p.contact.force;
  for (double x = away[0]; x > 0; x -= 1e-4) {
    (void)p.at(below(0.003, Vec3(x, 0, 0)));
    ASSERT_EQ(p.contact.status, ContactStatus::pressing);
    EXPECT_LT((p.contact.force - before).norm(), most) << x;
    before = p.contact.force;
  }
  EXPECT_EQ(p.contact.support, Support::inside);
  (void)p.go(below(0.003), below(0.003, Vec3(0.01 + 3 * test::kPressedCell, 0, 0)));
  EXPECT_EQ(p.contact.status, ContactStatus::inside);
  EXPECT_EQ(p.contact.force, Vec3::Zero());
}

TEST(Press, WhatBeginsInsideASpaceThatGrowsIsNotThrownOut) {
  TouchSettings settings;
  settings.grows = true;
  Pressing p(settings);
  p.tool.release();
  EXPECT_EQ(p.at(below(0.003)).status, ContactStatus::inside);
  EXPECT_EQ(p.at(below(0.003)).status, ContactStatus::inside);
  EXPECT_EQ(p.at(below(-0.003)).status, ContactStatus::free);
  EXPECT_EQ(p.at(below(0.001)).status, ContactStatus::pressing);
}

TEST(Press, ACouplingIsInBalanceAndFeltNoStiffer) {
  TouchSettings settings;
  settings.coupling_stiffness = 800;
  Pressing p(settings);
  const Vec3 place = below(0.004, Vec3(0.003, -0.002, 0));
  (void)p.press(0.004, Vec3(0.003, -0.002, 0));
  // What is not balanced in a tick is in the next.
  for (int i = 0; i < 20; ++i) (void)p.at(place);
  ASSERT_EQ(p.contact.status, ContactStatus::pressing);
  const Vec3 at = p.contact.anchor;
  const TouchResult body = p.body->force_on_tool()->evaluate(at);
  EXPECT_LT((p.contact.force + 800 * (place - at)).norm(), 1e-12);
  EXPECT_LT((p.contact.force + body.force).norm(), 1e-6 * body.force.norm());
  EXPECT_NEAR(p.contact.energy, body.energy + 400 * (place - at).squaredNorm(), 1e-12);
  EXPECT_LT(p.contact.stiffness.norm(), 800 * std::sqrt(3));
  // The force is the gradient of the energy, and the stiffness that of the force.
  const double step = 1e-6;
  for (int k = 0; k < 3; ++k) {
    const Vec3 way = step * Vec3::Unit(k);
    const Mat3 stiffness = p.contact.stiffness;
    const Vec3 force = p.contact.force;
    for (int i = 0; i < 5; ++i) (void)p.at(place + way);
    const double energy_after = p.contact.energy;
    const Vec3 force_after = p.contact.force;
    for (int i = 0; i < 5; ++i) (void)p.at(place - way);
    EXPECT_NEAR((energy_after - p.contact.energy) / (2 * step), -force[k], 1e-4 * force.norm());
    EXPECT_LT(((force_after - p.contact.force) / (2 * step) + stiffness.col(k)).norm(),
              1e-3 * stiffness.norm());
    for (int i = 0; i < 5; ++i) (void)p.at(place);
  }
}

TEST(Press, FrictionHoldsUntilItSlips) {
  TouchSettings settings;
  settings.friction = 0.4;
  Pressing p(settings);
  (void)p.press(0.003);
  for (int i = 1; i <= 400; ++i) {
    const Vec3 place = below(0.003, Vec3(2e-5 * i, 0, 0));
    (void)p.at(place);
    ASSERT_EQ(p.contact.status, ContactStatus::pressing);
    EXPECT_EQ(p.contact.anchor, place);
    const Vec3 body = p.body->force_on_tool()->evaluate(place).force;
    // What is left of the force when the body's push is taken away is along the surface.
    const Vec3 rubbed = -p.contact.force - body;
    EXPECT_NEAR(rubbed.dot(body.normalized()), 0, 1e-12);
    EXPECT_LE(rubbed.norm(), (1 + 1e-9) * 0.4 * body.norm());
    EXPECT_GT(rubbed.dot(Vec3::UnitX()), 0) << "it holds back";
    if (i > 300) {
      EXPECT_NEAR(rubbed.norm(), 0.4 * body.norm(), 1e-3 * body.norm()) << "it slips";
    }
    if (i == 1) {
      EXPECT_LT(rubbed.norm(), 0.05 * body.norm()) << "it sticks";
    }
  }
  p.settings.friction = 0;
  (void)p.at(below(0.003, Vec3(0.008, 0, 0)));
  EXPECT_EQ(p.contact.force,
            -p.body->force_on_tool()->evaluate(below(0.003, Vec3(0.008, 0, 0))).force);
}

/// The energy that the hand has put in along a way, less what is stored at its end, J. The force of
/// the middle of each step is taken, so that what is left is not of the steps' size.
double dissipated(Pressing& p, const std::vector<Vec3>& way) {
  (void)p.at(way.front());
  const double stored = p.contact.energy;
  double work = 0;
  for (std::size_t i = 1; i < way.size(); ++i) {
    const Vec3 before = p.contact.force;
    (void)p.at(way[i]);
    work -= 0.5 * (before + p.contact.force).dot(way[i] - way[i - 1]);
  }
  return work - (p.contact.energy - stored);
}

// Down, around in random loops at a varying depth, and up.
TEST(Press, MakesNoEnergyAroundClosedWays) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> part(-1, 1);
  for (const double friction : {0.0, 0.2, 0.8, 5.0}) {
    for (const double coupling : {0.0, 1500.0}) {
      for (int run = 0; run < 6; ++run) {
        TouchSettings settings;
        settings.friction = friction;
        settings.coupling_stiffness = coupling;
        Pressing p(settings);
        std::vector<Vec3> corners{below(-0.003)};
        for (int i = 0; i < 12; ++i) {
          corners.push_back(
              below(0.0035 + 0.002 * part(random), 0.014 * Vec3(part(random), part(random), 0)));
        }
        corners.push_back(corners.front());
        std::vector<Vec3> way;
        for (std::size_t c = 1; c < corners.size(); ++c) {
          for (int i = 0; i < 1000; ++i) {
            way.push_back(corners[c - 1] + i / 1000.0 * (corners[c] - corners[c - 1]));
          }
        }
        way.push_back(corners.back());
        const double lost = dissipated(p, way);
        double largest = 0;
        for (const Vec3& place : way) {
          largest = std::max(largest, p.body->force_on_tool()->evaluate(place).energy);
        }
        EXPECT_GT(lost, -2e-3 * largest) << "μ " << friction << ", coupling " << coupling;
        if (friction == 0) {
          EXPECT_LT(lost, 2e-3 * largest);
        }
        if (friction == 0.2) {
          EXPECT_GT(lost, 0.2 * largest) << "rubbing takes energy";
        }
      }
    }
  }
}

TEST(Press, GraspingHoldsTheNodeWithoutAJump) {
  for (const double coupling : {0.0, 2000.0}) {
    TouchSettings settings;
    settings.coupling_stiffness = coupling;
    settings.blended = false;
    settings.release_force = 0;
    Pressing p(settings);
    (void)p.press(0.003);
    for (int i = 0; i < 10; ++i) (void)p.at(below(0.003));
    const Vec3 before = p.contact.force;
    (void)p.at(below(0.003), true);
    ASSERT_EQ(p.contact.status, ContactStatus::attached);
    EXPECT_GE(p.contact.nodes[0], 0);
    EXPECT_LT((p.contact.force - before).norm(), 1e-4 * before.norm());
    // It pulls now, which a tool that presses does not.
    (void)p.go(below(0.003), below(-0.005), true);
    ASSERT_EQ(p.contact.status, ContactStatus::attached);
    EXPECT_LT(p.contact.force[2], 0);
    (void)p.at(below(-0.005), false);
    EXPECT_EQ(p.contact.status, ContactStatus::free);
    EXPECT_EQ(p.contact.force, Vec3::Zero());
  }
}

TEST(Press, WhatIsGraspedWhereItLetsGoIsPressedOn) {
  TouchSettings settings;
  Pressing p(settings);
  (void)p.press(0.003);
  (void)p.at(below(0.003), true);
  ASSERT_EQ(p.contact.status, ContactStatus::attached);
  (void)p.at(below(0.003), false);
  EXPECT_EQ(p.contact.status, ContactStatus::pressing);
}

TEST(Press, AGraspThatPullsTooHardLetsGoUntilTheButtonIsPressedAnew) {
  TouchSettings settings;
  settings.release_force = 0.5;
  Pressing p(settings);
  (void)p.press(0.001);
  (void)p.at(below(0.001), true);
  ASSERT_EQ(p.contact.status, ContactStatus::attached);
  (void)p.go(below(0.001), below(-0.02), true);
  EXPECT_EQ(p.contact.status, ContactStatus::free);
  (void)p.go(below(-0.02), below(0.001), true);
  EXPECT_EQ(p.contact.status, ContactStatus::pressing);
  (void)p.at(below(0.001), false);
  EXPECT_EQ(p.at(below(0.001), true).status, ContactStatus::attached);
}

TEST(Press, WhereNoNodeIsNearNothingIsGrasped) {
  TouchSettings settings;
  settings.reach = 1e-4;
  settings.blended = false;
  Pressing p(settings);
  (void)p.press(0.002, Vec3(0.007, 0.003, 0));
  (void)p.at(below(0.002, Vec3(0.007, 0.003, 0)), true);
  EXPECT_EQ(p.contact.status, ContactStatus::pressing);
}

TEST(Press, TellsWhereAndHowDeepItCan) {
  const TouchSpace space = test::pressed_space();
  const Touchable body(space);
  const ToolForce& force = *body.force_on_tool();
  const RigidTool& tool = space.tool_spaces[0].setup.interaction.tool;
  const std::vector<char> pressable = pressable_points(space.surface, tool, force);
  int num_pressable = 0;
  for (std::size_t p = 0; p < pressable.size(); ++p) {
    const Vec3& place = space.surface.points[p];
    const Vec3 aside = place - kTouching;
    const bool inner = std::max(std::abs(aside[0]), std::abs(aside[1])) < 0.99 * kPressedWidth;
    if (place[2] == test::kBox[2] && inner) {
      EXPECT_EQ(pressable[p], 1);
      ++num_pressable;
    } else if (place[2] == 0) {
      EXPECT_EQ(pressable[p], 0);
    }
  }
  EXPECT_EQ(num_pressable, 1);
  const double left = depth_left(force, below(0.001), -Vec3::UnitZ(), 1);
  // A cell that is in part less deep than the space reaches below it.
  EXPECT_GE(left, kPressedDepth - 0.001);
  EXPECT_LE(left, kPressedDepth - 0.001 + test::kPressedCell + 1e-9);
  EXPECT_EQ(depth_left(force, below(0.001), -Vec3::UnitZ(), 1e-3), 1e-3);
  EXPECT_EQ(depth_left(force, below(0.02), -Vec3::UnitZ(), 1), 0);
}

TEST(Press, TheDepthIsThatOfTheLowestPointOfTheTool) {
  const SurfaceTree& surface = Pressing::shared_body()->surface();
  RigidTool tool;
  tool.radius = 0.01;
  for (const double depth : {-0.002, 0.0, 0.004}) {
    EXPECT_NEAR(depth_in_body(surface, tool, below(depth)), depth, 1e-12);
  }
  tool.shape = ToolShape::capsule;
  tool.length = 0.006;
  EXPECT_NEAR(depth_in_body(surface, tool, below(0.004)), 0.004 + 0.003, 1e-12) << "upright";
  tool.axis = Vec3::UnitX();
  EXPECT_NEAR(depth_in_body(surface, tool, below(0.004)), 0.004, 1e-12) << "lying";
  // Where the centre is in the body, too.
  EXPECT_NEAR(depth_in_body(surface, tool, below(0.012)), 0.012, 1e-12);
}

/// A leaf that gives way to the side from which the tool does not come.
std::shared_ptr<const Touchable> two_sided_body() {
  TouchSpace space = test::box_space([](int) { return test::stiffening_spring(1000); });
  space.tool_spaces.insert(space.tool_spaces.begin(), test::TwoSides::make());
  return std::make_shared<const Touchable>(space);
}

TEST(Press, StaysOnTheSideFromWhichItCame) {
  using test::TwoSides;
  const auto body = two_sided_body();
  const auto at = [](double height) { return Vec3(3e-4, 2e-4, height * TwoSides::kSpacing); };
  for (const double coupling : {0.0, 200.0}) {
    for (const int side : {1, -1}) {
      TouchSettings settings;
      settings.coupling_stiffness = coupling;
      MovedTool tool;
      Contact contact = tool.move(body.get(), at(3.9 * side), settings);
      EXPECT_EQ(contact.status, ContactStatus::free);
      double before = 0;
      for (double height = 3.91; height > -1.5; height -= 0.02) {
        contact = tool.move(body.get(), at(height * side), settings);
        const bool presses = contact.status == ContactStatus::pressing;
        EXPECT_EQ(presses, height < TwoSides::kBegins) << height;
        const double expected = presses ? -TwoSides::force(contact.anchor[2], side) : 0;
        EXPECT_NEAR(contact.force[2], expected, 1e-6) << height;
        EXPECT_LT(std::abs(contact.force[2] - before), 1e-3) << height;
        before = contact.force[2];
      }
      EXPECT_EQ(contact.status, ContactStatus::pressing);
      EXPECT_EQ(contact.support, Support::inside);
      EXPECT_GT(contact.branches[0], 0);
      // The same space anew, as after a chunk was added.
      const auto grown = two_sided_body();
      contact = tool.move(grown.get(), at(-1.5 * side), settings);
      EXPECT_NEAR(contact.force[2], before, 1e-3);
      // Back, and then from the other side.
      for (double height = -1.5; height < 3.9; height += 0.02) {
        contact = tool.move(grown.get(), at(height * side), settings);
      }
      EXPECT_EQ(contact.status, ContactStatus::free);
      EXPECT_EQ(contact.branches[0], 0);
    }
  }
}

TEST(Press, GoesOnWhereLevelsAreFoundMeanwhile) {
  using test::TwoSides;
  TouchSpace flat = test::box_space([](int) { return test::stiffening_spring(1000); });
  TouchToolSpace two_sides = TwoSides::make();
  std::vector<std::int32_t> of_level_0;
  for (std::size_t i = 0; i < two_sides.configurations.size(); ++i) {
    ConfigurationSummary& c = two_sides.configurations[i];
    c.reached = ConfigurationSummary().reached;
    if (c.level == 0) of_level_0.push_back(static_cast<std::int32_t>(i));
  }
  flat.tool_spaces.insert(flat.tool_spaces.begin(), restricted(two_sides, of_level_0));
  const Touchable before(flat);
  const auto body = two_sided_body();
  EXPECT_EQ(before.force_on_tool()->num_branches(), 1);
  EXPECT_GT(body->force_on_tool()->num_branches(), 1);
  const auto at = [](double height) { return Vec3(3e-4, 2e-4, height * TwoSides::kSpacing); };
  for (const int side : {1, -1}) {
    for (const double least : {2.5, 1.1, -1.1, -2.5}) {
      MovedTool tool;
      Contact contact;
      for (double height = 3.9; height > least; height -= 0.02) {
        contact = tool.move(&before, at(height * side), {});
      }
      EXPECT_EQ(contact.status, ContactStatus::pressing);
      const Contact grown = tool.move(body.get(), at(least * side), {});
      EXPECT_EQ(grown.status, ContactStatus::pressing);
      EXPECT_LT((grown.force - contact.force).norm(), 1e-3) << side << ' ' << least;
    }
  }
}

TEST(Press, APlaceThatIsNotFiniteIsNowhere) {
  Pressing p;
  (void)p.press(0.003);
  EXPECT_EQ(p.at(Vec3(0, std::nan(""), 0)).status, ContactStatus::nothing);
  EXPECT_EQ(p.at(below(0.003)).status, ContactStatus::inside);
  EXPECT_EQ(p.at(Vec3(0, 0, 1e300)).status, ContactStatus::free);
}

}  // namespace
}  // namespace palpate::test::test_press
