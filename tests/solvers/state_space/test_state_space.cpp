// SPDX-License-Identifier: BSD-3-Clause
#include "state_space/state_space.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace palpate {
namespace {

Configuration at(const CheckPoint& check_point, std::int32_t level = 0) {
  Configuration c;
  c.check_point = check_point;
  c.level = level;
  return c;
}

TEST(Site, SpacingAndReach) {
  Site site;
  site.half_width = 0.012;
  site.resolution = 7;
  EXPECT_DOUBLE_EQ(site.spacing(), 0.004);
  EXPECT_EQ(site.reach(), 3);
  site.resolution = 1;
  EXPECT_EQ(site.spacing(), 0);
  EXPECT_EQ(site.reach(), 0);
}

TEST(StateSpace, SortsAndFinds) {
  StateSpace space;
  space.sites.resize(2);
  space.sites[0].site.active_node = 7;
  space.sites[1].site.active_node = 3;
  space.sites[0].configurations = {at({1, 0, 0}), at({0, 0, 0}, 1), at({-1, 2, 0}), at({0, 0, 0})};
  sort(space);
  EXPECT_EQ(space.find(3), space.sites.data());
  EXPECT_EQ(space.find(5), nullptr);
  const SiteSpace* site = space.find(7);
  ASSERT_NE(site, nullptr);
  EXPECT_TRUE(std::is_sorted(site->configurations.begin(), site->configurations.end()));
  EXPECT_EQ(site->find({-1, 2, 0}), &site->configurations[0]);
  EXPECT_EQ(site->find({0, 0, 0}), &site->configurations[1]);
  EXPECT_EQ(site->find({0, 0, 0}, 1), &site->configurations[2]);
  EXPECT_EQ(site->find({0, 0, 0}, 2), nullptr);
  EXPECT_EQ(site->find({0, 1, 0}), nullptr);
}

}  // namespace
}  // namespace palpate
