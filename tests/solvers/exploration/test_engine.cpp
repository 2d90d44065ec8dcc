// SPDX-License-Identifier: BSD-3-Clause
// The engine on many simulated ranks, with configurations whose cost is given.
#include "exploration/engine.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "exploration/layered_grid.h"
#include "schedule/owner.h"
#include "solvers/exploration/strategy_run.h"
#include "solvers/support/replay.h"
#include "solvers/support/simulation.h"

namespace palpate::test::test_engine {
namespace {

using test::Recording;
using test::Replay;
using test::ReplayOptions;

/// Of times that are sums of slices.
constexpr double kRounding = 1e-9;
/// In which the end is found once the last task is done, s: two waves in vain.
constexpr double kDetection = 2e-3;

/// A grid of which all is found at the first attempt; each takes 5 to 100 ms.
Recording make_recording(std::int32_t resolution, std::uint64_t seed) {
  Recording recording;
  recording.setup.grid.half_width = 0.01;
  recording.setup.grid.resolution = resolution;
  const ToolSpaceSetup& setup = recording.setup;
  LayeredGrid grid(setup.grid);
  std::uint64_t random = mix(seed);
  recording.configurations =
      test::explore(grid, setup, test::Order::deep, [&](const Transition& transition) {
        ConfigurationSummary found = test::good(transition);
        found.t = setup.grid.place(transition.target);
        found.seconds = 0.005 + 0.001 * static_cast<double>(mix(++random) % 96);
        return found;
      });
  // None comes before the one that it was found from, as in what an earlier run has left.
  std::stable_sort(recording.configurations.begin(), recording.configurations.end(),
                   [](const ConfigurationSummary& a, const ConfigurationSummary& b) {
                     return a.t.lpNorm<Eigen::Infinity>() < b.t.lpNorm<Eigen::Infinity>();
                   });
  return recording;
}

std::vector<Recording> make_recordings(std::int32_t resolution = 7) {
  std::vector<Recording> recordings;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    recordings.push_back(make_recording(resolution, seed));
  }
  return recordings;
}

std::vector<int> make_tool_spaces(int number) {
  std::vector<int> recording_of_tool_space;
  for (int i = 0; i < number; ++i) recording_of_tool_space.push_back(i % 5);
  return recording_of_tool_space;
}

double work_of(const Recording& recording) {
  double seconds = 0;
  for (const ConfigurationSummary& c : recording.configurations) seconds += c.seconds;
  return seconds;
}

double work_of(const std::vector<Recording>& recordings, const std::vector<int>& setups) {
  double seconds = 0;
  for (const int recording : setups) seconds += work_of(recordings[recording]);
  return seconds;
}

/// Explores on three ranks, and changes one of their messages.
/// @returns The number of messages; of a run that was refused, of those until then.
template <class Change>
int run_with_damage(const std::vector<Recording>& recordings, int damaged, bool& is_refused,
                    Change&& change) {
  int number = 0;
  ReplayOptions options;
  options.num_known = 20;
  options.damage = [&](Bytes& message) {
    if (number++ == damaged) change(message);
  };
  is_refused = false;
  try {
    (void)test::replay(recordings, {0, 1, 2, 3}, 3, options);
  } catch (const BackendError&) {
    is_refused = true;
  }
  return number;
}

TEST(SimulatedEngine, AMessageThatIsCutOffIsRefused) {
  const std::vector<Recording> recordings = make_recordings(5);
  bool is_refused = false;
  const int messages = run_with_damage(recordings, -1, is_refused, [](Bytes&) {});
  ASSERT_FALSE(is_refused);
  ASSERT_GT(messages, 100);
  for (int damaged = 0; damaged < messages; damaged += 7) {
    (void)run_with_damage(recordings, damaged, is_refused, [](Bytes& m) { m.pop_back(); });
    EXPECT_TRUE(is_refused) << damaged;
  }
}

// What a message says may be wrong and still be possible; anything else is refused.
TEST(SimulatedEngine, ADamagedMessageIsRefusedOrPossible) {
  const std::vector<Recording> recordings = make_recordings(5);
  bool is_refused = false;
  const int messages = run_with_damage(recordings, -1, is_refused, [](Bytes&) {});
  std::uint64_t random = 1;
  int refused = 0;
  for (int i = 0; i < 400; ++i) {
    const auto damaged = static_cast<int>(mix(++random) % static_cast<unsigned>(messages));
    const auto change = [&](Bytes& m) {
      const std::size_t place = mix(++random) % m.size();
      m[place] = static_cast<std::byte>(mix(++random) % 256);
    };
    EXPECT_NO_THROW((void)run_with_damage(recordings, damaged, is_refused, change)) << i;
    refused += is_refused ? 1 : 0;
  }
  EXPECT_GT(refused, 40);
}

TEST(SimulatedEngine, AloneTakesTheTimeOfTheConfigurations) {
  const auto recordings = make_recordings();
  const auto setups = make_tool_spaces(5);
  const Replay alone = test::replay(recordings, setups, 1);
  const double work = work_of(recordings, setups);
  EXPECT_EQ(alone.report.num_solved, 5 * 343);
  EXPECT_EQ(alone.num_factorised_again, 0);
  EXPECT_GE(alone.makespan, work * (1 - kRounding));
  EXPECT_LE(alone.makespan, work + kDetection);
}

TEST(SimulatedEngine, FindsEachConfigurationOnceOnAnyNumberOfRanks) {
  const auto recordings = make_recordings();
  const auto setups = make_tool_spaces(20);
  const double work = work_of(recordings, setups);
  for (const int ranks : {2, 3, 64, 256}) {
    const Replay found = test::replay(recordings, setups, ranks);
    EXPECT_TRUE(found.report.complete);
    EXPECT_EQ(found.report.num_solved, 20 * 343);
    EXPECT_GE(found.makespan, work / ranks * (1 - kRounding));
    EXPECT_EQ(test::replay(recordings, setups, ranks).makespan, found.makespan);
  }
}

TEST(SimulatedEngine, SharesWhatAFixedShareCannot) {
  const auto recordings = make_recordings();
  const auto efficiency = [&](const std::vector<int>& setups, int ranks) {
    return work_of(recordings, setups) / (ranks * test::replay(recordings, setups, ranks).makespan);
  };
  EXPECT_GT(efficiency(make_tool_spaces(1), 16), 0.5);
  EXPECT_GT(efficiency(make_tool_spaces(20), 8), 0.95);
}

TEST(SimulatedEngine, AShareCostsTheStateAndTheFactorOfItsStart) {
  const auto recordings = make_recordings();
  const auto setups = make_tool_spaces(1);
  ReplayOptions options;
  options.factorisation_seconds = 0;
  options.state_bytes = 0;
  const Replay free_of_charge = test::replay(recordings, setups, 8, options);
  EXPECT_GT(free_of_charge.report.num_states_given, 0);
  EXPECT_GE(free_of_charge.num_factorised_again, free_of_charge.report.num_states_given / 2);
  options.factorisation_seconds = 1;
  EXPECT_GT(test::replay(recordings, setups, 8, options).makespan, free_of_charge.makespan + 1);
  options.factorisation_seconds = 0;
  options.state_bytes = 5'000'000'000;  // a second on its way
  EXPECT_GT(test::replay(recordings, setups, 8, options).makespan, free_of_charge.makespan + 1);
}

// What an earlier run has left is told to the owners bit by bit: of a thousand active nodes it
// would be a third of a million messages at once.
TEST(SimulatedEngine, WhatIsKnownIsToldInBoundedMail) {
  const auto recordings = make_recordings();
  const auto setups = make_tool_spaces(200);
  ReplayOptions options;
  options.num_known = SIZE_MAX;
  options.machine.jitter = 20e-3;
  options.schedule.most_unread_bytes = 1 << 20;
  const Replay resumed = test::replay(recordings, setups, 16, options);
  EXPECT_EQ(resumed.report.num_solved, 0);
  EXPECT_EQ(resumed.report.num_reused, 200 * 343);
  // The bound, and the message that exceeds it.
  EXPECT_LE(resumed.most_under_way.bytes, (1 << 20) + (1 << 18));
  EXPECT_LE(resumed.most_under_way.messages, 1000);
}

TEST(SimulatedEngine, GoesOnWithWhatIsLeftOfAnEarlierRun) {
  const auto recordings = make_recordings();
  const auto setups = make_tool_spaces(20);
  ReplayOptions options;
  options.num_known = 200;
  for (const int ranks : {1, 3, 16}) {
    const Replay resumed = test::replay(recordings, setups, ranks, options);
    EXPECT_EQ(resumed.report.num_reused, 20 * 200);
    EXPECT_EQ(resumed.report.num_solved, 20 * 143);
  }
}

TEST(SimulatedEngine, FindsTheSameWhoeverSteersIt) {
  const auto recordings = make_recordings();
  const auto setups = make_tool_spaces(5);
  ReplayOptions options;
  options.machine.jitter = 20e-3;
  // Every tenth task of a rank, to another place of another tool space.
  options.steer = [&](int rank, int task) -> std::optional<Steering> {
    if (task % 10 != 0) return std::nullopt;
    const double angle = task + rank;
    const Vec3 goal = 0.01 * Vec3(std::sin(angle), std::cos(angle), std::sin(2 * angle));
    return Steering{{{{(task / 10) % 5}, {goal}, {}}}};
  };
  for (const int ranks : {1, 2, 3, 64}) {
    const Replay found = test::replay(recordings, setups, ranks, options);
    EXPECT_TRUE(found.report.complete);
    EXPECT_EQ(found.report.num_solved, 5 * 343);
  }
}

TEST(SimulatedEngine, LeavesOutWhatIsWithdrawnUntilItIsAskedForAgain) {
  const auto recordings = make_recordings();
  const auto setups = make_tool_spaces(5);
  const Steering without_half{{{{2}, {}, {{{1, -3, -3}, {3, 3, 3}}}}}};
  ReplayOptions options;
  options.machine.jitter = 20e-3;
  for (const int ranks : {1, 2, 3, 64}) {
    // The first rank that works at all.
    bool has_steered = false;
    options.steer = [&](int /*rank*/, int task) -> std::optional<Steering> {
      if (task > 1 || std::exchange(has_steered, true)) return std::nullopt;
      return without_half;
    };
    const Replay part = test::replay(recordings, setups, ranks, options);
    // A rank that has not heard yet may make some.
    EXPECT_GE(part.report.num_solved, 4 * 343 + 4 * 49);
    EXPECT_LT(part.report.num_solved, 4 * 343 + (ranks == 1 ? 4 * 49 + 1 : 343));
    has_steered = false;
    bool asks_again = false;
    options.steer = [&](int /*rank*/, int task) -> std::optional<Steering> {
      if (task == 1 && !std::exchange(has_steered, true)) return without_half;
      if (task == 20 && !std::exchange(asks_again, true)) return Steering();
      return std::nullopt;
    };
    if (ranks > 16) continue;  // there a rank has fewer tasks
    const Replay whole = test::replay(recordings, setups, ranks, options);
    EXPECT_EQ(whole.report.num_solved, 5 * 343);
  }
}

/// A body that is in another equilibrium after each transition.
class EndlessSolver final : public StateSolver {
 public:
  [[nodiscard]] Equilibrium begin(const ToolSpaceSetup& /*setup*/, const Eigen::VectorXd& t,
                                  Tangent /*tangent*/) override {
    return found(t);
  }
  [[nodiscard]] Equilibrium solve(const ToolSpaceSetup& /*setup*/, const Eigen::VectorXd& t,
                                  const Equilibrium& /*start*/, Tangent /*tangent*/) override {
    return found(t);
  }
  void forget(const ToolSpaceSetup& /*setup*/, const Equilibrium& /*state*/) override {}

 private:
  Equilibrium found(const Vec3& t) {
    Equilibrium e;
    e.t = t;
    e.reaction = Vec3(++num_found_, 0, 0);
    e.stiffness = Mat3::Identity();
    e.outcome = Outcome::converged;
    return e;
  }
  int num_found_ = 0;
};

/// What transitions an earlier run has left; keeps those of this one.
class TransitionRecord final : public Record {
 public:
  [[nodiscard]] Known known(ToolSpaceKey /*tool_space*/) const override { return left; }
  [[nodiscard]] std::vector<std::string> damaged() const override { return {}; }
  void keep(ToolSpaceKey, const Configuration&, const std::vector<IntermediateState>&) override {}
  void keep(ToolSpaceKey, const LevelTransition& transition) override {
    kept.push_back(transition);
  }
  void settle(ToolSpaceKey, const ConfigurationSummary&, std::int32_t) override {}
  [[nodiscard]] Configuration load(ToolSpaceKey,
                                   const ConfigurationSummary& summary) const override {
    return {summary, {}, {}, {}, {}};
  }
  [[nodiscard]] TouchSpace publish(double) override { return {}; }
  void resume() override {}
  [[nodiscard]] bool has_moved() const override { return false; }
  [[nodiscard]] TouchSpace finish(bool, double) override { return {}; }

  Known left;
  std::vector<LevelTransition> kept;
};

TEST(Engine, SaysHowOftenACheckPointHadTooManyLevels) {
  ToolSpaceSetup setup;
  setup.grid.half_width = 0.01;
  setup.grid.resolution = 3;
  setup.policy.history = History::levels;
  TransitionRecord record;
  // Of an earlier run: it counts, but no transition between these levels is asked for.
  record.left.transitions = {{{0, 0, 0}, kMostLevels, {1, 0, 0}, beyond_most_levels}};
  EndlessSolver solver;
  test::Simulation simulation(1, {});
  Monitor monitor(nullptr, simulation.network(0));
  PrecomputeReport report;
  const std::vector<PlannedSpace> spaces{{setup, make_grid_plan(setup)}};
  Engine engine(spaces, solver, record, simulation.network(0), monitor, report);
  ASSERT_TRUE(simulation.run({&engine}));
  EXPECT_EQ(report.num_levels, 27 * (kMostLevels - 1));
  const auto num_beyond = std::count_if(
      record.kept.begin(), record.kept.end(),
      [](const LevelTransition& transition) { return transition.reached == beyond_most_levels; });
  EXPECT_GT(num_beyond, 0);
  EXPECT_EQ(report.num_beyond_most_levels, num_beyond + 1);
}

}  // namespace
}  // namespace palpate::test::test_engine
