// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <vector>

#include "base/error.h"
#include "haptic/support/analytic_body.h"
#include "haptic/support/moved_tool.h"
#include "haptic/touching/body_touch.h"

namespace palpate::test::test_tool {
namespace {

using test::kBox;
using test::MovedTool;

constexpr double kStiffness = 200;

const Vec3 kMiddle(0.04, 0.04, kBox[2]);

/// Down through the top at (x, y) to a depth, m, in steps of a millimetre.
Contact press(MovedTool& tool, const Touchable& body, const Vec3& at, double depth,
              const TouchSettings& settings = {}) {
  Contact contact;
  for (double z = 0.003; z > -depth; z -= 0.001) {
    contact = tool.move(&body, at + Vec3(0, 0, z), settings);
  }
  return tool.move(&body, at - Vec3(0, 0, depth), settings);
}

TEST(Tool, FreeThenAttachedThenFree) {
  const auto body = test::box_body(kStiffness);
  MovedTool tool;
  Contact contact = tool.move(body.get(), kMiddle + Vec3(0, 0, 0.005), {});
  EXPECT_EQ(contact.status, ContactStatus::free);
  EXPECT_NEAR(contact.distance, 0.005, 1e-15);
  EXPECT_EQ(contact.force, Vec3::Zero());
  contact = press(tool, *body, kMiddle, 0.004);
  EXPECT_EQ(contact.status, ContactStatus::attached);
  const test::Sample exact = test::stiffening_spring(kStiffness)(Vec3(0, 0, -0.004));
  EXPECT_LT((contact.force + exact.force).norm(), 1e-4 * exact.force.norm());
  EXPECT_NEAR(contact.energy, exact.energy, 1e-4 * exact.energy);
  EXPECT_EQ(contact.support, Support::inside);
  contact = tool.move(body.get(), kMiddle + Vec3(0, 0, 0.001), {});
  EXPECT_EQ(contact.status, ContactStatus::free);
  EXPECT_EQ(contact.force, Vec3::Zero());
}

// Each node has its own stiffness, so that a wrong weight shows.
TEST(Tool, WeightsAreThoseOfWhereItCameIn) {
  const TouchSpace space =
      test::box_space([](int n) { return test::stiffening_spring(100 * (n + 1)); });
  const Touchable body(space);
  const Vec3 at(0.031, 0.027, kBox[2]);
  MovedTool tool;
  (void)press(tool, body, at, 0.002);
  // Away from there, within the triangle of others.
  const Contact contact = tool.move(&body, at + Vec3(0.012, 0.01, -0.004), {});
  ASSERT_EQ(contact.status, ContactStatus::attached);
  Vec3 place = Vec3::Zero();
  Vec3 force = Vec3::Zero();
  for (int k = 0; k < 3; ++k) {
    const std::int32_t node = body.find(contact.nodes[k]);
    ASSERT_GE(node, 0);
    place += contact.weights[k] * body.nodes()[node].rest_position;
    force -= contact.weights[k] *
             body.nodes()[node].on_branch[0]->evaluate(Vec3(0.012, 0.01, -0.004)).force;
  }
  EXPECT_LT((place - at).norm(), 1e-15);
  EXPECT_LT((contact.anchor - at).norm(), 1e-15);
  EXPECT_LT((contact.force - force).norm(), 1e-12);
}

TEST(Tool, WithoutBlendingTheNearestNode) {
  const auto body = test::box_body(kStiffness);
  TouchSettings settings;
  settings.blended = false;
  MovedTool tool;
  const Contact contact = press(tool, *body, kMiddle + Vec3(0.006, -0.003, 0), 0.002, settings);
  ASSERT_EQ(contact.status, ContactStatus::attached);
  EXPECT_EQ(contact.nodes[0], body->nodes()[4].mesh_point);
  EXPECT_EQ(contact.weights[0], 1);
  EXPECT_EQ(contact.nodes[1], -1);
  EXPECT_NEAR(contact.displacement[2], -0.002, 1e-15);
}

TEST(Tool, WhereNoNodeIsNear) {
  const auto body = test::box_body(kStiffness);
  MovedTool tool;
  Contact contact = tool.move(body.get(), Vec3(0.001, 0.001, -0.002), {});  // below the bottom
  EXPECT_EQ(contact.status, ContactStatus::free);
  contact = tool.move(body.get(), Vec3(0.001, 0.001, 0.002), {});
  EXPECT_EQ(contact.status, ContactStatus::inside);
  EXPECT_EQ(contact.force, Vec3::Zero());
  EXPECT_NEAR(contact.distance, -0.001, 1e-15);
  // And from inside it does not attach to what it passes.
  contact = tool.move(body.get(), kMiddle - Vec3(0, 0, 0.001), {});
  EXPECT_EQ(contact.status, ContactStatus::inside);
  TouchSettings far;
  far.reach = 0.1;
  MovedTool other;
  (void)other.move(body.get(), Vec3(0.001, 0.001, -0.002), far);
  EXPECT_EQ(other.move(body.get(), Vec3(0.001, 0.001, 0.002), far).status, ContactStatus::attached);
}

TEST(Tool, WhatBeginsInsideIsNotThrownOut) {
  const auto body = test::box_body(kStiffness);
  MovedTool tool;
  EXPECT_EQ(tool.move(body.get(), kMiddle - Vec3(0, 0, 0.01), {}).status, ContactStatus::inside);
  (void)tool.move(body.get(), kMiddle + Vec3(0, 0, 0.001), {});
  EXPECT_EQ(tool.move(body.get(), kMiddle - Vec3(0, 0, 0.001), {}).status, ContactStatus::attached);
}

TEST(Tool, BondedPullsUntilItLetsGo) {
  const auto body = test::box_body(kStiffness);
  TouchSettings settings;
  settings.bonded = true;
  settings.release_force = 0.5;
  MovedTool tool;
  (void)press(tool, *body, kMiddle, 0.002, settings);
  bool pulled = false;
  double largest = 0;
  Contact contact;
  for (double z = -0.002; z < 0.006; z += 1e-5) {
    contact = tool.move(body.get(), kMiddle + Vec3(0, 0, z), settings);
    if (contact.status != ContactStatus::attached) break;
    if (z > 1e-5) {
      EXPECT_LT(contact.force[2], 0);
      pulled = true;
      largest = std::max(largest, contact.force.norm());
    }
  }
  EXPECT_TRUE(pulled);
  EXPECT_EQ(contact.status, ContactStatus::free);
  EXPECT_LE(largest, settings.release_force);
  EXPECT_GT(largest, 0.95 * settings.release_force);
}

TEST(Tool, WorkAroundAClosedPathIsZero) {
  const TouchSpace space =
      test::box_space([](int n) { return test::stiffening_spring(100 * (n + 1)); });
  const Touchable body(space);
  for (double coupling : {0.0, 500.0}) {
    TouchSettings settings;
    settings.coupling_stiffness = coupling;
    MovedTool tool;
    const Vec3 at(0.031, 0.027, kBox[2]);
    (void)press(tool, body, at, 0.004, settings);
    double work = 0;
    double peak = 0;
    constexpr int steps = 20000;
    const auto on_loop = [&](double s) {
      const double a = 2 * M_PI * s;
      return Vec3(at + Vec3(0.006 * std::cos(a) - 0.006, 0.005 * std::sin(a),
                            -0.004 + 0.002 * std::sin(2 * a)));
    };
    for (int i = 0; i < steps; ++i) {
      // The midpoint rule; it sees the place where the loop closes only once.
      const Contact contact = tool.move(&body, on_loop((i + 0.5) / steps), settings);
      ASSERT_EQ(contact.status, ContactStatus::attached);
      work += contact.force.dot(on_loop((i + 1.0) / steps) - on_loop(i * 1.0 / steps));
      peak = std::max(peak, contact.energy);
    }
    EXPECT_LT(std::abs(work), 1e-7 * peak) << "coupling " << coupling;
  }
}

TEST(Tool, CouplingIsFeltAsASpringInSeries) {
  const auto body = test::box_body(kStiffness);
  TouchSettings settings;
  settings.coupling_stiffness = 300;
  MovedTool tool;
  const Contact contact = press(tool, *body, kMiddle, 0.004, settings);
  ASSERT_EQ(contact.status, ContactStatus::attached);
  // h(t) = c (offset − t) at what it says the nodes have.
  const Vec3 offset(0, 0, -0.004);
  const TouchResult at = body->nodes()[4].on_branch[0]->evaluate(contact.displacement);
  EXPECT_LT((at.force - 300 * (offset - contact.displacement)).norm(), 1e-9);
  EXPECT_LT((at.force + contact.force).norm(), 1e-9);
  EXPECT_LT(std::abs(contact.displacement[2]), 0.004);
  // Its stiffness and energy are those of the force.
  constexpr double h = 1e-7;
  for (int k = 0; k < 3; ++k) {
    MovedTool copy = tool;
    const Contact up = copy.move(body.get(), kMiddle + offset + h * Vec3::Unit(k), settings);
    const Contact down = copy.move(body.get(), kMiddle + offset - h * Vec3::Unit(k), settings);
    EXPECT_LT((contact.stiffness.col(k) + (up.force - down.force) / (2 * h)).norm(), 1e-3);
    EXPECT_NEAR((up.energy - down.energy) / (2 * h), -contact.force[k], 1e-6);
  }
}

TEST(Tool, NoStiffnessAboveTheCoupling) {
  const auto rigid = test::box_body(1e7);
  TouchSettings settings;
  settings.coupling_stiffness = 1000;
  MovedTool tool;
  const Contact contact = press(tool, *rigid, kMiddle, 0.004, settings);
  EXPECT_NEAR(contact.force[2], 4, 0.01);
  EXPECT_LE(contact.stiffness.operatorNorm(), 1000);
}

TEST(Tool, AnotherBodyOfTheSameSceneIsTakenOver) {
  const auto coarse = test::box_body(kStiffness);
  const auto fine = test::box_body(kStiffness);
  MovedTool tool;
  const Contact before = press(tool, *coarse, kMiddle, 0.004);
  const Contact after = tool.move(fine.get(), kMiddle - Vec3(0, 0, 0.004), {});
  EXPECT_EQ(after.status, ContactStatus::attached);
  EXPECT_EQ(after.force, before.force);

  const Touchable fewer(test::box_space([](int) { return test::stiffening_spring(kStiffness); },
                                        {coarse->nodes()[0].surface_point}));
  EXPECT_EQ(tool.move(&fewer, kMiddle - Vec3(0, 0, 0.004), {}).status, ContactStatus::inside);

  TouchSpace other = test::box_space([](int) { return test::stiffening_spring(kStiffness); });
  other.scene_hash = "another";
  const Touchable another(other);
  MovedTool second;
  (void)press(second, *coarse, kMiddle, 0.004);
  EXPECT_EQ(second.move(&another, kMiddle - Vec3(0, 0, 0.004), {}).status, ContactStatus::inside);
  EXPECT_EQ(second.move(nullptr, kMiddle, {}).status, ContactStatus::nothing);
}

// A tool that slides up the side of a hollow lets go of where it came in, and goes on at the next
// node.
// A cut changes the mesh: the node has another number there, and the body another stiffness.
TEST(Tool, AChangedBodyIsHeldAtTheSamePlace) {
  const Vec3 offset(0.001, -0.002, 0.004);
  TouchSettings settings;
  settings.bonded = true;
  settings.release_force = 0;
  settings.blended = false;
  const auto held = make_touch(test::box_body(kStiffness));
  const auto move = [&](Touch& touch, const Vec3& to) {
    HandState hand;
    hand.place = to;
    return touch.move(hand, settings);
  };
  (void)move(*held, kMiddle + Vec3(0, 0, 0.001));
  (void)move(*held, kMiddle - Vec3(0, 0, 1e-6));
  const Contact before = move(*held, kMiddle + offset);
  ASSERT_EQ(before.status, ContactStatus::attached);

  TouchSpace space = test::box_space([](int) { return test::stiffening_spring(0.5 * kStiffness); });
  space.scene_hash = "cut";
  for (TouchToolSpace& tool_space : space.tool_spaces) {
    // As if points had been added before the surface's.
    tool_space.setup.interaction.active_node += 1000;
  }
  space.surface.mesh_points.clear();
  for (Index p = 0; p < space.surface.num_points(); ++p) {
    space.surface.mesh_points.push_back(1000 + p);
  }
  const auto cut = std::make_shared<const Touchable>(space);
  const auto changed = make_touch(cut, Relation::changed);
  EXPECT_FALSE(changed->take_over(*held)) << "its energy is another one";
  const Contact after = move(*changed, kMiddle + offset);
  ASSERT_EQ(after.status, ContactStatus::attached);
  EXPECT_EQ(after.nodes[0], before.nodes[0] + 1000);
  EXPECT_LT((after.displacement - before.displacement).norm(), 1e-15);
  EXPECT_LT((after.force - 0.5 * before.force).norm(), 1e-3 * before.force.norm());

  // Another body is touched only after the tool was outside, and so is one without that node.
  const auto other = make_touch(cut);
  EXPECT_FALSE(other->take_over(*held));
  EXPECT_NE(move(*other, kMiddle + offset).status, ContactStatus::attached);
  std::vector<TouchToolSpace>& left = space.tool_spaces;
  left.erase(std::remove_if(left.begin(), left.end(),
                            [&](const TouchToolSpace& tool_space) {
                              return tool_space.setup.interaction.active_node == after.nodes[0];
                            }),
             left.end());
  const auto without = make_touch(std::make_shared<const Touchable>(space), Relation::changed);
  (void)without->take_over(*held);
  EXPECT_NE(move(*without, kMiddle + offset).status, ContactStatus::attached);
}

TEST(Tool, ChangesTheNodeInAHollow) {
  TouchSpace space = test::box_space([](int) { return test::stiffening_spring(kStiffness); });
  const Index middle = space.tool_spaces[4].setup.interaction.active_node;
  space.surface.points[middle][2] -= 0.015;
  space.tool_spaces[4].setup.interaction.material_point = space.surface.points[middle];
  const Touchable body(space);
  MovedTool tool;
  const Vec3 bottom = space.surface.points[middle];
  const std::int32_t first = press(tool, body, bottom, 0.001).nodes[0];
  ASSERT_EQ(first, middle);
  bool changed = false;
  for (double s = 0; s < 0.019; s += 1e-4) {
    const Contact contact = tool.move(&body, bottom + Vec3(s, 0, -0.001 + 0.75 * s), {});
    ASSERT_EQ(contact.status, ContactStatus::attached) << s;
    changed |= contact.nodes != std::array<std::int32_t, 3>{middle, -1, -1};
  }
  EXPECT_TRUE(changed);
}

TEST(Tool, NoPlaceGivesANaN) {
  const auto body = test::box_body(kStiffness);
  std::mt19937 random(9);
  std::normal_distribution<double> exponent(-2, 4);
  std::normal_distribution<double> direction;
  for (double coupling : {0.0, 1e3}) {
    TouchSettings settings;
    settings.bonded = true;
    settings.coupling_stiffness = coupling;
    MovedTool tool;
    (void)press(tool, *body, kMiddle, 0.004, settings);
    for (int i = 0; i < 20000; ++i) {
      const Vec3 place =
          kMiddle + std::pow(10, exponent(random)) *
                        Vec3(direction(random), direction(random), direction(random));
      const Contact contact = tool.move(body.get(), place, settings);
      ASSERT_TRUE(contact.force.allFinite() && std::isfinite(contact.energy));
    }
    const double inf = std::numeric_limits<double>::infinity();
    EXPECT_EQ(tool.move(body.get(), Vec3(inf, 0, 0), settings).force, Vec3::Zero());
    EXPECT_EQ(tool.move(body.get(), Vec3(0, std::nan(""), 0), settings).force, Vec3::Zero());
  }
}

TEST(Tool, BadSettings) {
  for (double TouchSettings::*field :
       {&TouchSettings::release_force, &TouchSettings::reach, &TouchSettings::coupling_stiffness}) {
    TouchSettings settings;
    EXPECT_NO_THROW(validate(settings));
    settings.*field = -1;
    EXPECT_THROW(validate(settings), InputError);
    settings.*field = std::nan("");
    EXPECT_THROW(validate(settings), InputError);
  }
}

}  // namespace
}  // namespace palpate::test::test_tool
