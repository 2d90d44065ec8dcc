// SPDX-License-Identifier: BSD-3-Clause
#include "state_space/state_space.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace palpate::test::test_state_space {
namespace {

Configuration at(const CheckPoint& check_point, std::int32_t level = 0) {
  Configuration c;
  c.check_point = check_point;
  c.level = level;
  return c;
}

TEST(ToolSpaceSetup, SpacingAndReach) {
  ToolSpaceSetup tool_space;
  tool_space.grid.half_width = 0.012;
  tool_space.grid.resolution = 7;
  EXPECT_DOUBLE_EQ(tool_space.grid.spacing(), 0.004);
  EXPECT_EQ(tool_space.grid.reach(), 3);
  tool_space.grid.resolution = 1;
  EXPECT_EQ(tool_space.grid.spacing(), 0);
  EXPECT_EQ(tool_space.grid.reach(), 0);
}

TEST(StateSpace, SortsAndFinds) {
  StateSpace space;
  space.tool_spaces.resize(2);
  space.tool_spaces[0].setup.id = 7;
  space.tool_spaces[1].setup.id = 3;
  space.tool_spaces[0].configurations = {at({1, 0, 0}), at({0, 0, 0}, 1), at({-1, 2, 0}),
                                         at({0, 0, 0})};
  sort(space);
  EXPECT_EQ(space.find({3}), space.tool_spaces.data());
  EXPECT_EQ(space.find({5}), nullptr);
  const ToolSpace* tool_space = space.find({7});
  ASSERT_NE(tool_space, nullptr);
  EXPECT_TRUE(std::is_sorted(tool_space->configurations.begin(), tool_space->configurations.end()));
  EXPECT_EQ(tool_space->find({-1, 2, 0}), &tool_space->configurations[0]);
  EXPECT_EQ(tool_space->find({0, 0, 0}), &tool_space->configurations[1]);
  EXPECT_EQ(tool_space->find({0, 0, 0}, 1), &tool_space->configurations[2]);
  EXPECT_EQ(tool_space->find({0, 0, 0}, 2), nullptr);
  EXPECT_EQ(tool_space->find({0, 1, 0}), nullptr);
}

}  // namespace
}  // namespace palpate::test::test_state_space
