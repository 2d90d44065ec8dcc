// SPDX-License-Identifier: BSD-3-Clause
// The exploration of a rigid tool's space where a hand is going.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <vector>

#include "exploration/contact_shell.h"
#include "following/follow_tool.h"
#include "following/following_simulation.h"
#include "following/known_cells.h"
#include "interaction/interaction_spec.h"
#include "solvers/support/block.h"

namespace palpate::test::test_follow_tool {
namespace {

constexpr double kSpacing = 0.008;
constexpr double kNever = std::numeric_limits<double>::infinity();

bool operator==(const Transition& a, const Transition& b) {
  return a.target == b.target && a.start == b.start;
}

/// The space of a ball on a block.
class FollowToolTest : public testing::Test {
 protected:
  FollowToolTest() {
    block_ = make_block(Law::neo_hookean, {ElementOrder::quadratic});
    RigidTool tool;
    tool.radius = 0.015;
    setup_.id = kContactToolSpace;
    setup_.interaction = rigid_contact_spec(with_defaults(tool, block_.scene));
    InteractionFactory tools(block_.scene.body, {});
    clearance_ = tools.clearance(setup_.interaction);
    setup_.grid = make_shell_grid(clearance_->bounds(), kSpacing);
    shell_.depth = 0.006;
    begin();
  }

  /// Begins anew.
  void begin() {
    strategy_ =
        std::make_unique<FollowTool>(setup_, clearance_, block_.scene.body.touchable, shell_);
    cells_ =
        std::make_unique<ShellCells>(*clearance_, setup_.grid, block_.scene.body.touchable, shell_);
  }

  [[nodiscard]] FollowingSimulation simulate(int solvers) {
    FollowingOptions options;
    options.solvers = solvers;
    return {*strategy_, *cells_, options,
            [this](const Transition& transition, ConfigurationSummary& found) {
              ++num_made_[transition.target];
              solve(transition, found);
            }};
  }
  /// A force by the depth of the tool.
  void solve(const Transition& transition, ConfigurationSummary& found) const {
    if (fails_ && fails_(transition)) {
      found.outcome = Outcome::not_converged;
      return;
    }
    found.t = setup_.grid.place(transition.target);
    const auto approach = clearance_->approach(found.t);
    const double depth = std::max(approach.depth, 0.0);
    found.force = -1000 * depth * approach.out;
    found.energy = 500 * depth * depth;
    found.stiffness = 1000 * approach.out * approach.out.transpose();
    if (depth == 0) found.flags |= flags::touches_nothing;
  }

  /// A place in the middle of the top of the block, pressed by a depth, m.
  [[nodiscard]] Vec3 pressed(double depth, const Vec3& aside = Vec3::Zero()) const {
    const Eigen::AlignedBox3d box = clearance_->body_bounds();
    // Not at the border of two cells.
    Vec3 top = box.center() + aside + Vec3(0.0023, 0.0031, 0);
    top.z() = box.max().z();
    return clearance_->pressed(top, Vec3::UnitZ(), depth);
  }
  [[nodiscard]] FollowingSimulation::Hand resting(double depth) const {
    return [place = pressed(depth)](double) { return HandMotion{place, Vec3::Zero()}; };
  }
  /// To and fro along the block.
  [[nodiscard]] FollowingSimulation::Hand sliding(double speed) const {
    const double half = 0.03;
    return [this, speed, half](double time) {
      const double way = std::fmod(speed * time, 4 * half);
      const double x = way < 2 * half ? way - half : 3 * half - way;
      const Vec3 velocity((way < 2 * half ? speed : -speed), 0, 0);
      return HandMotion{pressed(0.003, Vec3(x, 0, 0)), velocity};
    };
  }

  Block block_;
  ToolSpaceSetup setup_;
  std::shared_ptr<const ToolClearance> clearance_;
  ShellOptions shell_;
  std::unique_ptr<FollowTool> strategy_;
  std::unique_ptr<ShellCells> cells_;
  std::function<bool(const Transition&)> fails_;
  std::map<CheckPoint, int> num_made_;
};

TEST_F(FollowToolTest, TheCellOfAHandAtRestComesFirst) {
  FollowingSimulation simulation = simulate(1);
  simulation.run(resting(0.003), 1);
  const Cell cell = cells_->root(cells_->numbers_of(pressed(0.003)));
  const auto& begun = simulation.result().begun;
  std::set<CheckPoint> missing;
  for (int corner = 0; corner < 8; ++corner) missing.insert(corner_of(cell, corner));
  std::size_t number = 0;
  while (!missing.empty() && number < begun.size()) missing.erase(begun[number++].target);
  // Besides its corners, at most the starts from which they are reached.
  EXPECT_LE(number, 12u);
  EXPECT_GT(simulation.counts().share(), 0.4);
}

TEST_F(FollowToolTest, EachIsMadeOnceAndInTheEndAllOfTheShellIs) {
  FollowingSimulation simulation = simulate(3);
  ASSERT_TRUE(simulation.run_to_end(resting(0.003), 1000));
  std::set<CheckPoint> asked;
  for (const StartGraph::Target& target : shell_targets(
           *clearance_, setup_.grid, block_.scene.body.touchable, shell_,
           list_shell_cells(*clearance_, setup_.grid, block_.scene.body.touchable, shell_))) {
    asked.insert(target.check_point);
  }
  std::set<CheckPoint> made;
  for (const auto& [p, number] : num_made_) {
    made.insert(p);
    EXPECT_EQ(number, 1);
  }
  EXPECT_GT(asked.size(), 100u);
  EXPECT_EQ(made, asked);
}

TEST_F(FollowToolTest, TheSameMotionGivesTheSameTransitions) {
  FollowingSimulation first = simulate(2);
  first.run(sliding(0.1), 4);
  begin();
  FollowingSimulation second = simulate(2);
  second.run(sliding(0.1), 4);
  EXPECT_GT(first.result().begun.size(), 50u);
  EXPECT_EQ(first.result().times, second.result().times);
  EXPECT_TRUE(std::equal(first.result().begun.begin(), first.result().begun.end(),
                         second.result().begun.begin(), second.result().begun.end(),
                         [](const auto& a, const auto& b) { return a == b; }));
}

TEST_F(FollowToolTest, MoreSolversFollowAFasterHand) {
  const auto share = [&](int solvers, double speed) {
    begin();
    FollowingSimulation simulation = simulate(solvers);
    simulation.run(sliding(speed), 3);
    return simulation.counts().share();
  };
  EXPECT_GT(share(4, 0.02), 0.9);
  EXPECT_GT(share(8, 0.1), share(1, 0.1));
  EXPECT_GT(share(1, 0.02), share(1, 0.2));
}

TEST_F(FollowToolTest, AfterAReversalNothingIsBegunWhereTheHandCameFrom) {
  FollowingSimulation simulation = simulate(1);
  const double speed = 0.1;
  const auto away = [&](double time) {
    return HandMotion{pressed(0.003, Vec3(speed * time, 0, 0)), Vec3(speed, 0, 0)};
  };
  simulation.run(away, 0.2);
  const std::size_t before = simulation.result().begun.size();
  const HandMotion there{pressed(0.003), Vec3(-speed, 0, 0)};
  simulation.run([&](double) { return there; }, 0.3);
  const HandPrediction prediction(there);
  const auto& begun = simulation.result().begun;
  ASSERT_GT(begun.size(), before + 2);
  for (std::size_t i = before + 1; i < begun.size(); ++i) {
    // A corner of a cell that may be needed, or the start of one, is within two cells.
    const Vec3 place = setup_.grid.place(begun[i].target);
    const Vec3 aside = Vec3::Constant(2 * kSpacing);
    EXPECT_LT(prediction.time_until({Vec3(place - aside), Vec3(place + aside)}), kNever);
  }
}

TEST_F(FollowToolTest, WhatFailsIsTriedFromOtherStartsAndGivenUp) {
  const CheckPoint bad = corner_of(cells_->root(cells_->numbers_of(pressed(0.003))), 0);
  ASSERT_FALSE(cells_->node(bad).is_free);
  fails_ = [bad](const Transition& transition) { return transition.target == bad; };
  FollowingSimulation simulation = simulate(2);
  simulation.run(resting(0.003), 3);
  EXPECT_GE(num_made_[bad], 2);
  EXPECT_LE(num_made_[bad], 1 + static_cast<int>(kMostStarts));
  std::set<CheckPoint> starts;
  for (const Transition& transition : simulation.result().begun) {
    if (transition.target == bad) {
      EXPECT_TRUE(starts.insert(transition.start).second);
    } else {
      EXPECT_NE(transition.start, bad);
    }
  }
  EXPECT_EQ(strategy_->coverage().known, strategy_->coverage().needed);
}

TEST_F(FollowToolTest, WhatALostSolverWasMakingIsMadeAgain) {
  strategy_->follow(HandPrediction({pressed(0.003), Vec3::Zero()}));
  const std::optional<Transition> first = strategy_->next();
  ASSERT_TRUE(first);
  const std::optional<Transition> second = strategy_->next();
  ASSERT_TRUE(second);
  EXPECT_NE(second->target, first->target);
  strategy_->lose(*first);
  const std::optional<Transition> again = strategy_->next();
  ASSERT_TRUE(again);
  EXPECT_EQ(again->target, first->target);
}

TEST_F(FollowToolTest, WhatAnEarlierRunHasFoundIsNotMade) {
  FollowingSimulation first = simulate(4);
  first.run(resting(0.003), 2);
  std::vector<ConfigurationSummary> found;
  for (const auto& [p, number] : num_made_) {
    ConfigurationSummary& c = found.emplace_back();
    c.check_point = p;
    c.outcome = Outcome::converged;
    solve({p, p}, c);
  }
  num_made_.clear();
  begin();
  for (const ConfigurationSummary& c : found) strategy_->recall(c);
  FollowingSimulation second = simulate(4);
  second.run(resting(0.003), 2);
  for (const ConfigurationSummary& c : found) EXPECT_EQ(num_made_.count(c.check_point), 0u);
  EXPECT_GT(num_made_.size(), 0u);
}

TEST_F(FollowToolTest, AHandAtRestGetsFinerCellsAndAFastOneDoesNot) {
  setup_.policy.tolerance = 0.01;
  setup_.policy.tolerance_is_relative = true;
  begin();
  const auto num_fine = [&](const FollowingSimulation& simulation) {
    const auto& begun = simulation.result().begun;
    return std::count_if(begun.begin(), begun.end(), [&](const Transition& transition) {
      return cells_->around(transition.target).empty();
    });
  };
  FollowingSimulation fast = simulate(1);
  fast.run(sliding(0.2), 0.6);
  EXPECT_EQ(num_fine(fast), 0);
  begin();
  FollowingSimulation slow = simulate(2);
  slow.run(resting(0.003), 10);
  EXPECT_GT(num_fine(slow), 20);
  // All coarse cells that the hand may need were there before.
  const auto& begun = slow.result().begun;
  const auto first_fine = std::find_if(begun.begin(), begun.end(), [&](const Transition& t) {
    return cells_->around(t.target).empty();
  });
  std::set<CheckPoint> needed;
  for (int corner = 0; corner < 8; ++corner) {
    needed.insert(corner_of(cells_->root(cells_->numbers_of(pressed(0.003))), corner));
  }
  for (auto t = begun.begin(); t != first_fine; ++t) needed.erase(t->target);
  EXPECT_TRUE(needed.empty());
}

TEST_F(FollowToolTest, TicksInKnownCellsAndWaitsAreCounted) {
  const Vec3 here = pressed(0.003);
  const Vec3 beside = pressed(0.003, Vec3(0.016, 0, 0));
  const Vec3 nowhere = here + Vec3(0, 0, 1);
  KnownCells known(*cells_);
  const Cell cell = cells_->root(cells_->numbers_of(here));
  for (int corner = 0; corner < 7; ++corner) known.add(corner_of(cell, corner));
  for (int i = 0; i < 3; ++i) known.tick(here, 0.001);  // a corner is missing
  known.add(corner_of(cell, 7));
  for (int i = 0; i < 5; ++i) known.tick(here, 0.001);
  known.tick(beside, 0.001);
  for (int i = 0; i < 10; ++i) known.tick(nowhere, 0.001);  // does not count
  known.tick(beside, 0.001);
  known.tick(beside, 0.001);
  EXPECT_EQ(known.counts().in_shell, 11);
  EXPECT_EQ(known.counts().in_known, 5);
  EXPECT_DOUBLE_EQ(known.counts().share(), 5.0 / 11);
  ASSERT_EQ(known.counts().waits.size(), 3U);
  EXPECT_DOUBLE_EQ(known.counts().wait(0), 0.001);
  EXPECT_DOUBLE_EQ(known.counts().wait(0.5), 0.002);
  EXPECT_DOUBLE_EQ(known.counts().wait(1), 0.003);
  // What is known stays known, and a wait that goes on is one of what is counted then.
  known.reset();
  known.tick(beside, 0.001);
  known.tick(here, 0.001);
  EXPECT_EQ(known.counts().in_known, 1);
  EXPECT_EQ(known.counts().waits.size(), 1U);
}

}  // namespace
}  // namespace palpate::test::test_follow_tool
