// SPDX-License-Identifier: BSD-3-Clause
#include "state_space/touch_space.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <limits>

#include "base/error.h"
#include "interaction/rigid_tool.h"
#include "solvers/state_space/example_space.h"
#include "state_space/state_space_file.h"

namespace palpate::test::test_touch_space {
namespace {

using test::cube_scene;
using test::example_setup;
using test::example_space;

Eigen::VectorXd on_surface(const Surface& surface, const Eigen::VectorXd& field) {
  Eigen::VectorXd result(3 * surface.num_points());
  for (Index p = 0; p < surface.num_points(); ++p) {
    result.segment<3>(3 * p) = field.segment<3>(3 * surface.mesh_points[p]);
  }
  return result;
}

double largest(const Eigen::VectorXd& field) {
  double result = 0;
  for (Eigen::Index i = 0; i < field.size(); i += 3) {
    result = std::max(result, field.segment<3>(i).norm());
  }
  return result;
}

TEST(TouchSpace, KeepsItsBoundOfTheWholeSpace) {
  const Scene scene = cube_scene(3);
  const StateSpace space = example_space(scene, {example_setup(63), example_setup(47, 3)});
  const TouchSpace touch = make_touch_space(space, 1e-3);
  EXPECT_EQ(touch.scene_hash, space.scene_hash);
  ASSERT_EQ(touch.tool_spaces.size(), 2U);

  double displacement = 0;
  double displacement_error = 0;
  double sensitivity_error = 0;
  for (const ToolSpace& from : space.tool_spaces) {
    const TouchToolSpace* tool_space = touch.find(from.setup.interaction.active_node);
    ASSERT_NE(tool_space, nullptr);
    EXPECT_EQ(tool_space->setup, from.setup);
    ASSERT_EQ(tool_space->configurations.size(), from.configurations.size());
    const Eigen::Index rank = tool_space->modes.cols();
    EXPECT_LT(rank, 30);
    for (std::size_t i = 0; i < from.configurations.size(); ++i) {
      const Configuration& c = from.configurations[i];
      EXPECT_EQ(tool_space->configurations[i].check_point, c.check_point);
      EXPECT_EQ(tool_space->configurations[i].force, c.force);
      const auto column = static_cast<Eigen::Index>(i);
      const Eigen::VectorXd u = on_surface(touch.surface, c.u);
      const Eigen::VectorXd modal_u =
          (tool_space->modes * tool_space->coefficients.col(column)).cast<double>();
      displacement = std::max(displacement, largest(u));
      displacement_error = std::max(displacement_error, largest(u - modal_u));
      for (int a = 0; a < 3; ++a) {
        const Eigen::VectorXd v = on_surface(touch.surface, c.v.col(a));
        const Eigen::VectorXd modal_v =
            (tool_space->modes *
             tool_space->coefficient_gradients.col(column).segment(a * rank, rank))
                .cast<double>();
        sensitivity_error =
            std::max(sensitivity_error, from.setup.grid.spacing() * largest(v - modal_v));
      }
    }
  }
  EXPECT_NEAR(touch.largest_displacement, displacement, 1e-6 * displacement);
  EXPECT_LE(displacement_error, 1e-3 * displacement);
  EXPECT_LE(displacement_error, touch.displacement_error);
  EXPECT_LE(touch.displacement_error, 1e-3 * touch.largest_displacement);
  EXPECT_LE(sensitivity_error, touch.sensitivity_error);
  EXPECT_LE(sensitivity_error, 2e-2 * displacement);
}

/// A space as a file, for as long as the test lasts.
class TouchSpaceFile : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = testing::TempDir() + "/palpate_XXXXXX";
    folder_ = mkdtemp(pattern.data());
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] StateSpaceFile file_of(const StateSpace& space) const {
    StateSpaceFile file =
        StateSpaceFile::create(folder_ / "space.palpate", space.scene, space.solver_tolerance);
    for (const ToolSpace& tool_space : space.tool_spaces) {
      file.add_tool_space(tool_space.setup);
      for (const Configuration& c : tool_space.configurations)
        file.add(tool_space.setup.interaction.active_node, c);
    }
    return file;
  }

 private:
  std::filesystem::path folder_;
};

TEST_F(TouchSpaceFile, EqualsTheSpaceInMemory) {
  const StateSpace space = example_space(cube_scene(), {example_setup(8, 3), example_setup(26, 3)});
  const StateSpaceFile file = file_of(space);
  const TouchSpace a = make_touch_space(space);
  const TouchSpace b = make_touch_space(file);
  EXPECT_EQ(a.tool_spaces[1].modes, b.tool_spaces[1].modes);
  EXPECT_EQ(a.scene_hash, b.scene_hash);
  ASSERT_EQ(b.tool_spaces.size(), 2U);
  EXPECT_EQ(a.tool_spaces[1].coefficients, b.tool_spaces[1].coefficients);
  EXPECT_EQ(a.tool_spaces[1].coefficient_gradients, b.tool_spaces[1].coefficient_gradients);
  EXPECT_EQ(a.tool_spaces[1].configurations.size(), b.tool_spaces[1].configurations.size());
}

TEST_F(TouchSpaceFile, WithoutModesAllButTheModesIsThere) {
  StateSpace space = example_space(cube_scene(), {example_setup(8, 3), example_setup(26, 3)});
  const TouchSpace whole = make_touch_space(space);
  for (ToolSpace& tool_space : space.tool_spaces) {
    for (Configuration& c : tool_space.configurations) {
      for_each_field(c, [](auto& field) { field = {}; });
    }
  }
  // Nor does it ask for fields.
  const TouchSpace bare = make_touch_space_without_modes(file_of(space));
  EXPECT_EQ(bare.scene_hash, whole.scene_hash);
  EXPECT_EQ(bare.surface.points, whole.surface.points);
  EXPECT_EQ(bare.surface.mesh_points, whole.surface.mesh_points);
  EXPECT_EQ(bare.surface.triangles, whole.surface.triangles);
  ASSERT_EQ(bare.tool_spaces.size(), 2U);
  for (std::size_t s = 0; s < 2; ++s) {
    EXPECT_EQ(bare.tool_spaces[s].modes.cols(), 0);
    EXPECT_EQ(bare.tool_spaces[s].setup, whole.tool_spaces[s].setup);
    EXPECT_EQ(bare.tool_spaces[s].coefficients.cols(), 27);
    EXPECT_EQ(bare.tool_spaces[s].coefficient_gradients.cols(), 27);
    ASSERT_EQ(bare.tool_spaces[s].configurations.size(), 27U);
    for (std::size_t c = 0; c < 27; ++c) {
      EXPECT_EQ(bare.tool_spaces[s].configurations[c].t, whole.tool_spaces[s].configurations[c].t);
      EXPECT_EQ(bare.tool_spaces[s].configurations[c].force,
                whole.tool_spaces[s].configurations[c].force);
    }
  }
}

TEST(TouchSpace, ConfigurationsThatFailedNeedNoFields) {
  const Scene scene = cube_scene();
  StateSpace space = example_space(scene, {example_setup(8, 3)});
  Configuration& failed = space.tool_spaces[0].configurations[2];
  failed.outcome = Outcome::not_converged;
  failed.u.resize(0);
  failed.v.resize(0, 0);
  const TouchSpace touch = make_touch_space(space);
  EXPECT_EQ(touch.tool_spaces[0].configurations.size(), 27U);
  EXPECT_TRUE(touch.tool_spaces[0].coefficients.col(2).isZero(0));
  EXPECT_FALSE(touch.tool_spaces[0].coefficients.col(3).isZero(0));
}

TEST(TouchSpace, RestAloneAndNothingUsable) {
  const Scene scene = cube_scene();
  StateSpace space = example_space(scene, {example_setup(8, 1)});
  TouchSpace touch = make_touch_space(space);
  EXPECT_EQ(touch.tool_spaces[0].modes.cols(), 3);
  EXPECT_TRUE(touch.tool_spaces[0].coefficients.isZero(1e-12F));
  EXPECT_FALSE(touch.tool_spaces[0].coefficient_gradients.isZero(1e-3F));
  space.tool_spaces[0].configurations[0].outcome = Outcome::aborted;
  touch = make_touch_space(space);
  EXPECT_EQ(touch.tool_spaces[0].modes.cols(), 0);
  EXPECT_EQ(touch.tool_spaces[0].coefficients.cols(), 1);
  space.tool_spaces.clear();
  EXPECT_TRUE(make_touch_space(space).tool_spaces.empty());
}

TEST(TouchSpace, RefusesMissingAndBrokenFields) {
  const Scene scene = cube_scene();
  const StateSpace whole = example_space(scene, {example_setup(8, 3)});
  StateSpace space = whole;
  space.tool_spaces[0].configurations[5].v.resize(0, 0);
  EXPECT_THROW((void)make_touch_space(space), InputError);
  space = whole;
  space.tool_spaces[0].configurations[5].u[7] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW((void)make_touch_space(space), InputError);
  space = whole;
  space.tool_spaces[0].setup.interaction.active_node = scene.mesh.num_points();
  EXPECT_THROW((void)make_touch_space(space), InputError);
  EXPECT_THROW((void)make_touch_space(whole, 0), InputError);
}

// Earlier versions took it for an equilibrium without force.
TEST(TouchSpace, AToolThatTouchesNothingInTheBodyHasGoneThroughItsSurface) {
  const Scene scene = cube_scene(3);
  Eigen::AlignedBox3d body;
  for (const Vec3& p : scene.mesh.points) body.extend(p);
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
    add_clearance(scene, space);
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
