// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <limits>
#include <optional>

#include "base/error.h"
#include "interaction/interaction_spec.h"
#include "solvers/support/block.h"
#include "solvers/support/box_mesh.h"
#include "solvers/support/laws.h"

namespace palpate {
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
    const auto clearance =
        InteractionFactory(scene).clearance(rigid_contact_spec(with_defaults(tool, scene)));
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
  const auto clearance =
      InteractionFactory(scene).clearance(rigid_contact_spec(with_defaults(make_sphere(), scene)));
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

}  // namespace
}  // namespace palpate
