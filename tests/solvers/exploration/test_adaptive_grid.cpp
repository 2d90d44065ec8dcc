// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <set>
#include <vector>

#include "exploration/adaptive_grid.h"
#include "interpolation/interpolator.h"
#include "solvers/exploration/strategy_run.h"
#include "solvers/support/setup.h"

namespace palpate::test::test_adaptive_grid {
namespace {

using test::explore;
using test::Order;

constexpr double kHalfWidth = 0.01;

ToolSpaceSetup setup_of(double tolerance) {
  ToolSpaceSetup setup = test::bonded_setup(5, {kHalfWidth, 65, 16});
  setup.policy.tolerance = tolerance;
  setup.policy.tolerance_is_relative = true;
  return setup;
}

/// A body that stiffens towards one corner of the box: Π = c (e^(g·t) − 1 − g·t) + ½ K |t|².
struct Stiffening {
  Vec3 g = Vec3(300, 200, 120);
  double c = 1e-3;
  double k = 100;

  [[nodiscard]] Vec3 force(const Vec3& t) const { return c * std::expm1(g.dot(t)) * g + k * t; }
  [[nodiscard]] ConfigurationSummary at(const ToolSpaceSetup& setup,
                                        const Transition& transition) const {
    ConfigurationSummary found;
    const auto& [i, j, l] = transition.target;
    found.t = setup.grid.spacing() * Vec3(i, j, l);
    const double x = g.dot(found.t);
    found.energy = c * (std::expm1(x) - x) + 0.5 * k * found.t.squaredNorm();
    found.force = force(found.t);
    found.stiffness = c * std::exp(x) * g * g.transpose() + k * Mat3::Identity();
    found.outcome = Outcome::converged;
    return found;
  }
};

test::Solve stiffening(const ToolSpaceSetup& setup) {
  return [setup](const Transition& t) { return Stiffening().at(setup, t); };
}

std::set<CheckPoint> points(const std::vector<ConfigurationSummary>& found) {
  std::set<CheckPoint> all;
  for (const ConfigurationSummary& c : found) all.insert(c.check_point);
  return all;
}

double largest_error(const ToolSpaceSetup& setup, const std::vector<ConfigurationSummary>& found) {
  TouchToolSpace touch;
  touch.setup = setup;
  touch.configurations = found;
  std::sort(touch.configurations.begin(), touch.configurations.end());
  const auto interpolator = make_interpolator(Method::energy_hermite, touch);
  const Stiffening body;
  double error = 0;
  std::srand(3);
  for (int n = 0; n < 5000; ++n) {
    const Vec3 t = kHalfWidth * Vec3::Random();
    error = std::max(error, (interpolator->evaluate(t).force - body.force(t)).norm());
  }
  return error / body.force(Vec3::Constant(kHalfWidth)).norm();
}

TEST(AdaptiveGrid, ReachesItsToleranceWithFarFewerThanTheUniformGrid) {
  std::size_t last = 0;
  for (const double tolerance : {1e-2, 1e-3, 1e-4}) {
    const ToolSpaceSetup setup = setup_of(tolerance);
    AdaptiveGrid grid(setup);
    const auto found = explore(grid, setup, Order::deep, stiffening(setup));
    EXPECT_EQ(points(found).size(), found.size()) << "found twice";
    EXPECT_EQ(static_cast<std::int64_t>(found.size()), grid.num_expected());
    EXPECT_LE(largest_error(setup, found), tolerance);
    EXPECT_GE(found.size(), last);
    last = found.size();
  }
  EXPECT_GT(last, 125U);
  EXPECT_LT(last, 17U * 17 * 17);
}

// Two branches that meet at a plane, where no refinement helps.
TEST(AdaptiveGrid, AJumpIsMarkedAndNotRefinedForEver) {
  const ToolSpaceSetup setup = setup_of(1e-3);
  const double wall = 0.37 * kHalfWidth;
  AdaptiveGrid grid(setup);
  std::vector<ConfigurationSummary> found =
      explore(grid, setup, Order::deep, [&](const Transition& t) {
        Stiffening body;
        body.g = Vec3(50, 30, 20);
        ConfigurationSummary c = body.at(setup, t);
        if (c.t.x() > wall) {
          c.energy += 1e-4;
          c.force.x() *= 0.8;
        }
        return c;
      });
  for (const ConfigurationSummary& c : found) {
    // Down to an eighth of the coarsest cells.
    for (const std::int32_t x : c.check_point) EXPECT_EQ(x % 2, 0);
  }
  TouchToolSpace touch;
  touch.setup = setup;
  touch.configurations = std::move(found);
  std::sort(touch.configurations.begin(), touch.configurations.end());
  const auto interpolator = make_interpolator(Method::energy_hermite, touch);
  std::srand(4);
  for (int n = 0; n < 1000; ++n) {
    Vec3 t = kHalfWidth * Vec3::Random();
    t.x() = wall * (1 + 1e-3 * Vec3::Random().x());
    EXPECT_EQ(interpolator->evaluate(t).support, Support::marked) << t.transpose();
  }
  EXPECT_EQ(interpolator->evaluate(Vec3(-0.5 * kHalfWidth, 1e-3, 2e-3)).support, Support::inside);
}

TEST(AdaptiveGrid, TheOrderOfFindingsDoesNotMatter) {
  const ToolSpaceSetup setup = setup_of(1e-3);
  std::vector<std::map<CheckPoint, CheckPoint>> parents;
  for (const Order order : {Order::deep, Order::wide, Order::random}) {
    AdaptiveGrid grid(setup);
    auto& all = parents.emplace_back();
    for (const auto& c : explore(grid, setup, order, stiffening(setup))) {
      all[c.check_point] = c.parent;
    }
    EXPECT_GT(all.size(), 125U);
  }
  EXPECT_EQ(parents[0], parents[1]);
  EXPECT_EQ(parents[0], parents[2]);
}

TEST(AdaptiveGrid, AnInterruptedRunGoesOnToTheSameSpace) {
  const ToolSpaceSetup setup = setup_of(1e-3);
  AdaptiveGrid whole(setup);
  const auto undisturbed = points(explore(whole, setup, Order::deep, stiffening(setup)));
  for (std::size_t until = 0; until < undisturbed.size(); until += 1 + undisturbed.size() / 7) {
    AdaptiveGrid first(setup);
    AdaptiveGrid second(setup);
    std::set<CheckPoint> all;
    explore(
        first, setup, Order::random,
        [&](const Transition& t) {
          ConfigurationSummary c = Stiffening().at(setup, t);
          c.check_point = t.target;
          second.recall(c);
          all.insert(c.check_point);
          return c;
        },
        until);
    for (const auto& c : explore(second, setup, Order::random, stiffening(setup))) {
      EXPECT_TRUE(all.insert(c.check_point).second) << "found again";
    }
    EXPECT_EQ(all, undisturbed) << until;
  }
}

TEST(AdaptiveGrid, ATighterToleranceKeepsWhatIsThere) {
  const ToolSpaceSetup loose = setup_of(1e-2);
  AdaptiveGrid first(loose);
  const auto found = explore(first, loose, Order::deep, stiffening(loose));
  const ToolSpaceSetup tight = setup_of(1e-3);
  AdaptiveGrid second(tight);
  AdaptiveGrid fresh(tight);
  for (const auto& c : found) second.recall(c);
  auto rest = explore(second, tight, Order::deep, stiffening(tight));
  auto all = points(rest);
  for (const auto& c : found) EXPECT_TRUE(all.insert(c.check_point).second) << "found again";
  EXPECT_EQ(all, points(explore(fresh, tight, Order::deep, stiffening(tight))));
}

TEST(AdaptiveGrid, WhatFailsIsTriedFromThreeCornersAndThenGivenUp) {
  const ToolSpaceSetup setup = setup_of(1e-3);
  std::map<CheckPoint, std::vector<CheckPoint>> starts;
  AdaptiveGrid grid(setup);
  const auto found = explore(grid, setup, Order::random, [&](const Transition& t) {
    ConfigurationSummary c = Stiffening().at(setup, t);
    const bool refined = (t.target[0] | t.target[1] | t.target[2]) % 16 != 0;
    starts[t.target].push_back(t.start);
    if (refined && t.target[0] > 16) c.outcome = Outcome::not_converged;
    return c;
  });
  std::size_t num_hard = 0;
  for (const auto& [target, tried] : starts) {
    const bool refined = (target[0] | target[1] | target[2]) % 16 != 0;
    const bool hard = refined && target[0] > 16;
    num_hard += hard ? 1 : 0;
    EXPECT_LE(tried.size(), 3U);
    EXPECT_EQ(std::set<CheckPoint>(tried.begin(), tried.end()).size(), tried.size());
    EXPECT_TRUE(hard || tried.size() == 1);
  }
  EXPECT_GT(num_hard, 0U);
  EXPECT_EQ(grid.given_up().size(), num_hard);
  EXPECT_GT(found.size(), 125U);
}

}  // namespace
}  // namespace palpate::test::test_adaptive_grid
