// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "exploration/layered_grid.h"
#include "solvers/exploration/strategy_run.h"
#include "solvers/support/setup.h"

namespace palpate::test::test_layered_grid {
namespace {

using test::explore;
using test::good;
using test::Order;

std::int32_t layer_of(const CheckPoint& p) {
  return std::max({std::abs(p[0]), std::abs(p[1]), std::abs(p[2])});
}

ToolSpaceSetup setup_of(std::int32_t resolution) {
  return test::bonded_setup(5, {0.01, resolution}, {1});
}

class LayeredGridTest : public testing::TestWithParam<Order> {};
INSTANTIATE_TEST_SUITE_P(LayeredGrid, LayeredGridTest,
                         testing::Values(Order::deep, Order::wide, Order::random),
                         [](const auto& order) { return to_string(order.param); });

TEST_P(LayeredGridTest, ReachesEveryCheckPointOnceFromTheLayerBefore) {
  LayeredGrid grid(setup_of(7).grid);
  std::set<CheckPoint> seen;
  explore(grid, setup_of(7), GetParam(), [&](const Transition& t) {
    EXPECT_TRUE(seen.insert(t.target).second);
    const std::int32_t layer = layer_of(t.target);
    EXPECT_EQ(t.needs_no_start(), layer == 0);
    if (layer == 0) return good(t);
    const CheckPoint& start = t.start;
    EXPECT_EQ(layer_of(start), layer - 1);
    EXPECT_EQ(layer_of({start[0] - t.target[0], start[1] - t.target[1], start[2] - t.target[2]}),
              1);
    EXPECT_EQ(seen.count(start), 1U);
    return good(t);
  });
  EXPECT_EQ(static_cast<std::int64_t>(seen.size()), grid.num_expected());
  EXPECT_EQ(seen.size(), 343U);
  EXPECT_TRUE(grid.is_complete());
}

TEST(LayeredGrid, WhereNothingFailsAllFollowsFromRest) {
  LayeredGrid grid(setup_of(7).grid);
  std::vector<Transition> due = grid.next();
  ASSERT_EQ(due.size(), 1U);
  EXPECT_TRUE(due.front().needs_no_start());
  explore(grid, setup_of(7), Order::deep, good);
  std::size_t num_followed = 1;
  for (std::int32_t i = -3; i <= 3; ++i) {
    for (std::int32_t j = -3; j <= 3; ++j) {
      for (std::int32_t k = -3; k <= 3; ++k) {
        ConfigurationSummary found = good({});
        found.check_point = {i, j, k};
        num_followed += following_in_layers(setup_of(7).grid, found).size();
      }
    }
  }
  EXPECT_EQ(num_followed, 343U);
}

TEST_P(LayeredGridTest, PrefersTheStartOnTheStraightWayFromRest) {
  LayeredGrid grid(setup_of(7).grid);
  std::map<CheckPoint, CheckPoint> starts;
  explore(grid, setup_of(7), GetParam(), [&](const Transition& t) {
    starts[t.target] = t.start;
    return good(t);
  });
  EXPECT_EQ(starts.at({2, 2, 2}), (CheckPoint{1, 1, 1}));
  EXPECT_EQ(starts.at({-3, 0, 0}), (CheckPoint{-2, 0, 0}));
  EXPECT_EQ(starts.at({0, 3, -3}), (CheckPoint{0, 2, -2}));
}

TEST_P(LayeredGridTest, DoesNotExpandWhatFailedOrIsBeyondTheForceLimit) {
  // Everything with x > 0 fails, everything with y > 0 is beyond the limit.
  LayeredGrid grid(setup_of(7).grid);
  std::set<CheckPoint> seen;
  explore(grid, setup_of(7), GetParam(), [&](const Transition& t) {
    seen.insert(t.target);
    EXPECT_LE(t.start[0], 0);
    EXPECT_LE(t.start[1], 0);
    ConfigurationSummary found = good(t);
    if (t.target[0] > 0) found.outcome = Outcome::not_converged;
    if (t.target[1] > 0) found.flags |= flags::beyond_force_limit;
    return found;
  });
  EXPECT_EQ(seen.count({1, 1, 1}), 1U);  // from rest
  EXPECT_EQ(seen.count({2, 0, 0}), 0U);  // behind what failed
  EXPECT_EQ(seen.count({0, 2, 0}), 0U);
  EXPECT_EQ(seen.count({-3, -3, -3}), 1U);
  EXPECT_TRUE(grid.is_complete());
  std::vector<CheckPoint> given_up = grid.given_up();
  EXPECT_EQ(std::set<CheckPoint>(given_up.begin(), given_up.end()).size(), given_up.size());
  const auto is_given_up = [&](const CheckPoint& p) {
    return std::find(given_up.begin(), given_up.end(), p) != given_up.end();
  };
  EXPECT_TRUE(is_given_up({2, 0, 0}));
  EXPECT_TRUE(is_given_up({1, 0, 0}));   // failed
  EXPECT_FALSE(is_given_up({0, 1, 0}));  // found
}

TEST_P(LayeredGridTest, TriesTheThreeBestStartsInTurn) {
  // Nothing leads to these, and no step begins at that one.
  const CheckPoint hard{2, 1, 0};
  const CheckPoint useless{1, 0, 0};
  const CheckPoint from_second{-2, 1, 0};
  LayeredGrid grid(setup_of(7).grid);
  std::map<CheckPoint, std::vector<CheckPoint>> starts;
  explore(grid, setup_of(7), GetParam(), [&](const Transition& t) {
    starts[t.target].push_back(t.start);
    ConfigurationSummary found = good(t);
    const bool first = starts[t.target].size() == 1;
    if (t.target == hard || t.start == useless || (t.target == from_second && first)) {
      found.outcome = Outcome::not_converged;
    }
    return found;
  });
  EXPECT_EQ(starts.at(hard), (std::vector<CheckPoint>{{1, 0, 0}, {1, 1, 0}, {1, 0, -1}}));
  EXPECT_EQ(starts.at({2, 0, 0}).size(), 2U);
  EXPECT_EQ(starts.at(from_second), (std::vector<CheckPoint>{{-1, 0, 0}, {-1, 1, 0}}));
  // Behind the one that failed the next best start serves.
  EXPECT_EQ(starts.at({3, 1, 0}).size(), 1U);
  EXPECT_EQ(starts.size(), 343U);
  EXPECT_EQ(grid.given_up(), std::vector<CheckPoint>{hard});
}

/// Some steps fail, some configurations are beyond the limit: by a hash of their places.
ConfigurationSummary moody(const Transition& t) {
  ConfigurationSummary found = good(t);
  const auto mix = [](const CheckPoint& p) { return 7 * p[0] + 31 * p[1] + 101 * p[2]; };
  if ((mix(t.target) * 3 + mix(t.start)) % 5 == 1) found.outcome = Outcome::not_converged;
  if (std::abs(mix(t.target)) % 7 == 3) found.flags |= flags::beyond_force_limit;
  return found;
}

using Made = std::set<std::pair<CheckPoint, CheckPoint>>;

// The rule for starts does not depend on the order in which configurations are found.
TEST(LayeredGrid, FindsTheSameInAnyOrder) {
  std::vector<Made> made;
  for (const Order order : {Order::deep, Order::wide, Order::random}) {
    LayeredGrid grid(setup_of(9).grid);
    Made& all = made.emplace_back();
    explore(grid, setup_of(9), order, [&](const Transition& t) {
      EXPECT_TRUE(all.insert({t.start, t.target}).second) << "made twice";
      return moody(t);
    });
    EXPECT_GT(all.size(), 200U);
    EXPECT_TRUE(grid.is_complete());
  }
  EXPECT_EQ(made[0], made[1]);
  EXPECT_EQ(made[0], made[2]);
}

TEST(LayeredGrid, GoesOnFromWhatAnEarlierRunFound) {
  LayeredGrid whole(setup_of(9).grid);
  std::set<CheckPoint> usable;
  for (const auto& found : explore(whole, setup_of(9), Order::deep, moody)) {
    if (found.usable()) usable.insert(found.check_point);
  }
  for (const std::size_t until : {0U, 1U, 50U, 200U, 1000U}) {
    LayeredGrid first(setup_of(9).grid);
    LayeredGrid second(setup_of(9).grid);
    std::set<CheckPoint> all;
    // What was found is kept before the strategy hears of it.
    explore(
        first, setup_of(9), Order::random,
        [&](const Transition& t) {
          ConfigurationSummary found = moody(t);
          found.check_point = t.target;
          if (found.usable()) {
            second.recall(found);
            all.insert(found.check_point);
          }
          return found;
        },
        until);
    const auto rest = explore(second, setup_of(9), Order::random, moody);
    for (const auto& found : rest) {
      EXPECT_TRUE(!found.usable() || all.insert(found.check_point).second) << "found again";
    }
    EXPECT_EQ(all, usable) << until;
  }
}

TEST(LayeredGrid, StopsWhereRestItselfFails) {
  LayeredGrid grid(setup_of(3).grid);
  const auto found = explore(grid, setup_of(3), Order::deep,
                             [](const Transition&) { return ConfigurationSummary{}; });
  EXPECT_EQ(found.size(), 1U);
  EXPECT_EQ(grid.given_up().size(), 27U);
}

TEST(LayeredGrid, TheCornersOfCoarseCellsAreAGridOfTheirOwn) {
  ToolSpaceSetup setup = setup_of(65);
  setup.grid.coarsest = 16;
  LayeredGrid grid(setup.grid);
  EXPECT_EQ(grid.num_expected(), 125);
  std::set<CheckPoint> seen;
  for (const auto& found : explore(grid, setup, Order::random, good))
    seen.insert(found.check_point);
  EXPECT_EQ(seen.size(), 125U);
  for (const CheckPoint& p : seen) {
    for (const std::int32_t c : p) EXPECT_EQ(c % 16, 0);
  }
  EXPECT_EQ(seen.count({-32, 16, 0}), 1U);
}

}  // namespace
}  // namespace palpate::test::test_layered_grid
