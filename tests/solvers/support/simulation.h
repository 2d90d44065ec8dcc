// SPDX-License-Identifier: BSD-3-Clause
// Runs the scheduler of scheduler.h, the same code, on many ranks of a machine that is not there: a
// discrete-event simulation in one process. Time is the machine's; nothing depends on how fast this
// one is, and the same input gives the same result.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <queue>
#include <unordered_map>
#include <vector>

#include "schedule/scheduler.h"

namespace palpate::test {

struct Machine {
  /// From the moment a message leaves until it arrives, s.
  double latency = 5e-6;
  /// Added to it between two ranks (from, to), s; empty: nothing.
  std::function<double(int, int)> distance;
  /// At which a rank puts out its messages, one after the other, bytes/s.
  double bandwidth = 5e9;
  /// Of the processor for each message that it sends or receives, s.
  double overhead = 1e-6;
  /// Until an idle rank, which rests, sees a message, s.
  double reaction = 0.5e-3;
  /// By which a message may come late at random, most of them by far less, s; those between two
  /// ranks keep their order.
  double jitter = 0;
  std::uint64_t seed = 1;
};

/// Messages that were sent and not received, at one time.
struct UnderWay {
  std::size_t messages = 0;
  /// With kMessageBytes each.
  std::size_t bytes = 0;
};

class Simulation {
 public:
  Simulation(int num_ranks, const Machine& machine);
  ~Simulation();
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  [[nodiscard]] int size() const { return static_cast<int>(ranks_.size()); }
  [[nodiscard]] Network& network(int rank);

  // For a worker, within its functions:
  /// Lets time pass on this rank, in which it does not see what comes.
  void spend(int rank, double seconds);
  /// The same in the middle of Worker::work: what has come meanwhile is there for Mail::poll.
  void work_on(int rank, double seconds);
  /// Makes the next message that the rank sends larger than its content.
  void burden(int rank, std::size_t bytes);
  /// s, from 0.
  [[nodiscard]] double now(int rank) const;
  /// Lets the rank have too little memory for what comes: the next calls of Network::receive but
  /// so many work, the one after them throws std::bad_alloc.
  void let_receive_fail(int rank, int num_before);

  /// Executes the workers' tasks, one worker a rank. May be called again: time goes on.
  /// @returns false: stopped or paused.
  /// @throws what the worker of the lowest rank that threw has thrown
  bool run(const std::vector<Worker*>& workers, const ScheduleOptions& options = {});
  /// Now, and the most at one time.
  [[nodiscard]] const UnderWay& under_way() const { return under_way_; }
  [[nodiscard]] const UnderWay& most_under_way() const { return most_under_way_; }
  /// When the last rank left the last run, s.
  [[nodiscard]] double makespan() const { return makespan_; }
  /// Of one rank in the last run.
  [[nodiscard]] const ScheduleReport& report(int rank) const { return reports_[rank]; }

 private:
  class RankNetwork;
  class Fiber;
  struct Event {
    double time;
    std::uint64_t number;
    int rank;
    /// Of a message that arrives; −1: the rank goes on.
    std::int64_t message;
    bool operator<(const Event& other) const;
  };
  struct Rank {
    std::unique_ptr<RankNetwork> network;
    /// Takes the steps of the scheduler.
    std::unique_ptr<Fiber> fiber;
    Scheduler::Step step = Scheduler::Step::busy;
    /// Until when it is busy.
    double clock = 0;
    /// When it goes on next.
    double planned = 0;
    bool idle = false;
    double out_is_free = 0;
    std::size_t burden = 0;
    /// Calls of receive() before one fails; negative: none does.
    int num_sound_calls = -1;
    std::deque<Message> arrived;
  };

  void post(int from, int to, int tag, Bytes content);
  void plan(int rank, double time);
  void add_event(double time, int rank, std::int64_t message);

  Machine machine_;
  std::vector<Rank> ranks_;
  std::priority_queue<Event> events_;
  std::uint64_t num_events_ = 0;
  /// On their way, and the places that are free among them.
  std::vector<Message> messages_;
  std::vector<std::int64_t> free_;
  UnderWay under_way_;
  UnderWay most_under_way_;
  /// When the last message between two ranks arrives, where they do not come in order by
  /// themselves.
  std::unordered_map<std::uint64_t, double> last_arrival_;
  std::uint64_t random_;
  double makespan_ = 0;
  std::vector<ScheduleReport> reports_;
};

}  // namespace palpate::test
