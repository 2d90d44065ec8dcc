// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <limits>
#include <optional>
#include <string>

#include "base/error.h"
#include "interaction/interaction_spec.h"
#include "solvers/support/block.h"
#include "solvers/support/box_mesh.h"
#include "solvers/support/laws.h"

namespace palpate::test::test_tool_clearance {
namespace {

const Vec3 kSize(0.1, 0.08, 0.05);

/// A box that is held at x = 0.
Scene make_box_scene() {
  TetMesh mesh = test::make_box(ElementOrder::linear, {5, 4, 3}, kSize);
  std::vector<char> fixed;
  for (const Vec3& p : mesh.points) fixed.push_back(p.x() == 0 ? 1 : 0);
  return test::make_scene(std::move(mesh), test::make_material(Law::neo_hookean, 3000, 0.35),
                          fixed);
}

RigidTool make_sphere() {
  RigidTool tool;
  tool.radius = 0.01;
  return tool;
}

RigidTool make_tilted_capsule() {
  RigidTool tool;
  tool.shape = ToolShape::capsule;
  tool.radius = 0.008;
  tool.length = 0.02;
  tool.axis = Vec3(1, 0.5, 0.4).normalized();
  return tool;
}

TEST(ToolClearance, WhatIsPressedSoDeepIsSoDeep) {
  const Scene scene = make_box_scene();
  for (const RigidTool& tool : {make_sphere(), make_tilted_capsule()}) {
    const auto clearance = InteractionFactory(scene.body, {})
                               .clearance(rigid_contact_spec(with_defaults(tool, scene)));
    const Vec3 point(0.06, 0.035, kSize.z());
    for (const double depth : {-0.003, 0.0, 0.002, 0.006}) {
      const ToolClearance::Approach approach =
          clearance->approach(clearance->pressed(point, Vec3::UnitZ(), depth));
      EXPECT_NEAR(approach.depth, depth, 1e-12);
      EXPECT_LE((approach.out - Vec3::UnitZ()).norm(), 1e-9);
      EXPECT_LE((approach.touched - point).norm(), 1e-9);
    }
  }
}

TEST(ToolClearance, AStartIsFoundWhereThereIsOne) {
  const Scene scene = make_box_scene();
  const auto clearance = InteractionFactory(scene.body, {})
                             .clearance(rigid_contact_spec(with_defaults(make_sphere(), scene)));
  const Vec3 pressed = clearance->pressed({0.06, 0.035, kSize.z()}, Vec3::UnitZ(), 0.004);
  const std::optional<Vec3> start = clearance->find_start(pressed);
  ASSERT_TRUE(start);
  EXPECT_EQ(*start, clearance->start_for(pressed));
  EXPECT_GT(clearance->clearance(*start), 0);
  EXPECT_GT(start->z(), pressed.z());
  // Where the tool touches nothing it needs none.
  EXPECT_EQ(*clearance->find_start(*start), *start);
  const Vec3 nowhere = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_FALSE(clearance->find_start(nowhere));
  EXPECT_THROW((void)clearance->start_for(nowhere), InputError);
}

/// Of the layer of contact of a large tool, m.
constexpr double kThickness = 0.01;

/// A box as a tool, about its centre, with its edges turned.
RigidTool make_plate(const Vec3& size, const Mat3& turn = Mat3::Identity()) {
  const TetMesh box = test::make_box(ElementOrder::linear, {1, 1, 1}, size);
  RigidTool tool;
  tool.shape = ToolShape::surface;
  for (const Vec3& p : box.points) tool.points.emplace_back(turn * (p - 0.5 * size));
  tool.triangles = boundary_triangles(box);
  tool.law.thickness = kThickness;
  return tool;
}

/// The tool goes straight up from where it is so deep in the top of the box of make_box_scene().
void expect_pressed_from_above(const RigidTool& tool, double depth) {
  SCOPED_TRACE(name_of(tool) + ", depth " + std::to_string(depth));
  const Scene scene = make_box_scene();
  const auto clearance =
      InteractionFactory(scene.body, {}).clearance(rigid_contact_spec(with_defaults(tool, scene)));
  ASSERT_TRUE(clearance->is_large());
  const double below = reach(tool, -Vec3::UnitZ());
  const Vec3 q(0.06, 0.04, kSize.z() - depth + below);
  EXPECT_LT(clearance->clearance(q), 0);
  const std::optional<Vec3> start = clearance->find_start(q);
  ASSERT_TRUE(start);
  EXPECT_GT(clearance->clearance(*start), 0);
  EXPECT_LE((*start - q).head<2>().norm(), 1e-9) << *start;
  EXPECT_GT(start->z(), q.z());
  EXPECT_LE((*start - q).norm(), depth + 3 * kThickness);
  // Where it touches nothing it stays.
  const Vec3 above = *start + Vec3(0, 0, 0.01);
  EXPECT_GT(clearance->clearance(above), 0);
  EXPECT_EQ(*clearance->find_start(above), above);
}

TEST(ToolClearance, AToolThatIsLargerThanTheBodyPressesIt) {
  RigidTool ball;
  ball.law.thickness = kThickness;
  RigidTool rod = ball;
  rod.shape = ToolShape::capsule;
  rod.radius = 0.03;
  rod.length = 0.3;
  rod.axis = Vec3::UnitX();
  for (const double depth : {0.001, 0.01, 0.02}) {
    for (const double radius : {0.1, 1.0}) {
      ball.radius = radius;
      expect_pressed_from_above(ball, depth);
    }
    expect_pressed_from_above(rod, depth);
    expect_pressed_from_above(make_plate({0.2, 0.2, 0.05}), depth);
    expect_pressed_from_above(make_plate({0.2, 0.2, 0.02}), depth);
  }
}

TEST(ToolClearance, OfALargePlateTheDepthIsThatOfTheBody) {
  const Scene scene = make_box_scene();
  const auto clearance =
      InteractionFactory(scene.body, {})
          .clearance(rigid_contact_spec(with_defaults(make_plate({0.2, 0.2, 0.05}), scene)));
  for (const double depth : {0.001, 0.01}) {
    const ToolClearance::Approach approach =
        clearance->approach({0.06, 0.04, kSize.z() - depth + 0.025});
    // The spline of its distance is good to a twentieth of the layer.
    EXPECT_NEAR(approach.depth, depth, 0.05 * kThickness);
    EXPECT_LE((approach.out - Vec3::UnitZ()).norm(), 0.02);
    EXPECT_NEAR(approach.touched.z(), kSize.z(), 1e-9);
  }
}

// Its corners and the middles of its triangles are far from the body.
TEST(ToolClearance, ATurnedPlateGoesOutAcross) {
  const Scene scene = make_box_scene();
  const Vec3 normal = Vec3(0.3, 0.2, 1).normalized();
  const Mat3 turn = Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), normal).toRotationMatrix();
  const RigidTool plate = make_plate({0.3, 0.3, 0.04}, turn);
  const auto clearance =
      InteractionFactory(scene.body, {}).clearance(rigid_contact_spec(with_defaults(plate, scene)));
  // The corner of the box that is first met lies 8 mm deep.
  const Vec3 corner = kSize;
  const Vec3 q = corner + (0.02 - 0.008) * normal;
  const std::optional<Vec3> start = clearance->find_start(q);
  ASSERT_TRUE(start);
  EXPECT_GT(clearance->clearance(*start), 0);
  EXPECT_GT((*start - q).normalized().dot(normal), 0.99);
  // Farther away than its layer the plate is known by the box around it.
  EXPECT_LE((*start - q).norm(), 0.008 + 3 * kThickness + reach(plate, -Vec3::UnitZ()));
}

}  // namespace
}  // namespace palpate::test::test_tool_clearance
