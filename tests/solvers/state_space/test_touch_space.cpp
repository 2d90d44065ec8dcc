// SPDX-License-Identifier: BSD-3-Clause
#include "state_space/touch_space.h"

#include <gtest/gtest.h>

#include "interaction/rigid_tool.h"
#include "solvers/state_space/example_space.h"

namespace palpate::test::test_touch_space {
namespace {

using test::cube_scene;

// Earlier versions took it for an equilibrium without force.
TEST(TouchSpace, AToolThatTouchesNothingInTheBodyHasGoneThroughItsSurface) {
  const Scene scene = cube_scene(3);
  Eigen::AlignedBox3d body;
  for (const Vec3& p : scene.body.mesh.points) body.extend(p);
  const Vec3 middle = body.center();
  const double half = 0.5 * body.sizes().x();
  RigidTool tool;
  tool.radius = 0.05 * half;
  tool.law.thickness = 0.2 * half;
  for (const ToolShape shape : {ToolShape::sphere, ToolShape::capsule}) {
    tool.shape = shape;
    tool.length = 0.1 * half;
    TouchToolSpace space;
    space.setup.id = kContactToolSpace;
    space.setup.interaction = rigid_contact_spec(with_defaults(tool, scene));
    ConfigurationSummary found;
    found.outcome = Outcome::converged;
    for (const double z : {0.0, 0.5, 1.5}) {
      found.t = middle + z * half * Vec3::UnitZ();
      space.configurations.push_back(found);
    }
    // Pressed so far, which it feels.
    found.t = middle;
    found.force = -Vec3::UnitZ();
    space.configurations.push_back(found);
    add_clearance(InteractionFactory(scene.body, {}).clearance(space.setup.interaction), space);
    EXPECT_EQ(space.configurations[0].outcome, Outcome::tool_inside);
    EXPECT_EQ(space.configurations[1].outcome, Outcome::tool_inside);
    EXPECT_EQ(space.configurations[2].outcome, Outcome::converged);
    EXPECT_EQ(space.configurations[3].outcome, Outcome::converged);
    ASSERT_TRUE(space.clearance);
    EXPECT_LT(space.clearance(middle), 0);
    EXPECT_GT(space.clearance(middle + 2 * half * Vec3::UnitZ()), 0);
  }
}

}  // namespace
}  // namespace palpate::test::test_touch_space
