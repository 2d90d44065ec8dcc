// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/levelled_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "solvers/exploration/strategy_run.h"
#include "solvers/support/bistable.h"

namespace palpate::test::test_levelled_grid {
namespace {

using test::Bistable;
using test::Order;

using State = std::pair<CheckPoint, std::int32_t>;

/// Answers the transitions of a bistable body, and remembers what a record would.
class Body {
 public:
  Body(const Bistable& body, const ToolSpaceSetup& setup) : body_(body), setup_(setup) {}

  ConfigurationSummary solve(const Transition& transition) {
    ++num_solved_;
    const Vec3 t = place(transition.target);
    double w = body_.wells(t).back();
    ConfigurationSummary found = body_.at(t, w);
    if (!transition.needs_no_start()) {
      const double from = states_.at({transition.start, transition.start_level});
      w = body_.move(place(transition.start), from, t);
      found = body_.at(t, w);
      // Jumps are noticed as a solver does: a small step would have stayed nearer.
      if (w * from < 0 && std::abs(w - from) > 0.5) found.flags |= flags::near_fold;
      if (fails_ && (found.flags & flags::near_fold) != 0) found.outcome = Outcome::not_converged;
    }
    const std::int32_t level =
        transition.finds_candidate
            ? candidate_level(transition.start, transition.start_level, transition.target)
            : 0;
    if (found.usable()) states_[{transition.target, level}] = w;
    return found;
  }

  /// Those without a way that jumps.
  void fail_at_jumps() { fails_ = true; }
  /// After each next() of a strategy, as the engine does.
  void settle(LevelledGrid& grid) {
    for (const Settlement& s : grid.settled()) {
      settlements_.push_back(s);
      if (!s.has_candidate) continue;
      const LevelTransition& t = s.transition;
      const State candidate{t.target, candidate_level(t.start, t.start_level, t.target)};
      const double w = states_.at(candidate);
      states_.erase(candidate);
      if (s.is_new) states_[{t.target, t.reached}] = w;
    }
  }

  [[nodiscard]] Vec3 place(const CheckPoint& p) const {
    return setup_.grid.spacing() * Vec3(p[0], p[1], p[2]);
  }
  [[nodiscard]] const std::map<State, double>& states() const { return states_; }
  [[nodiscard]] const std::vector<Settlement>& settlements() const { return settlements_; }
  [[nodiscard]] int num_solved() const { return num_solved_; }

 private:
  Bistable body_;
  ToolSpaceSetup setup_;
  bool fails_ = false;
  std::map<State, double> states_;
  std::vector<Settlement> settlements_;
  int num_solved_ = 0;
};

ToolSpaceSetup make_setup(std::int32_t resolution = 9, double half_width = 1.5) {
  ToolSpaceSetup setup;
  setup.grid.resolution = resolution;
  setup.grid.half_width = half_width;
  setup.policy.history = History::automatic;
  return setup;
}

/// Of the tool space above and the body as it comes: in two layers of the grid.
constexpr int kNumDouble = 2 * 9 * 9;

/// A strategy that has its settlements told to the body before anything starts from them.
class Told final : public ExplorationStrategy {
 public:
  Told(LevelledGrid& grid, Body& body) : grid_(grid), body_(body) {}
  void recall(const ConfigurationSummary& found) override { grid_.recall(found); }
  void accept(const ConfigurationSummary& found) override { grid_.accept(found); }
  std::vector<Transition> next() override {
    std::vector<Transition> due = grid_.next();
    body_.settle(grid_);
    return due;
  }
  std::vector<CheckPoint> given_up() override { return grid_.given_up(); }
  [[nodiscard]] std::int64_t num_expected() const override { return grid_.num_expected(); }

 private:
  LevelledGrid& grid_;
  Body& body_;
};

std::vector<ConfigurationSummary> explore(LevelledGrid& grid, Body& body,
                                          const ToolSpaceSetup& setup, Order order,
                                          std::size_t until = SIZE_MAX) {
  Told told(grid, body);
  return test::explore(
      told, setup, order, [&](const Transition& t) { return body.solve(t); }, until);
}

auto all_of(const Settlement& s) {
  const LevelTransition& t = s.transition;
  return std::tuple(t.start, t.start_level, t.target, t.reached, s.is_new, s.has_candidate);
}

class LevelledGridInOrder : public testing::TestWithParam<Order> {};

TEST_P(LevelledGridInOrder, FindsBothWellsWhereverThereAreTwo) {
  const ToolSpaceSetup setup = make_setup();
  const Bistable bistable;
  Body body(bistable, setup);
  LevelledGrid grid(setup);
  explore(grid, body, setup, GetParam());
  std::map<CheckPoint, std::vector<double>> found;
  for (const auto& [state, w] : body.states()) found[state.first].push_back(w);
  int num_double = 0;
  for (auto& [p, of_levels] : found) {
    std::sort(of_levels.begin(), of_levels.end());
    const std::vector<double> wells = bistable.wells(body.place(p));
    ASSERT_EQ(of_levels.size(), wells.size()) << p[0] << ' ' << p[1] << ' ' << p[2];
    for (std::size_t i = 0; i < wells.size(); ++i) EXPECT_NEAR(of_levels[i], wells[i], 1e-12);
    if (wells.size() == 2) ++num_double;
  }
  EXPECT_EQ(num_double, kNumDouble);
  EXPECT_EQ(grid.num_expected(), 9 * 9 * 9 + num_double);
}

TEST_P(LevelledGridInOrder, TellsTheSameLevelsApartInEveryOrder) {
  const ToolSpaceSetup setup = make_setup(5, 1);
  Body deep({}, setup);
  LevelledGrid first(setup);
  explore(first, deep, setup, Order::deep);
  Body body({}, setup);
  LevelledGrid grid(setup);
  explore(grid, body, setup, GetParam());
  EXPECT_EQ(body.states(), deep.states());
  ASSERT_EQ(body.settlements().size(), deep.settlements().size());
  for (std::size_t i = 0; i < body.settlements().size(); ++i) {
    EXPECT_EQ(all_of(body.settlements()[i]), all_of(deep.settlements()[i]));
  }
}

INSTANTIATE_TEST_SUITE_P(Orders, LevelledGridInOrder,
                         testing::Values(Order::deep, Order::wide, Order::random),
                         [](const auto& order) { return to_string(order.param); });

TEST(LevelledGrid, ASmoothBodyTakesNoTransitionMore) {
  const ToolSpaceSetup setup = make_setup();
  Bistable smooth;
  smooth.a0 = -1;
  Body body(smooth, setup);
  LevelledGrid grid(setup);
  explore(grid, body, setup, Order::deep);
  EXPECT_EQ(body.num_solved(), 9 * 9 * 9);
  EXPECT_TRUE(body.settlements().empty());
}

TEST(LevelledGrid, WithLevelsAsksForEveryTransitionOnce) {
  ToolSpaceSetup setup = make_setup(5);
  setup.policy.history = History::levels;
  Bistable smooth;
  smooth.a0 = -1;
  Body body(smooth, setup);
  LevelledGrid grid(setup);
  explore(grid, body, setup, Order::deep);
  // Pairs of neighbours in both directions, without the ways of the flat space.
  const int pairs = 13 * 13 * 13 - 5 * 5 * 5;
  EXPECT_EQ(body.settlements().size(), static_cast<std::size_t>(pairs - (5 * 5 * 5 - 1)));
  EXPECT_TRUE(std::none_of(body.settlements().begin(), body.settlements().end(),
                           [](const Settlement& s) { return s.is_new; }));
}

// The far side of the fold is not found, and that is a sign as well; so is an edge whose energy
// does not fit.
TEST(LevelledGrid, AJumpThatFailsIsTriedFromAllSides) {
  const ToolSpaceSetup setup = make_setup();
  Body body({}, setup);
  body.fail_at_jumps();
  LevelledGrid grid(setup);
  explore(grid, body, setup, Order::deep);
  EXPECT_FALSE(body.settlements().empty());
  for (const Settlement& s : body.settlements()) {
    EXPECT_TRUE(s.transition.reached == failed_to_reach || s.transition.reached == 0);
  }
}

TEST(LevelledGrid, AnEdgeWhoseEnergyDoesNotFitIsASign) {
  const ToolSpaceSetup setup = make_setup();
  const Bistable bistable;
  LevelledGrid grid(setup);
  Body body(bistable, setup);
  Told told(grid, body);
  // No flag tells of the jump.
  test::explore(told, setup, Order::deep, [&](const Transition& t) {
    ConfigurationSummary found = body.solve(t);
    found.flags = 0;
    return found;
  });
  const auto& settlements = body.settlements();
  EXPECT_EQ(std::count_if(settlements.begin(), settlements.end(),
                          [](const Settlement& s) { return s.is_new; }),
            kNumDouble);
}

// Nor does any lead to an inverted one.
TEST(LevelledGrid, NothingStartsFromInvertedUnstableOrForbiddenStates) {
  for (Flags flag : {flags::inverted, flags::unstable, flags::beyond_force_limit}) {
    const ToolSpaceSetup setup = make_setup(7);
    LevelledGrid grid(setup);
    Body body({}, setup);
    Told told(grid, body);
    test::explore(told, setup, Order::deep, [&](const Transition& t) {
      ConfigurationSummary found = body.solve(t);
      if (t.target[2] < 0) found.flags |= flag;
      return found;
    });
    for (const Settlement& s : body.settlements()) {
      EXPECT_GE(s.transition.start[2], 0) << flag;
      EXPECT_TRUE(flag != flags::inverted || s.transition.target[2] >= 0);
    }
  }
}

/// A strategy whose settlements are kept.
class Settled final : public ExplorationStrategy {
 public:
  explicit Settled(LevelledGrid& grid) : grid_(grid) {}
  void recall(const ConfigurationSummary& found) override { grid_.recall(found); }
  void accept(const ConfigurationSummary& found) override { grid_.accept(found); }
  std::vector<Transition> next() override {
    std::vector<Transition> due = grid_.next();
    for (const Settlement& s : grid_.settled()) settlements.push_back(s);
    return due;
  }
  std::vector<CheckPoint> given_up() override { return grid_.given_up(); }
  [[nodiscard]] std::int64_t num_expected() const override { return grid_.num_expected(); }

  std::vector<Settlement> settlements;

 private:
  LevelledGrid& grid_;
};

// Of a body that is in another equilibrium after each transition the exploration ends too.
TEST(LevelledGrid, ACheckPointHasSoManyLevelsAndNoMore) {
  ToolSpaceSetup setup = make_setup(3, 1);
  setup.policy.history = History::levels;
  LevelledGrid grid(setup);
  Settled settled(grid);
  const int pairs = 7 * 7 * 7 - 3 * 3 * 3;
  const std::size_t all = pairs * kMostLevels + 1;
  double force = 0;
  const auto heard = test::explore(
      settled, setup, Order::deep,
      [&](const Transition& transition) {
        ConfigurationSummary found = test::good(transition);
        const auto& [i, j, k] = transition.target;
        found.t = setup.grid.spacing() * Vec3(i, j, k);
        found.force.x() = ++force;
        return found;
      },
      2 * all);
  EXPECT_LE(heard.size(), all);
  std::int32_t highest = 0;
  int num_beyond = 0;
  for (const Settlement& s : settled.settlements) {
    highest = std::max(highest, s.transition.reached);
    if (s.transition.reached != beyond_most_levels) continue;
    ++num_beyond;
    EXPECT_FALSE(s.is_new);
    EXPECT_TRUE(s.has_candidate);  // which is removed
  }
  EXPECT_EQ(highest, kMostLevels - 1);
  EXPECT_GT(num_beyond, 0);
  EXPECT_EQ(grid.num_expected(), 27 * kMostLevels);
}

// Killed after any number of configurations, and taken up again: nothing is made twice, and the
// levels are those of the run that was not.
TEST(LevelledGrid, GoesOnFromWhatWasFound) {
  const ToolSpaceSetup setup = make_setup(5, 1);
  Body undisturbed({}, setup);
  LevelledGrid whole(setup);
  const std::size_t num_all = explore(whole, undisturbed, setup, Order::deep).size();
  for (const std::size_t until : {num_all / 3, num_all / 2, 2 * num_all / 3, num_all - 1}) {
    SCOPED_TRACE(until);
    Body body({}, setup);
    LevelledGrid killed(setup);
    const auto heard = explore(killed, body, setup, Order::random, until);
    const std::vector<Settlement> settled = body.settlements();
    const int num_solved = body.num_solved();

    LevelledGrid resumed(setup);
    // As a record has them: candidates have their level, or are gone, once they are settled.
    std::map<State, ConfigurationSummary> kept;
    for (const ConfigurationSummary& c : heard) kept[{c.check_point, c.level}] = c;
    for (const Settlement& s : settled) {
      const LevelTransition& t = s.transition;
      resumed.recall(t);
      if (!s.has_candidate) continue;
      auto candidate = kept.extract({t.target, candidate_level(t.start, t.start_level, t.target)});
      if (!s.is_new) continue;
      candidate.mapped().level = t.reached;
      kept[{t.target, t.reached}] = candidate.mapped();
    }
    for (const auto& [state, c] : kept) {
      resumed.recall(c);
    }
    const auto more = explore(resumed, body, setup, Order::random);
    EXPECT_EQ(body.states(), undisturbed.states());
    // The killed run had solved some of which nobody had heard.
    EXPECT_EQ(heard.size() + more.size(), num_all);
    EXPECT_GE(body.num_solved(), num_solved);
  }
}

}  // namespace
}  // namespace palpate::test::test_levelled_grid
