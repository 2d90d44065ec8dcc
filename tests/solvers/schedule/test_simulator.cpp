// SPDX-License-Identifier: BSD-3-Clause
// The scheduler on many simulated ranks, and the simulator itself against what can be counted by
// hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <numeric>
#include <set>

#include "base/error.h"
#include "schedule/simulator.h"
#include "solvers/schedule/random_graph.h"

namespace palpate {
namespace {

using test::GraphWorker;
using test::Key;
using test::RandomGraph;
using test::TranspositionTable;

/// Messages take no time.
Machine ideal() {
  Machine machine;
  machine.latency = 0;
  machine.bandwidth = 1e300;
  machine.overhead = 0;
  machine.reaction = 0;
  return machine;
}

/// Some messages come later than many others that were sent after them, every third time so late
/// that a run may seem to be over.
Machine jittery(std::uint64_t seed) {
  Machine machine;
  machine.jitter = seed % 3 == 0 ? 1 : 20e-3;
  machine.seed = seed;
  return machine;
}

/// Of which some are so tight that ranks wait for each other to read.
ScheduleOptions options_of(std::uint64_t seed) {
  ScheduleOptions options;
  if (seed % 2 == 0) options.most_unread_bytes = 500;
  return options;
}

/// Workers of a graph whose tasks take up to 5 ms; all roots are posted by one rank.
class GraphRun {
 public:
  GraphRun(Simulation& simulation, const RandomGraph& graph, int rank_of_roots)
      : simulation_(simulation), graph_(graph) {
    for (int r = 0; r < simulation.size(); ++r) {
      workers.push_back(std::make_unique<GraphWorker>(
          graph, r == rank_of_roots ? graph.roots() : std::vector<Key>()));
      workers.back()->during = [this, r](Key key, Mail&) {
        simulation_.spend(r, 5e-3 * graph_.cost(key));
      };
    }
  }

  bool run(const ScheduleOptions& options = {}) {
    std::vector<Worker*> addresses;
    for (const auto& worker : workers) addresses.push_back(worker.get());
    return simulation_.run(addresses, options);
  }

  [[nodiscard]] std::vector<Key> executed() const {
    std::vector<Key> all;
    for (const auto& worker : workers) {
      all.insert(all.end(), worker->executed.begin(), worker->executed.end());
    }
    std::sort(all.begin(), all.end());
    return all;
  }

  std::vector<std::unique_ptr<GraphWorker>> workers;

 private:
  Simulation& simulation_;
  const RandomGraph& graph_;
};

std::vector<Key> reachable(const RandomGraph& graph) {
  const std::set<Key> keys = graph.reachable();
  return {keys.begin(), keys.end()};
}

class OnSimulatedRanks : public testing::TestWithParam<int> {};

TEST_P(OnSimulatedRanks, ExecutesARandomGraphOnce) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    RandomGraph graph;
    graph.seed = seed;
    Simulation simulation(GetParam(), jittery(seed));
    GraphRun graph_run(simulation, graph, static_cast<int>(seed) % GetParam());
    ASSERT_TRUE(graph_run.run(options_of(seed)));
    ASSERT_EQ(graph_run.executed(), reachable(graph)) << "seed " << seed;
    ASSERT_EQ(simulation.num_under_way(), 0);
  }
}

/// Messages that wander from rank to rank while hardly any rank is busy, the hard case of finding
/// the end. One of length n > 0 is followed by two of n − 1 together, here or by way of a task,
/// one of length 0 by none: so n leads to 2n + 1 messages.
class Wanderers final : public Worker {
 public:
  Wanderers(Simulation& simulation, std::uint64_t seed, std::vector<int> first)
      : simulation_(simulation), random_(mix(seed)), tasks_(std::move(first)) {}

  void receive(int /*from*/, const Bytes& message, Mail& mail) override {
    ++num_received;
    const auto length = static_cast<int>(message.size());
    if (length == 0) return;
    mix(++random_) % 4 == 0 ? tasks_.push_back(length) : send_on(length, mail);
  }
  [[nodiscard]] bool has_work() const override { return !tasks_.empty(); }
  void work(Mail& mail) override {
    const int length = tasks_.back();
    tasks_.pop_back();
    simulation_.spend(mail.rank(), 2e-3);
    send_on(length, mail);
  }
  [[nodiscard]] Bytes give() override {
    if (tasks_.size() < 2) return {};
    Bytes share(static_cast<std::size_t>(tasks_.back()));
    tasks_.pop_back();
    return share;
  }
  void take(const Bytes& share, Mail&) override {
    tasks_.push_back(static_cast<int>(share.size()));
  }
  void discard() override { tasks_.clear(); }

  int num_received = 0;

 private:
  void send_on(int length, Mail& mail) {
    const auto left = static_cast<std::uint64_t>(length - 1);
    const std::uint64_t part = mix(++random_) % 4 == 0 ? mix(++random_) % (left + 1) : 0;
    for (const std::uint64_t next : {part, left - part}) mail.send_home(++random_, Bytes(next));
  }

  Simulation& simulation_;
  std::uint64_t random_;
  std::vector<int> tasks_;
};

TEST_P(OnSimulatedRanks, TheEndIsNotFoundWhileMessagesWander) {
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    // A few long ones, or tasks that are shared out and done before others have heard of it.
    const std::vector<int> first = seed % 5 == 0
                                       ? std::vector<int>(10, 1)
                                       : std::vector<int>(1 + seed % 4, 1 + seed % 100);
    Simulation simulation(GetParam(), jittery(seed));
    std::vector<std::unique_ptr<Wanderers>> workers;
    std::vector<Worker*> addresses;
    for (int r = 0; r < GetParam(); ++r) {
      workers.push_back(std::make_unique<Wanderers>(
          simulation, 1000 * seed + static_cast<std::uint64_t>(r),
          r == GetParam() / 2 ? first : std::vector<int>()));
      addresses.push_back(workers.back().get());
    }
    ASSERT_TRUE(simulation.run(addresses, options_of(seed)));
    int num_received = 0;
    for (const auto& worker : workers) num_received += worker->num_received;
    // The first are no messages themselves.
    ASSERT_EQ(num_received, static_cast<int>(first.size()) * 2 * first.front()) << "seed " << seed;
    ASSERT_EQ(simulation.num_under_way(), 0) << "seed " << seed;
  }
}

TEST_P(OnSimulatedRanks, AnyRankStopsTheRunAtAnyTime) {
  RandomGraph graph;
  graph.most_children = 8;
  const std::vector<Key> all = reachable(graph);
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    Simulation simulation(GetParam(), jittery(seed));
    GraphRun graph_run(simulation, graph, 0);
    const Key last = all[mix(seed) % all.size()];
    for (int r = 0; r < GetParam(); ++r) {
      graph_run.workers[r]->during = [&, r](Key key, Mail& mail) {
        simulation.spend(r, 5e-3 * graph.cost(key));
        if (key == last) mail.stop();
      };
    }
    EXPECT_FALSE(graph_run.run(options_of(seed)));
    EXPECT_EQ(simulation.num_under_way(), 0);
    for (const auto& worker : graph_run.workers) EXPECT_TRUE(worker->was_discarded);
    // Some, none twice.
    const std::vector<Key> executed = graph_run.executed();
    EXPECT_TRUE(std::includes(all.begin(), all.end(), executed.begin(), executed.end()));
    EXPECT_TRUE(std::adjacent_find(executed.begin(), executed.end()) == executed.end());
  }
}

TEST_P(OnSimulatedRanks, RunsInARowDoNotMix) {
  Simulation simulation(GetParam(), jittery(1));
  double before = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    RandomGraph graph;
    graph.seed = seed;
    GraphRun graph_run(simulation, graph, 0);
    if (seed % 2 == 0) {
      graph_run.workers.back()->during = [&](Key, Mail& mail) {
        simulation.spend(mail.rank(), 1e-3);
        mail.stop();
      };
    }
    if (graph_run.run()) {
      EXPECT_EQ(graph_run.executed(), reachable(graph));
    }
    EXPECT_GT(simulation.makespan(), before);
    before = simulation.makespan();
  }
}

TEST_P(OnSimulatedRanks, AnErrorEndsTheRun) {
  RandomGraph graph;
  graph.most_children = 8;
  Simulation simulation(GetParam(), jittery(1));
  GraphRun graph_run(simulation, graph, 0);
  const std::vector<Key> all = reachable(graph);
  for (auto& worker : graph_run.workers) {
    worker->during = [&](Key key, Mail&) {
      if (key == all[all.size() / 2]) throw InputError("too soft");
    };
  }
  EXPECT_THROW(graph_run.run(), InputError);
  for (const auto& worker : graph_run.workers) EXPECT_TRUE(worker->was_discarded);
}

TEST_P(OnSimulatedRanks, TheSameSeedGivesTheSameRun) {
  const RandomGraph graph;
  std::vector<double> makespans;
  std::vector<std::int64_t> messages;
  for (int again = 0; again < 2; ++again) {
    Simulation simulation(GetParam(), jittery(3));
    GraphRun graph_run(simulation, graph, 0);
    ASSERT_TRUE(graph_run.run());
    makespans.push_back(simulation.makespan());
    messages.push_back(simulation.report(0).messages);
  }
  EXPECT_EQ(makespans[0], makespans[1]);
  EXPECT_EQ(messages[0], messages[1]);
}

INSTANTIATE_TEST_SUITE_P(Ranks, OnSimulatedRanks, testing::Values(1, 2, 3, 4, 8, 17, 64));

TEST(HomeOf, SpreadsNeighbouringKeysEvenly) {
  for (const int ranks : {2, 3, 64, 1000}) {
    constexpr int per_rank = 200;
    std::vector<int> number(static_cast<std::size_t>(ranks), 0);
    for (std::uint64_t key = 0; key < static_cast<std::uint64_t>(ranks) * per_rank; ++key) {
      ++number[home_of(key, ranks)];
    }
    double chi_square = 0;
    for (const int n : number) chi_square += (n - per_rank) * (n - per_rank) / double{per_rank};
    // Mean and variance of the distribution are d and 2 d; five standard deviations.
    const double d = ranks - 1;
    EXPECT_LT(chi_square, d + 5 * std::sqrt(2 * d)) << ranks;
    EXPECT_GT(chi_square, d - 5 * std::sqrt(2 * d)) << ranks;
  }
}

TEST(TranspositionTable, TellsStatesApartByTheWholeKey) {
  // Crowded into few buckets, so that keys of one bucket must be compared.
  TranspositionTable<Key> table;
  table.max_load_factor(1000);
  constexpr Key num_keys = 3000;
  for (Key key = 0; key < num_keys; ++key) {
    EXPECT_TRUE(table.emplace(test::to_bytes({key, num_keys - key}), key).second);
  }
  ASSERT_LT(table.bucket_count(), num_keys / 10);
  for (Key key = 0; key < num_keys; ++key) {
    const Bytes bytes = test::to_bytes({key, num_keys - key});
    EXPECT_EQ(table.at(bytes), key);
    EXPECT_FALSE(table.emplace(bytes, 0).second);
  }
  EXPECT_EQ(table.count(test::to_bytes({num_keys, 0})), 0);
  EXPECT_EQ(table.count(Bytes()), 0);
}

// Forests

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

TaskTree random_tree(int size, std::uint64_t seed) {
  TaskTree tree{{0.01}, {-1}};
  for (int i = 1; i < size; ++i) {
    const std::uint64_t random = mix(mix(seed) + static_cast<std::uint64_t>(i));
    tree.seconds.push_back(0.005 + 0.001 * static_cast<double>(random % 96));
    tree.parent.push_back(static_cast<int>((random >> 32) % static_cast<std::uint64_t>(i)));
  }
  return tree;
}

Forest random_forest(int num_sites) {
  Forest forest;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) forest.trees.push_back(random_tree(343, seed));
  for (int i = 0; i < num_sites; ++i) forest.tree_of_site.push_back(i % 5);
  return forest;
}

ForestOptions ideal_options() {
  ForestOptions options;
  options.machine = ideal();
  options.start_seconds = 0;
  return options;
}

TEST(Forest, WorkAndCriticalPath) {
  const Forest forest{{chain(5, 2), TaskTree{{1, 4, 1, 1}, {-1, 0, 0, 2}}}, {0, 1, 1}};
  EXPECT_EQ(forest.num_tasks(), 13);
  EXPECT_DOUBLE_EQ(forest.work(), 10 + 7 + 7);
  EXPECT_DOUBLE_EQ(forest.critical_path(), 10);
}

TEST(Forest, MustHang) {
  const auto simulate = [](const Forest& forest) {
    (void)simulate_static(forest, 2, StaticShare::round_robin);
  };
  EXPECT_THROW(simulate({{TaskTree{}}, {0}}), InputError);
  EXPECT_THROW(simulate({{TaskTree{{1}, {0}}}, {0}}), InputError);
  EXPECT_THROW(simulate({{TaskTree{{1, 1}, {-1, 1}}}, {0}}), InputError);
  EXPECT_THROW(simulate({{TaskTree{{1, 1}, {-1}}}, {0}}), InputError);
  EXPECT_THROW(simulate({{TaskTree{{-1}, {-1}}}, {0}}), InputError);
  EXPECT_THROW(simulate({{chain(2, 1)}, {1}}), InputError);
  EXPECT_NO_THROW(simulate({{chain(2, 1)}, {0}}));
}

/// In which the end is found once the last task is done, s: two waves in vain.
constexpr double kDetection = 2e-3;
/// Of times that are sums of slices.
constexpr double kRounding = 1e-9;

TEST(SimulatedTds, AChainTakesItsLengthHoweverManyRanks) {
  const Forest forest{{chain(10, 0.25)}, {0}};
  for (const int ranks : {1, 2, 64}) {
    const ForestResult result = simulate_tds(forest, ranks, ideal_options());
    EXPECT_EQ(result.tasks, 10);
    EXPECT_GE(result.makespan, 2.5 - kRounding);
    EXPECT_LE(result.makespan, 2.5 + kDetection);
    EXPECT_DOUBLE_EQ(result.efficiency, 2.5 / (ranks * result.makespan));
  }
}

TEST(SimulatedTds, EqualTasksThatAreAtHomeOnAllRanksTakeAsLongAsOne) {
  for (const int ranks : {2, 8, 64}) {
    // The first site of each rank counts; the others, until each rank has one, take no time.
    Forest forest{{chain(1, 0), chain(1, 1)}, {}};
    std::set<int> homes;
    for (std::uint64_t site = 0; static_cast<int>(homes.size()) < ranks; ++site) {
      forest.tree_of_site.push_back(homes.insert(home_of(site, ranks)).second ? 1 : 0);
    }
    const ForestResult result = simulate_tds(forest, ranks, ideal_options());
    EXPECT_DOUBLE_EQ(result.work, ranks);
    EXPECT_GE(result.makespan, 1 - kRounding);
    EXPECT_LE(result.makespan, 1 + kDetection);
  }
}

TEST(SimulatedTds, EqualTasksOnOneRankSpread) {
  for (const int ranks : {2, 4, 8, 64}) {
    const Forest forest{{star(ranks, 1)}, {0}};
    const ForestResult result = simulate_tds(forest, ranks, ideal_options());
    EXPECT_GE(result.makespan, 1 - kRounding);
    // Shares spread in log₂ steps, each of which waits for a slice of the giver. One task may be
    // left over, for which no idle rank asks in time.
    const double spread = (std::log2(ranks) + 1) * ForestOptions().poll_interval;
    EXPECT_LE(result.makespan, (ranks > 4 ? 2 : 1) + spread + kDetection);
  }
}

TEST(SimulatedTds, ExecutesEachTaskOnceAtFullCost) {
  const Forest forest = random_forest(20);
  for (const int ranks : {1, 3, 64, 256}) {
    const ForestResult result = simulate_tds(forest, ranks, {});
    EXPECT_EQ(result.tasks, forest.num_tasks());
    EXPECT_NEAR(result.work, forest.work(), 1e-9 * forest.work());
    EXPECT_GE(result.makespan,
              std::max(forest.critical_path(), forest.work() / ranks) * (1 - kRounding));
    EXPECT_DOUBLE_EQ(result.efficiency, result.work / (ranks * result.makespan));
    // What is not work is idle or spent on messages.
    EXPECT_LE(result.work + result.report.idle_seconds, ranks * result.makespan * (1 + kRounding));
    EXPECT_EQ(simulate_tds(forest, ranks, {}).makespan, result.makespan);
  }
}

TEST(SimulatedTds, BalancesWhatAFixedShareCannot) {
  // One site for 16 ranks, and 20 sites for 8.
  const Forest one = random_forest(1);
  EXPECT_GT(simulate_tds(one, 16, {}).efficiency, 0.6);
  EXPECT_NEAR(simulate_static(one, 16, StaticShare::round_robin).efficiency, 1.0 / 16, 1e-12);
  const Forest many = random_forest(20);
  EXPECT_GT(simulate_tds(many, 8, {}).efficiency, 0.97);
  EXPECT_LT(simulate_static(many, 8, StaticShare::round_robin).efficiency, 0.9);
}

TEST(SimulatedTds, IdleRanksDoNotDrownABusyOne) {
  // A thousand ranks with nothing to steal for ten seconds.
  constexpr int ranks = 1024;
  const Forest forest{{chain(1, 10)}, {0}};
  const ForestResult result = simulate_tds(forest, ranks, {});
  EXPECT_GT(result.efficiency * ranks, 0.998);
  const double asked_a_second =
      static_cast<double>(result.report.steals_asked) / (ranks * result.makespan);
  EXPECT_LT(asked_a_second, 1 / 4e-3);
}

TEST(SimulatedTds, AShareCostsTheFactorOfItsStart) {
  // The root, one task stays, the other one goes.
  const Forest forest{{star(2, 1)}, {0}};
  ForestOptions options = ideal_options();
  options.start_seconds = 0.5;
  const ForestResult result = simulate_tds(forest, 2, options);
  EXPECT_NEAR(result.makespan, 1.5, options.poll_interval + kDetection);
  EXPECT_DOUBLE_EQ(result.work, 2);
  // One that starts from rest needs none.
  const Forest sites{{chain(1, 1)}, {0, 0}};
  EXPECT_LT(simulate_tds(sites, 2, options).makespan, 1.4);
}

TEST(SimulatedTds, AStateThatIsSentTakesTime) {
  const Forest forest{{star(64, 0.1)}, {0}};
  ForestOptions options;
  options.state_bytes = 0;
  const double without = simulate_tds(forest, 8, options).makespan;
  // 0.2 s for each state.
  options.state_bytes = 1'000'000'000;
  EXPECT_GT(simulate_tds(forest, 8, options).makespan, without + 0.2);
}

TEST(SimulatedStatic, IsTheSlowestRank) {
  const Forest forest{{chain(1, 1), chain(3, 1)}, {0, 1, 0, 1, 0}};
  const ForestResult result = simulate_static(forest, 2, StaticShare::round_robin);
  EXPECT_DOUBLE_EQ(result.makespan, 6);
  EXPECT_DOUBLE_EQ(result.efficiency, 9.0 / 12);
  double slowest = 0;
  for (int r = 0; r < 2; ++r) {
    double sum = 0;
    for (int site = 0; site < 5; ++site) {
      if (home_of(static_cast<std::uint64_t>(site), 2) == r) sum += site % 2 == 0 ? 1 : 3;
    }
    slowest = std::max(slowest, sum);
  }
  EXPECT_DOUBLE_EQ(simulate_static(forest, 2, StaticShare::by_hash).makespan, slowest);
}

TEST(SimulatedMasterWorker, HandsOutOneTaskAfterTheOther) {
  const Forest forest{{chain(1, 1)}, {0, 0, 0, 0}};
  EXPECT_DOUBLE_EQ(simulate_master_worker(forest, 1, ideal_options()).makespan, 4);
  // Two of the three ranks work.
  const ForestResult ideal_result = simulate_master_worker(forest, 3, ideal_options());
  EXPECT_DOUBLE_EQ(ideal_result.makespan, 2);
  EXPECT_DOUBLE_EQ(ideal_result.efficiency, 4.0 / 6);
  EXPECT_EQ(ideal_result.tasks, 4);

  // Two messages a task through one processor: with tasks of no length nothing else counts.
  ForestOptions options = ideal_options();
  options.machine.overhead = 1e-3;
  const Forest instant{{chain(1, 0)}, std::vector<int>(1000, 0)};
  EXPECT_NEAR(simulate_master_worker(instant, 513, options).makespan, 2.0, 0.01);

  // A root whose four children go to four ranks: its state comes once and leaves three times.
  options = ideal_options();
  options.machine.bandwidth = 1e6;
  options.state_bytes = 1'000'000;
  options.summary_bytes = 0;
  const Forest one_star{{star(4, 10)}, {0}};
  EXPECT_NEAR(simulate_master_worker(one_star, 5, options).makespan, 14, 0.01);
}

/// Each task posts a message to rank 1.
class Reporter final : public Worker {
 public:
  Reporter(Simulation& simulation, int num_tasks, double seconds)
      : simulation_(simulation), num_tasks_(num_tasks), seconds_(seconds) {}

  void receive(int from, const Bytes&, Mail&) override { ++num_received[from]; }
  [[nodiscard]] bool has_work() const override { return num_tasks_ > 0; }
  void work(Mail& mail) override {
    --num_tasks_;
    simulation_.spend(mail.rank(), seconds_);
    mail.send(1, {});
    done_at = simulation_.now(mail.rank());
  }
  [[nodiscard]] Bytes give() override {
    const int half = num_tasks_ / 2;
    num_tasks_ -= half;
    return Bytes(static_cast<std::size_t>(half));
  }
  void take(const Bytes& share, Mail&) override { num_tasks_ += static_cast<int>(share.size()); }
  void discard() override { num_tasks_ = 0; }

  std::map<int, int> num_received;
  double done_at = 0;

 private:
  Simulation& simulation_;
  int num_tasks_;
  double seconds_;
};

TEST(Scheduler, TheEndIsNotFoundWhileAShareIsLongUnderWay) {
  // What rank 3 gets from rank 2 and posts to rank 1, and the word that it was read, travel over
  // links that no wave takes, and arrive long after all else is done.
  Machine machine;
  machine.distance = [](int from, int to) {
    return (from == 2 && to == 3) || (from == 3 && to == 1) || (from == 1 && to == 3) ? 0.3 : 0.0;
  };
  ScheduleOptions options;
  options.most_unread_bytes = 0;
  Simulation simulation(4, machine);
  std::vector<std::unique_ptr<Reporter>> workers;
  std::vector<Worker*> addresses;
  for (int r = 0; r < 4; ++r) {
    workers.push_back(std::make_unique<Reporter>(simulation, r == 2 ? 8 : 0, 0.01));
    addresses.push_back(workers.back().get());
  }
  ASSERT_TRUE(simulation.run(addresses, options));
  std::map<int, int>& num_received = workers[1]->num_received;
  EXPECT_EQ(num_received[0] + num_received[1] + num_received[2] + num_received[3], 8);
  EXPECT_GT(num_received[3], 0);
  EXPECT_GT(simulation.makespan(), 0.9);
  EXPECT_EQ(simulation.num_under_way(), 0);
}

TEST(Scheduler, ARankThatDoesNotPollDoesNotHoldOthersUp) {
  // Rank 0 answers after ten seconds. The tasks of rank 1 take 4 s on it alone, 0.6 s on all others.
  constexpr int ranks = 8;
  Simulation simulation(ranks, {});
  std::vector<std::unique_ptr<Reporter>> workers;
  std::vector<Worker*> addresses;
  for (int r = 0; r < ranks; ++r) {
    const int num_tasks = r == 0 ? 1 : r == 1 ? 400 : 0;
    workers.push_back(std::make_unique<Reporter>(simulation, num_tasks, r == 0 ? 10 : 0.01));
    addresses.push_back(workers.back().get());
  }
  ASSERT_TRUE(simulation.run(addresses));
  for (int r = 1; r < ranks; ++r) {
    EXPECT_GT(workers[r]->done_at, 0.3) << r;
    EXPECT_LT(workers[r]->done_at, 1) << r;
  }
}

/// Each task posts messages to rank 0, which is long at its own.
class Flood final : public Worker {
 public:
  static constexpr int kMessages = 10;
  static constexpr std::size_t kBytes = 1000;

  Flood(Simulation& simulation, int num_tasks) : simulation_(simulation), num_tasks_(num_tasks) {}

  void receive(int, const Bytes&, Mail&) override {}
  [[nodiscard]] bool has_work() const override { return num_tasks_ > 0; }
  void work(Mail& mail) override {
    --num_tasks_;
    simulation_.spend(mail.rank(), mail.rank() == 0 ? 1 : 1e-3);
    for (int i = 0; i < kMessages; ++i) mail.send(0, Bytes(kBytes));
  }
  [[nodiscard]] Bytes give() override { return {}; }
  void take(const Bytes&, Mail&) override {}
  void discard() override {}

 private:
  Simulation& simulation_;
  int num_tasks_;
};

TEST(Scheduler, UnreadMailIsBounded) {
  constexpr int ranks = 16;
  constexpr std::size_t of_task = Flood::kMessages * (Flood::kBytes + kMessageBytes);
  const auto most_queued = [](std::size_t most_unread_bytes) {
    Simulation simulation(ranks, {});
    std::vector<std::unique_ptr<Flood>> workers;
    std::vector<Worker*> addresses;
    for (int r = 0; r < ranks; ++r) {
      workers.push_back(std::make_unique<Flood>(simulation, r == 0 ? 3 : 500));
      addresses.push_back(workers.back().get());
    }
    ScheduleOptions options;
    options.most_unread_bytes = most_unread_bytes;
    EXPECT_TRUE(simulation.run(addresses, options));
    return static_cast<std::size_t>(simulation.report(0).most_queued_bytes);
  };
  constexpr std::size_t most = 5 * of_task;
  constexpr std::size_t bound = ranks * (most + of_task);
  EXPECT_LE(most_queued(most), bound);
  // The bound is what holds it back.
  EXPECT_GT(most_queued(1 << 30), 10 * bound);
}

}  // namespace
}  // namespace palpate
