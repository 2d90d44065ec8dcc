// SPDX-License-Identifier: BSD-3-Clause
#include "fields/make_touch_space.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "base/error.h"
#include "solvers/state_space/example_space.h"

namespace palpate::test::test_make_touch_space {
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
  EXPECT_EQ(touch.scene_hash, space.body().hash);
  ASSERT_EQ(touch.tool_spaces.size(), 2U);

  double displacement = 0;
  double displacement_error = 0;
  double sensitivity_error = 0;
  for (const ToolSpace& from : space.tool_spaces) {
    const TouchToolSpace* tool_space = touch.find(from.setup.key());
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
  space.tool_spaces[0].setup.interaction.active_node = scene.body.mesh.num_points();
  EXPECT_THROW((void)make_touch_space(space), InputError);
  EXPECT_THROW((void)make_touch_space(whole, 0), InputError);
}

}  // namespace
}  // namespace palpate::test::test_make_touch_space
