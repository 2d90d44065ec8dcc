// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <functional>
#include <set>

#include "exploration/layered_grid.h"

namespace palpate {
namespace {

constexpr Index kNode = 5;

std::int32_t layer_of(const CheckPoint& p) {
  return std::max({std::abs(p[0]), std::abs(p[1]), std::abs(p[2])});
}

/// Explores with an answer for every target, and calls see(transition) for each.
void explore(LayeredGrid& grid, const std::function<ConfigurationSummary(const Transition&)>& solve,
             const std::function<void(const Transition&)>& see) {
  for (auto batch = grid.next(); !batch.empty(); batch = grid.next()) {
    for (const Transition& transition : batch) {
      see(transition);
      ConfigurationSummary found = solve(transition);
      found.check_point = transition.target;
      grid.accept(transition.active_node, found);
    }
  }
}

ConfigurationSummary good(const Transition&) {
  ConfigurationSummary found;
  found.outcome = Outcome::converged;
  return found;
}

TEST(LayeredGrid, ReachesEveryCheckPointOnceFromTheLayerBefore) {
  LayeredGrid grid({{kNode, 0.01, 7, 0}}, 1);
  std::set<CheckPoint> seen;
  explore(grid, good, [&](const Transition& t) {
    EXPECT_TRUE(seen.insert(t.target).second);
    const std::int32_t layer = layer_of(t.target);
    EXPECT_EQ(t.starts.empty(), layer == 0);
    for (const CheckPoint& start : t.starts) {
      EXPECT_EQ(layer_of(start), layer - 1);
      EXPECT_EQ(layer_of({start[0] - t.target[0], start[1] - t.target[1], start[2] - t.target[2]}),
                1);
      EXPECT_EQ(seen.count(start), 1U);
    }
  });
  EXPECT_EQ(static_cast<std::int64_t>(seen.size()), grid.num_expected());
  EXPECT_EQ(seen.size(), 343U);
}

TEST(LayeredGrid, PrefersTheStartOnTheStraightWayFromRest) {
  LayeredGrid grid({{kNode, 0.01, 7, 0}}, 1);
  explore(grid, good, [](const Transition& t) {
    const auto expect_from = [&](const CheckPoint& target, const CheckPoint& start) {
      if (t.target == target) {
        EXPECT_EQ(t.starts.front(), start);
      }
    };
    expect_from({2, 2, 2}, {1, 1, 1});
    expect_from({-3, 0, 0}, {-2, 0, 0});
    expect_from({0, 3, -3}, {0, 2, -2});
  });
}

TEST(LayeredGrid, DoesNotExpandWhatFailedOrIsBeyondTheForceLimit) {
  // Everything with x > 0 fails, everything with y > 0 is beyond the limit.
  LayeredGrid grid({{kNode, 0.01, 7, 1}}, 1);
  std::set<CheckPoint> seen;
  explore(
      grid,
      [](const Transition& t) {
        ConfigurationSummary found = good(t);
        if (t.target[0] > 0) found.outcome = Outcome::not_converged;
        if (t.target[1] > 0) found.flags |= flags::beyond_force_limit;
        return found;
      },
      [&](const Transition& t) {
        seen.insert(t.target);
        for (const CheckPoint& start : t.starts) {
          EXPECT_LE(start[0], 0);
          EXPECT_LE(start[1], 0);
        }
      });
  EXPECT_EQ(seen.count({1, 1, 1}), 1U);  // from rest
  EXPECT_EQ(seen.count({2, 0, 0}), 0U);  // behind what failed
  EXPECT_EQ(seen.count({0, 2, 0}), 0U);
  EXPECT_EQ(seen.count({-3, -3, -3}), 1U);
}

TEST(LayeredGrid, StopsWhereRestItselfFails) {
  LayeredGrid grid({{kNode, 0.01, 3, 0}}, 1);
  int count = 0;
  explore(
      grid, [](const Transition&) { return ConfigurationSummary{}; },
      [&](const Transition&) { ++count; });
  EXPECT_EQ(count, 1);
}

TEST(LayeredGrid, TakesSitesOfAnyNumberTogetherAndOfAnySize) {
  for (int at_once : {1, 2, 5}) {
    LayeredGrid grid({{1, 0.01, 3, 0}, {2, 0.01, 7, 0}, {3, 0.02, 5, 0}}, at_once);
    std::set<std::pair<Index, CheckPoint>> seen;
    explore(grid, good, [&](const Transition& t) { seen.insert({t.active_node, t.target}); });
    EXPECT_EQ(seen.size(), 27U + 343U + 125U);
    EXPECT_EQ(grid.num_expected(), 27 + 343 + 125);
  }
}

}  // namespace
}  // namespace palpate
