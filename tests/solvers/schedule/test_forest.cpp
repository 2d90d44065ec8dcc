// SPDX-License-Identifier: BSD-3-Clause
#include "solvers/support/forest.h"

#include <gtest/gtest.h>

#include <vector>

#include "base/error.h"

namespace palpate::test::test_forest {
namespace {

using test::Forest;
using test::Machine;
using test::MasterOptions;
using test::TaskTree;

/// Messages take no time.
Machine ideal() {
  Machine machine;
  machine.latency = 0;
  machine.bandwidth = 1e300;
  machine.overhead = 0;
  machine.reaction = 0;
  return machine;
}

TaskTree chain(int length, double seconds) {
  TaskTree tree;
  for (int i = 0; i < length; ++i) {
    tree.seconds.push_back(seconds);
    tree.parent.push_back(i - 1);
  }
  return tree;
}

/// A root without cost and its children.
TaskTree star(int num_children, double seconds) {
  TaskTree tree{{0}, {-1}};
  for (int i = 0; i < num_children; ++i) {
    tree.seconds.push_back(seconds);
    tree.parent.push_back(0);
  }
  return tree;
}

MasterOptions ideal_options() {
  MasterOptions options;
  options.machine = ideal();
  options.start_seconds = 0;
  return options;
}

TEST(Forest, WorkAndCriticalPath) {
  const Forest forest{{chain(5, 2), TaskTree{{1, 4, 1, 1}, {-1, 0, 0, 2}}}, {0, 1, 1}};
  EXPECT_EQ(forest.num_tasks(), 13);
  EXPECT_DOUBLE_EQ(forest.work(), 10 + 7 + 7);
  EXPECT_DOUBLE_EQ(forest.critical_path(), 10);
  EXPECT_DOUBLE_EQ(forest.least_makespan(2), 12);
  EXPECT_DOUBLE_EQ(forest.least_makespan(3), 10);
}

TEST(Forest, MustHang) {
  const auto simulate = [](const Forest& forest) { (void)test::static_makespan(forest, 2); };
  EXPECT_THROW(simulate({{TaskTree{}}, {0}}), InputError);
  EXPECT_THROW(simulate({{TaskTree{{1}, {0}}}, {0}}), InputError);
  EXPECT_THROW(simulate({{TaskTree{{1, 1}, {-1, 1}}}, {0}}), InputError);
  EXPECT_THROW(simulate({{TaskTree{{1, 1}, {-1}}}, {0}}), InputError);
  EXPECT_THROW(simulate({{TaskTree{{-1}, {-1}}}, {0}}), InputError);
  EXPECT_THROW(simulate({{chain(2, 1)}, {1}}), InputError);
  EXPECT_NO_THROW(simulate({{chain(2, 1)}, {0}}));
}

TEST(StaticShare, IsTheSlowestRank) {
  const Forest forest{{chain(1, 1), chain(3, 1)}, {0, 1, 0, 1, 0}};
  EXPECT_DOUBLE_EQ(test::static_makespan(forest, 1), 9);
  EXPECT_DOUBLE_EQ(test::static_makespan(forest, 2), 6);
}

TEST(Master, HandsOutOneTaskAfterTheOther) {
  const Forest forest{{chain(1, 1)}, {0, 0, 0, 0}};
  EXPECT_DOUBLE_EQ(test::master_makespan(forest, 1, ideal_options()), 4);
  // Two of the three ranks work.
  EXPECT_DOUBLE_EQ(test::master_makespan(forest, 3, ideal_options()), 2);

  // Two messages a task through one processor: with tasks of no length nothing else counts.
  MasterOptions options = ideal_options();
  options.machine.overhead = 1e-3;
  const Forest instant{{chain(1, 0)}, std::vector<int>(1000, 0)};
  EXPECT_NEAR(test::master_makespan(instant, 513, options), 2.0, 0.01);

  // A root whose four children go to four ranks: its state comes once and leaves three times.
  options = ideal_options();
  options.machine.bandwidth = 1e6;
  options.state_bytes = 1'000'000;
  options.summary_bytes = 0;
  const Forest one_star{{star(4, 10)}, {0}};
  EXPECT_NEAR(test::master_makespan(one_star, 5, options), 14, 0.01);
}

}  // namespace
}  // namespace palpate::test::test_forest
