// SPDX-License-Identifier: BSD-3-Clause
// The scheduler on the ranks of the test program.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <map>
#include <new>
#include <stdexcept>
#include <string>
#include <thread>

#include "base/error.h"
#include "schedule/scheduler.h"
#include "solvers/schedule/hard_networks.h"
#include "solvers/schedule/random_graph.h"
#include "solvers/support/communicators.h"

namespace palpate::test::test_scheduler {
namespace {

using test::GraphWorker;
using test::Key;
using test::RandomGraph;

void work_for(double seconds) {
  std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
}

class SchedulerOnRanks : public testing::Test {
 protected:
  [[nodiscard]] int last() const { return world_->size() - 1; }
  /// On one rank; the others have nothing.
  [[nodiscard]] std::vector<Key> roots_on(int rank, const RandomGraph& graph) const {
    return world_->rank() == rank ? graph.roots() : std::vector<Key>();
  }

  /// Each key once, on all ranks together.
  void expect_all_executed(const RandomGraph& graph, const GraphWorker& worker) {
    std::multiset<Key> executed;
    for (const Bytes& one : world_->all_gather(test::to_bytes(worker.executed))) {
      for (const Key key : test::to_keys(one)) executed.insert(key);
    }
    const std::set<Key> expected = graph.reachable();
    EXPECT_EQ(executed, std::multiset<Key>(expected.begin(), expected.end()));
  }

  /// What is thrown on every rank.
  template <class Error>
  void expect_error(Worker& worker, const std::string& message) {
    try {
      (void)run(worker, *world_);
      ADD_FAILURE() << "nothing thrown";
    } catch (const Error& error) {
      EXPECT_EQ(error.what(), message);
    }
  }

  std::unique_ptr<Communicator> world_ = test::make_world();
};

TEST_F(SchedulerOnRanks, ExecutesARandomGraphOnce) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    RandomGraph graph;
    graph.seed = seed;
    GraphWorker worker(graph, roots_on(static_cast<int>(seed) % world_->size(), graph));
    worker.during = [&](Key key, Mail& mail) {
      work_for(100e-6 * graph.cost(key));
      EXPECT_TRUE(mail.poll());
    };
    ScheduleReport report;
    ASSERT_TRUE(run(worker, *world_, &report));
    EXPECT_EQ(report.tasks, static_cast<std::int64_t>(worker.executed.size()));
    EXPECT_LE(report.steals_granted, report.steals_asked);
    EXPECT_EQ(sum(*world_, report).tasks, static_cast<std::int64_t>(graph.reachable().size()));
    expect_all_executed(graph, worker);
    EXPECT_FALSE(worker.was_discarded);
  }
}

TEST_F(SchedulerOnRanks, MessagesMayComeLateAndInAnotherOrder) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    RandomGraph graph;
    graph.seed = seed;
    test::LateCommunicator late(*world_, 2e-3, seed);
    GraphWorker worker(graph, roots_on(last(), graph));
    worker.during = [&](Key key, Mail&) { work_for(100e-6 * graph.cost(key)); };
    ASSERT_TRUE(run(worker, late));
    EXPECT_TRUE(late.network().is_empty());
    expect_all_executed(graph, worker);
  }
}

TEST_F(SchedulerOnRanks, EndsWithoutAnyTask) {
  const RandomGraph graph;
  GraphWorker worker(graph, {});
  ScheduleReport report;
  ASSERT_TRUE(run(worker, *world_, &report));
  EXPECT_EQ(report.tasks, 0);
}

TEST_F(SchedulerOnRanks, EndsAfterOneTask) {
  RandomGraph graph;
  graph.num_roots = 1;
  graph.num_layers = 1;
  GraphWorker worker(graph, roots_on(last(), graph));
  ASSERT_TRUE(run(worker, *world_));
  expect_all_executed(graph, worker);
}

/// Passes a message round the ranks; where it ends there is one task.
class Relay final : public Worker {
 public:
  explicit Relay(int num_hops) : num_hops_(num_hops) {}

  void start(Mail& mail) override {
    if (mail.rank() == 0) pass_on(num_hops_, mail);
  }
  void receive(int /*from*/, const Bytes& message, Mail& mail) override {
    const auto left = static_cast<int>(message.size());
    left > 0 ? pass_on(left, mail) : static_cast<void>(++num_tasks_);
  }
  [[nodiscard]] bool has_work() const override { return num_tasks_ > 0; }
  void work(Mail&) override { --num_tasks_, ++num_executed; }
  [[nodiscard]] Bytes give() override { return {}; }
  void take(const Bytes&, Mail&) override { ADD_FAILURE() << "nothing was given"; }
  void discard() override { num_tasks_ = 0; }

  int num_executed = 0;

 private:
  void pass_on(int left, Mail& mail) {
    mail.send((mail.rank() + 1) % mail.size(), Bytes(static_cast<std::size_t>(left - 1)));
  }

  int num_hops_;
  int num_tasks_ = 0;
};

TEST_F(SchedulerOnRanks, WaitsForATaskThatTheVeryLastMessagePosts) {
  constexpr int num_hops = 25;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    test::LateCommunicator late(*world_, 4e-3, seed);
    Relay worker(num_hops);
    ASSERT_TRUE(run(worker, late));
    EXPECT_EQ(worker.num_executed, num_hops % world_->size() == world_->rank() ? 1 : 0);
  }
}

TEST_F(SchedulerOnRanks, AnyRankStopsTheRunAtAnyTime) {
  RandomGraph graph;
  graph.most_children = 8;
  for (int stopper = 0; stopper < world_->size(); ++stopper) {
    for (int after : {0, 1, 5}) {
      GraphWorker worker(graph, roots_on(0, graph));
      worker.during = [&](Key, Mail& mail) {
        work_for(100e-6);
        const auto num_executed = static_cast<int>(worker.executed.size());
        if (mail.rank() == stopper && num_executed > after) {
          mail.stop();
          EXPECT_FALSE(mail.poll());
        }
      };
      // The rank may get too few tasks to come to it.
      const bool completed = run(worker, *world_);
      const auto all = world_->all_gather(completed ? Bytes(1) : Bytes());
      for (const Bytes& one : all) EXPECT_EQ(one.empty(), !completed);
      EXPECT_EQ(worker.was_discarded, !completed);
      if (world_->size() == 1) {
        EXPECT_FALSE(completed);
        EXPECT_EQ(static_cast<int>(worker.executed.size()), after + 1);
      }
      if (completed) expect_all_executed(graph, worker);
    }
  }
}

TEST_F(SchedulerOnRanks, AStopBeforeTheFirstTaskLeavesNone) {
  const RandomGraph graph;
  class Stopper final : public GraphWorker {
   public:
    using GraphWorker::GraphWorker;
    void start(Mail& mail) override {
      GraphWorker::start(mail);
      if (mail.rank() == mail.size() - 1) mail.stop();
    }
  } worker(graph, roots_on(last(), graph));
  EXPECT_FALSE(run(worker, *world_));
  if (world_->rank() == last()) {
    EXPECT_TRUE(worker.executed.empty());
  }
}

TEST_F(SchedulerOnRanks, TooLittleMemoryForMessagesEndsTheRunOnAll) {
  RandomGraph graph;
  for (const int first : {0, 1, 10, 100}) {
    // Several calls, also after the run has been stopped.
    constexpr int kCount = 5;
    constexpr int kNever = 1 << 30;
    const bool is_short = world_->rank() == last();
    test::ShortCommunicator communicator(*world_, is_short ? first : kNever, kCount);
    GraphWorker worker(graph, roots_on(0, graph));
    EXPECT_THROW((void)run(worker, communicator), MemoryError);
    // The ranks are fit for another run.
    GraphWorker sound(graph, roots_on(0, graph));
    ASSERT_TRUE(run(sound, *world_));
    expect_all_executed(graph, sound);
  }
}

TEST_F(SchedulerOnRanks, ARankThatFailedBeforeLetsNoneBegin) {
  RandomGraph graph;
  GraphWorker worker(graph, roots_on(0, graph));
  EXPECT_THROW(agree(*world_,
                     [&] {
                       if (world_->rank() == last()) throw std::bad_alloc();
                       (void)run(worker, *world_);
                     }),
               MemoryError);
  EXPECT_TRUE(worker.executed.empty());
}

TEST_F(SchedulerOnRanks, AnErrorOnOneRankEndsTheRunOnAll) {
  RandomGraph graph;
  GraphWorker worker(graph, roots_on(0, graph));
  worker.during = [&](Key key, Mail&) {
    if (key >= 200) throw InputError("the body is not held");
  };
  expect_error<InputError>(worker, "the body is not held");

  class Fails final : public Worker {
   public:
    explicit Fails(int rank) : rank_(rank) {}
    void start(Mail& mail) override {
      if (mail.rank() >= rank_) mail.send(mail.rank(), {});
    }
    void receive(int from, const Bytes&, Mail&) override {
      throw std::runtime_error("no room on rank " + std::to_string(from));
    }
    [[nodiscard]] bool has_work() const override { return false; }
    void work(Mail&) override {}
    [[nodiscard]] Bytes give() override { return {}; }
    void take(const Bytes&, Mail&) override {}
    void discard() override {}

   private:
    int rank_;
  };
  Fails on_last(last());
  expect_error<BackendError>(on_last, "no room on rank " + std::to_string(last()));
  // Of several the one that is heard of first, the same on every rank.
  Fails on_all(0);
  std::string error;
  try {
    (void)run(on_all, *world_);
  } catch (const BackendError& thrown) {
    error = thrown.what();
  }
  EXPECT_EQ(error.rfind("no room on rank ", 0), 0U) << error;
  const auto* text = reinterpret_cast<const std::byte*>(error.data());
  const Bytes mine(text, text + error.size());
  for (const Bytes& other : world_->all_gather(mine)) EXPECT_EQ(other, mine);

  // The ranks are fit for another run.
  GraphWorker sound(graph, roots_on(0, graph));
  ASSERT_TRUE(run(sound, *world_));
  expect_all_executed(graph, sound);
}

/// Tasks that do nothing but wait to be asked for.
class Pile : public Worker {
 public:
  explicit Pile(int num_tasks) : num_tasks_(num_tasks) {}

  void receive(int /*from*/, const Bytes& /*message*/, Mail& /*mail*/) override {}
  [[nodiscard]] bool has_work() const override { return num_tasks_ > 0; }
  void work(Mail& mail) override {
    --num_tasks_, ++num_executed;
    in_task_ = true;
    during(mail);
    in_task_ = false;
  }
  [[nodiscard]] Bytes give() override {
    const int half = (num_tasks_ + (in_task_ ? 1 : 0)) / 2;
    num_tasks_ -= half;
    num_given += half;
    return Bytes(static_cast<std::size_t>(half));
  }
  void take(const Bytes& share, Mail&) override { num_tasks_ += static_cast<int>(share.size()); }
  void discard() override { num_tasks_ = 0; }

  [[nodiscard]] int num_tasks() const { return num_tasks_; }

  int num_executed = 0;
  int num_given = 0;
  std::function<void(Mail&)> during = [](Mail&) {};

 private:
  int num_tasks_;
  bool in_task_ = false;
};

TEST_F(SchedulerOnRanks, OthersStealFromWithinALongTask) {
  if (world_->size() == 1) GTEST_SKIP() << "nobody to steal";
  constexpr int num_tasks = 33;
  Pile worker(world_->rank() == last() ? num_tasks : 0);
  // The first task ends only when all others are gone.
  worker.during = [&](Mail& mail) {
    while (mail.rank() == last() && worker.num_tasks() > 0) mail.poll();
  };
  ScheduleReport report;
  ASSERT_TRUE(run(worker, *world_, &report));
  const ScheduleReport total = sum(*world_, report);
  EXPECT_EQ(total.tasks, num_tasks);
  EXPECT_GT(total.steals_granted, 0);
  if (world_->rank() == last()) {
    EXPECT_GE(worker.num_given, num_tasks - 1);
  }
}

/// Posts messages of given lengths to all ranks, and gives a share that is as long.
class Sizes final : public Worker {
 public:
  Sizes(std::vector<std::size_t> sizes, bool has_share)
      : sizes_(std::move(sizes)), num_shares_(has_share ? 2 : 0) {}

  static Bytes make(std::size_t size, int from) {
    constexpr std::size_t block = 4096;
    Bytes message(size);
    for (std::size_t i = 0; i < size; i += block) {
      const auto first = message.begin() + static_cast<std::ptrdiff_t>(i);
      const auto value = static_cast<std::byte>(mix(i) + static_cast<std::uint64_t>(from));
      std::fill_n(first, std::min(block, size - i), value);
    }
    return message;
  }

  void start(Mail& mail) override {
    for (const std::size_t size : sizes_) {
      for (int to = 0; to < mail.size(); ++to) mail.send(to, make(size, mail.rank()));
    }
  }
  void receive(int from, const Bytes& message, Mail&) override {
    // In the order in which they were posted.
    std::size_t& number = num_received[from];
    ASSERT_LT(number, sizes_.size());
    EXPECT_TRUE(message == make(sizes_[number], from)) << number;
    ++number;
  }
  [[nodiscard]] bool has_work() const override { return num_shares_ > 0; }
  void work(Mail& mail) override {
    while (num_shares_ > 1 && mail.size() > 1) mail.poll();
    num_shares_ = 0;
  }
  [[nodiscard]] Bytes give() override {
    if (num_shares_ < 2) return {};
    --num_shares_;
    return make(sizes_.back(), 7);
  }
  void take(const Bytes& share, Mail&) override {
    EXPECT_TRUE(share == make(sizes_.back(), 7));
    ++num_taken;
  }
  void discard() override {}

  std::map<int, std::size_t> num_received;
  int num_taken = 0;

 private:
  std::vector<std::size_t> sizes_;
  int num_shares_;
};

TEST_F(SchedulerOnRanks, MessagesOfNoBytesAndOf50MegabytesArriveWholeAndInOrder) {
  // Eight ranks would need 8 GB at once for more than one of them.
  const std::size_t large = world_->size() > 3 ? 5'000'000 : 50'000'000;
  const std::vector<std::size_t> sizes = {0, 3, large, 0, 1, (16 << 20) + 1, 100'000};
  Sizes worker(sizes, world_->rank() == 0);
  ASSERT_TRUE(run(worker, *world_));
  for (int r = 0; r < world_->size(); ++r) EXPECT_EQ(worker.num_received[r], sizes.size());

  Sizes shares({large}, world_->rank() == 0);
  ASSERT_TRUE(run(shares, *world_));
  int num_taken = 0;
  for (const Bytes& one : world_->all_gather(Bytes(static_cast<std::size_t>(shares.num_taken)))) {
    num_taken += static_cast<int>(one.size());
  }
  EXPECT_EQ(num_taken, world_->size() > 1 ? 1 : 0);
}

/// Each task posts messages to rank 0, which has no time to read them.
class Flood final : public Pile {
 public:
  static constexpr int kMessages = 10;
  static constexpr std::size_t kBytes = 1000;

  explicit Flood(int num_tasks) : Pile(num_tasks) {
    during = [](Mail& mail) {
      for (int i = 0; i < kMessages; ++i) mail.send(0, Bytes(kBytes));
      if (mail.rank() == 0) {
        for (int i = 0; i < 20; ++i) {
          work_for(1e-3);
          mail.poll();
        }
      }
    };
  }
  void receive(int, const Bytes&, Mail&) override { ++num_received; }

  int num_received = 0;
};

TEST_F(SchedulerOnRanks, UnreadMailIsBounded) {
  constexpr int num_tasks = 200;
  constexpr std::size_t of_task = Flood::kMessages * (Flood::kBytes + kMessageBytes);
  ScheduleOptions options;
  options.most_unread_bytes = 5 * of_task;
  // All have work enough to fill rank 0 while it is at its own.
  Flood worker(world_->rank() == 0 ? 3 : num_tasks);
  ScheduleReport report;
  ASSERT_TRUE(run(worker, *world_, &report, options));
  EXPECT_LE(report.most_queued_bytes,
            static_cast<std::int64_t>(world_->size() * (options.most_unread_bytes + of_task)));
  const std::int64_t expected = Flood::kMessages * (3 + num_tasks * last());
  EXPECT_EQ(worker.num_received, world_->rank() == 0 ? expected : 0);
}

/// Mail that says which run it is of.
class Numbered final : public Worker {
 public:
  explicit Numbered(std::size_t number) : number_(number) {}

  void start(Mail& mail) override {
    for (int to = 0; to < mail.size(); ++to) mail.send(to, Bytes(number_));
  }
  void receive(int /*from*/, const Bytes& message, Mail& mail) override {
    EXPECT_EQ(message.size(), number_);
    ++num_received;
    if (number_ % 3 == 0) mail.stop();
  }
  [[nodiscard]] bool has_work() const override { return false; }
  void work(Mail&) override {}
  [[nodiscard]] Bytes give() override { return {}; }
  void take(const Bytes&, Mail&) override {}
  void discard() override {}

  int num_received = 0;

 private:
  std::size_t number_;
};

TEST_F(SchedulerOnRanks, RunsInARowDoNotMix) {
  for (std::size_t number = 1; number <= 100; ++number) {
    Numbered worker(number);
    const bool completed = run(worker, *world_);
    EXPECT_EQ(completed, number % 3 != 0);
    if (completed) {
      EXPECT_EQ(worker.num_received, world_->size());
    }
    if (number % 10 != 0) continue;
    // Nothing is left for whoever comes next.
    agree(*world_, [&] { EXPECT_FALSE(world_->network().receive()); });
  }
}

}  // namespace
}  // namespace palpate::test::test_scheduler
