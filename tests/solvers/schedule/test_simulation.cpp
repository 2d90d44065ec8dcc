// SPDX-License-Identifier: BSD-3-Clause
// The scheduler on many simulated ranks, and the simulator itself against what can be counted by
// hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <new>
#include <set>

#include "base/error.h"
#include "solvers/schedule/random_graph.h"
#include "solvers/support/simulation.h"

namespace palpate::test::test_simulation {
namespace {

using test::GraphWorker;
using test::Key;
using test::Machine;
using test::RandomGraph;
using test::Simulation;
using test::TranspositionTable;

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
    ASSERT_EQ(simulation.under_way().messages, 0);
  }
}

TEST_P(OnSimulatedRanks, APausedRunGoesOnWithTheTasksThatAreLeft) {
  int num_pauses = 0;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    RandomGraph graph;
    graph.seed = seed;
    Simulation simulation(GetParam(), jittery(seed));
    GraphRun graph_run(simulation, graph, static_cast<int>(seed) % GetParam());
    int num_left = 7;
    for (int r = 0; r < GetParam(); ++r) {
      graph_run.workers[r]->during = [&, r](Key key, Mail& mail) {
        simulation.spend(r, 5e-3 * graph.cost(key));
        if (--num_left == 0) mail.pause();
      };
    }
    while (!graph_run.run(options_of(seed))) {
      ASSERT_EQ(simulation.under_way().messages, 0);
      ++num_pauses;
      num_left = 7;
    }
    ASSERT_EQ(graph_run.executed(), reachable(graph)) << "seed " << seed;
  }
  // A graph has dozens of tasks on average.
  EXPECT_GT(num_pauses, 50);
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
    for (const std::uint64_t next : {part, left - part}) mail.send_to_owner(++random_, Bytes(next));
  }

  Simulation& simulation_;
  std::uint64_t random_;
  std::vector<int> tasks_;
};

TEST_P(OnSimulatedRanks, TheEndIsNotFoundWhileMessagesWander) {
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    // A few long ones, or tasks that are shared out and done before others have heard of it.
    const std::vector<int> first =
        seed % 5 == 0 ? std::vector<int>(10, 1) : std::vector<int>(1 + seed % 4, 1 + seed % 100);
    Simulation simulation(GetParam(), jittery(seed));
    std::vector<std::unique_ptr<Wanderers>> workers;
    std::vector<Worker*> addresses;
    for (int r = 0; r < GetParam(); ++r) {
      workers.push_back(
          std::make_unique<Wanderers>(simulation, 1000 * seed + static_cast<std::uint64_t>(r),
                                      r == GetParam() / 2 ? first : std::vector<int>()));
      addresses.push_back(workers.back().get());
    }
    ASSERT_TRUE(simulation.run(addresses, options_of(seed)));
    int num_received = 0;
    for (const auto& worker : workers) num_received += worker->num_received;
    // The first are no messages themselves.
    ASSERT_EQ(num_received, static_cast<int>(first.size()) * 2 * first.front()) << "seed " << seed;
    ASSERT_EQ(simulation.under_way().messages, 0) << "seed " << seed;
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
    EXPECT_EQ(simulation.under_way().messages, 0);
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

/// At any moment, that after the message which ends the run of a rank included: nothing that is
/// left behind may meet the next run.
TEST_P(OnSimulatedRanks, TooLittleMemoryForAMessageLeavesNothingBehind) {
  RandomGraph graph;
  graph.num_layers = 4;
  for (const int rank : std::set<int>{0, GetParam() - 1}) {
    int num_failed = 0;
    for (int num_before = 0;; ++num_before) {
      Simulation simulation(GetParam(), Machine{});
      GraphRun graph_run(simulation, graph, 0);
      simulation.let_receive_fail(rank, num_before);
      bool completed = false;
      try {
        completed = graph_run.run();
      } catch (const std::bad_alloc&) {
        ++num_failed;
      }
      EXPECT_EQ(simulation.under_way().messages, 0u) << num_before;
      if (completed) break;
    }
    EXPECT_GT(num_failed, 0);
  }
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

TEST(OwnerOf, SpreadsNeighbouringKeysEvenly) {
  for (const int ranks : {2, 3, 64, 1000}) {
    constexpr int per_rank = 200;
    std::vector<int> number(static_cast<std::size_t>(ranks), 0);
    for (std::uint64_t key = 0; key < static_cast<std::uint64_t>(ranks) * per_rank; ++key) {
      ++number[owner_of(key, ranks)];
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

/// One task that takes ten seconds, and polls.
class LongTask final : public Worker {
 public:
  LongTask(Simulation& simulation, bool has_it) : simulation_(simulation), has_it_(has_it) {}

  void receive(int, const Bytes&, Mail&) override {}
  [[nodiscard]] bool has_work() const override { return has_it_; }
  void work(Mail& mail) override {
    for (int i = 0; i < 400; ++i) {
      simulation_.work_on(mail.rank(), 25e-3);
      EXPECT_TRUE(mail.poll());
    }
    has_it_ = false;
  }
  [[nodiscard]] Bytes give() override { return {}; }
  void take(const Bytes&, Mail&) override {}
  void discard() override {}

 private:
  Simulation& simulation_;
  bool has_it_;
};

TEST(Scheduler, IdleRanksDoNotDrownABusyOne) {
  // Hundreds of ranks with nothing to steal for ten seconds.
  constexpr int ranks = 256;
  Simulation simulation(ranks, {});
  std::vector<std::unique_ptr<LongTask>> workers;
  std::vector<Worker*> addresses;
  for (int r = 0; r < ranks; ++r) {
    workers.push_back(std::make_unique<LongTask>(simulation, r == 7));
    addresses.push_back(workers.back().get());
  }
  ASSERT_TRUE(simulation.run(addresses));
  EXPECT_GE(simulation.makespan(), 10 * (1 - 1e-9));
  EXPECT_LT(simulation.makespan(), 10 / 0.998);
  std::int64_t asked = 0;
  for (int r = 0; r < ranks; ++r) asked += simulation.report(r).steals_asked;
  EXPECT_GT(asked, ranks);
  EXPECT_LT(static_cast<double>(asked) / (ranks * simulation.makespan()), 1 / 4e-3);
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
  EXPECT_EQ(simulation.under_way().messages, 0);
}

TEST(Scheduler, ARankThatDoesNotPollDoesNotHoldOthersUp) {
  // Rank 0 answers after ten seconds. The tasks of rank 1 take 4 s on it alone, 0.6 s on all
  // others.
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
}  // namespace palpate::test::test_simulation
