// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <functional>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "exploration/layered_grid.h"

namespace palpate {
namespace {

constexpr Index kNode = 5;

std::int32_t layer_of(const CheckPoint& p) {
  return std::max({std::abs(p[0]), std::abs(p[1]), std::abs(p[2])});
}

using Solve = std::function<ConfigurationSummary(const Transition&)>;
using See = std::function<void(const Transition&)>;

/// One transition and, depth first, those that follow; what it finds.
void walk(const LayeredGrid& grid, const Transition& transition, bool deep, const Solve& solve,
          const See& see, std::vector<std::pair<Index, ConfigurationSummary>>& all) {
  see(transition);
  ConfigurationSummary found = solve(transition);
  found.check_point = transition.target;
  found.parent = transition.start;
  all.emplace_back(transition.active_node, found);
  if (!deep) return;
  for (const Transition& next : grid.following(transition.active_node, found)) {
    walk(grid, next, deep, solve, see, all);
  }
}

/// Explores with an answer for every target, and calls see(transition) for each.
/// @param deep Each transition of a batch with those that follow.
/// @returns the number of batches.
int explore(LayeredGrid& grid, bool deep, const Solve& solve, const See& see) {
  int num_batches = 0;
  for (auto batch = grid.next(); !batch.empty(); batch = grid.next()) {
    ++num_batches;
    std::vector<std::pair<Index, ConfigurationSummary>> all;
    for (const Transition& transition : batch) walk(grid, transition, deep, solve, see, all);
    for (const auto& [node, found] : all) grid.accept(node, found);
  }
  return num_batches;
}

ConfigurationSummary good(const Transition&) {
  ConfigurationSummary found;
  found.outcome = Outcome::converged;
  return found;
}

class LayeredGridTest : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(LayeredGrid, LayeredGridTest, testing::Bool(),
                         [](const auto& order) { return order.param ? "Deep" : "Layers"; });

TEST_P(LayeredGridTest, ReachesEveryCheckPointOnceFromTheLayerBefore) {
  LayeredGrid grid({{kNode, 0.01, 7, 0}});
  std::set<CheckPoint> seen;
  const int num_batches = explore(grid, GetParam(), good, [&](const Transition& t) {
    EXPECT_TRUE(seen.insert(t.target).second);
    const std::int32_t layer = layer_of(t.target);
    if (layer == 0) {
      EXPECT_EQ(t.start, t.target);
      return;
    }
    const CheckPoint& start = t.start;
    EXPECT_EQ(layer_of(start), layer - 1);
    EXPECT_EQ(layer_of({start[0] - t.target[0], start[1] - t.target[1], start[2] - t.target[2]}),
              1);
    EXPECT_EQ(seen.count(start), 1U);
  });
  EXPECT_EQ(static_cast<std::int64_t>(seen.size()), grid.num_expected());
  EXPECT_EQ(seen.size(), 343U);
  // Where nothing fails, all follows from rest.
  EXPECT_EQ(num_batches, GetParam() ? 1 : 4);
}

TEST_P(LayeredGridTest, PrefersTheStartOnTheStraightWayFromRest) {
  LayeredGrid grid({{kNode, 0.01, 7, 0}});
  std::map<CheckPoint, CheckPoint> starts;
  explore(grid, GetParam(), good, [&](const Transition& t) { starts[t.target] = t.start; });
  EXPECT_EQ(starts.at({2, 2, 2}), (CheckPoint{1, 1, 1}));
  EXPECT_EQ(starts.at({-3, 0, 0}), (CheckPoint{-2, 0, 0}));
  EXPECT_EQ(starts.at({0, 3, -3}), (CheckPoint{0, 2, -2}));
}

TEST_P(LayeredGridTest, DoesNotExpandWhatFailedOrIsBeyondTheForceLimit) {
  // Everything with x > 0 fails, everything with y > 0 is beyond the limit.
  LayeredGrid grid({{kNode, 0.01, 7, 1}});
  std::set<CheckPoint> seen;
  explore(
      grid, GetParam(),
      [](const Transition& t) {
        ConfigurationSummary found = good(t);
        if (t.target[0] > 0) found.outcome = Outcome::not_converged;
        if (t.target[1] > 0) found.flags |= flags::beyond_force_limit;
        return found;
      },
      [&](const Transition& t) {
        seen.insert(t.target);
        EXPECT_LE(t.start[0], 0);
        EXPECT_LE(t.start[1], 0);
        EXPECT_FALSE(grid.is_settled(kNode, t.target));
      });
  EXPECT_EQ(seen.count({1, 1, 1}), 1U);  // from rest
  EXPECT_EQ(seen.count({2, 0, 0}), 0U);  // behind what failed
  EXPECT_EQ(seen.count({0, 2, 0}), 0U);
  EXPECT_EQ(seen.count({-3, -3, -3}), 1U);
  for (const CheckPoint& target : seen) EXPECT_TRUE(grid.is_settled(kNode, target));
  EXPECT_TRUE(grid.is_settled(kNode, {2, 0, 0}));  // given up
}

TEST_P(LayeredGridTest, TriesTheThreeBestStartsInTurn) {
  // Nothing leads to these, and no step begins at that one.
  const CheckPoint hard{2, 1, 0};
  const CheckPoint useless{1, 0, 0};
  const CheckPoint from_second{-2, 1, 0};
  LayeredGrid grid({{kNode, 0.01, 7, 0}});
  std::map<CheckPoint, std::vector<CheckPoint>> starts;
  explore(
      grid, GetParam(),
      [&](const Transition& t) {
        ConfigurationSummary found = good(t);
        const bool first = starts[t.target].size() == 1;
        if (t.target == hard || t.start == useless || (t.target == from_second && first)) {
          found.outcome = Outcome::not_converged;
        }
        return found;
      },
      [&](const Transition& t) { starts[t.target].push_back(t.start); });
  EXPECT_EQ(starts.at(hard),
            (std::vector<CheckPoint>{{1, 0, 0}, {1, 1, 0}, {1, 0, -1}}));
  EXPECT_EQ(starts.at({2, 0, 0}).size(), 2U);
  EXPECT_EQ(starts.at(from_second), (std::vector<CheckPoint>{{-1, 0, 0}, {-1, 1, 0}}));
  // Behind the one that failed the next best start serves.
  EXPECT_EQ(starts.at({3, 1, 0}).size(), 1U);
  EXPECT_EQ(starts.size(), 343U);
}

// The rule for starts does not depend on the order in which configurations are found.
TEST(LayeredGrid, FindsTheSameDepthFirstAsByLayers) {
  const auto solve = [](const Transition& t) {
    ConfigurationSummary found = good(t);
    // Some steps fail, some configurations are beyond the limit: by a hash of their places.
    const auto mix = [](const CheckPoint& p) { return 7 * p[0] + 31 * p[1] + 101 * p[2]; };
    if ((mix(t.target) * 3 + mix(t.start)) % 5 == 1) found.outcome = Outcome::not_converged;
    if (std::abs(mix(t.target)) % 7 == 3) found.flags |= flags::beyond_force_limit;
    return found;
  };
  std::vector<std::set<std::pair<CheckPoint, CheckPoint>>> made;
  for (const bool deep : {false, true}) {
    LayeredGrid grid({{kNode, 0.01, 9, 1}});
    auto& all = made.emplace_back();
    explore(grid, deep, solve, [&](const Transition& t) {
      EXPECT_TRUE(all.insert({t.start, t.target}).second) << "made twice";
    });
    EXPECT_GT(all.size(), 200U);
  }
  EXPECT_EQ(made[0], made[1]);
}

TEST(LayeredGrid, GoesOnFromWhatAnEarlierRunFound) {
  LayeredGrid first({{kNode, 0.01, 7, 0}});
  std::vector<ConfigurationSummary> known;
  explore(first, true, good, [&](const Transition& t) {
    ConfigurationSummary found = good(t);
    found.check_point = t.target;
    found.parent = t.start;
    if (known.size() < 200) known.push_back(found);
  });
  LayeredGrid second({{kNode, 0.01, 7, 0}});
  std::set<CheckPoint> seen;
  for (const ConfigurationSummary& c : known) {
    second.accept(kNode, c);
    seen.insert(c.check_point);
  }
  std::int64_t num_following = 0;
  for (const Transition& t : second.next()) num_following += second.num_following(t);
  EXPECT_EQ(num_following, 143);
  EXPECT_EQ(explore(second, true, good,
                    [&](const Transition& t) { EXPECT_TRUE(seen.insert(t.target).second); }),
            1);
  EXPECT_EQ(seen.size(), 343U);
}

TEST(LayeredGrid, StopsWhereRestItselfFails) {
  LayeredGrid grid({{kNode, 0.01, 3, 0}});
  int count = 0;
  explore(
      grid, true, [](const Transition&) { return ConfigurationSummary{}; },
      [&](const Transition&) { ++count; });
  EXPECT_EQ(count, 1);
}

TEST_P(LayeredGridTest, TakesSitesOfAnySizeTogether) {
  LayeredGrid grid({{1, 0.01, 3, 0}, {2, 0.01, 7, 0}, {3, 0.02, 5, 0}});
  std::set<std::pair<Index, CheckPoint>> seen;
  std::vector<Index> order;
  explore(grid, GetParam(), good, [&](const Transition& t) {
    seen.insert({t.active_node, t.target});
    order.push_back(t.active_node);
  });
  EXPECT_EQ(seen.size(), 27U + 343U + 125U);
  EXPECT_EQ(grid.num_expected(), 27 + 343 + 125);
  EXPECT_EQ(std::is_sorted(order.begin(), order.end()), GetParam());
}

}  // namespace
}  // namespace palpate
