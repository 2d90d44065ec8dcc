// SPDX-License-Identifier: BSD-3-Clause
// Runs the scheduler of scheduler.h, the same code, on many ranks of a machine that is not there: a
// discrete-event simulation in one process. Time is the machine's; nothing depends on how fast this
// one is, and the same input gives the same result.
//
// Besides it foretells how long a forest of tasks of known cost takes, with transposition-driven
// scheduling and with two others.
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

namespace palpate {

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

class Simulation {
 public:
  Simulation(int num_ranks, const Machine& machine);
  ~Simulation();

  [[nodiscard]] int size() const { return static_cast<int>(ranks_.size()); }

  // For a worker, within its functions:
  /// Lets time pass on this rank; in Worker::work: the task, or what it does until it would poll.
  void spend(int rank, double seconds);
  /// Makes the next message that the rank sends larger than its content.
  void burden(int rank, std::size_t bytes);
  /// s, from 0.
  [[nodiscard]] double now(int rank) const;

  /// Executes the workers' tasks, one worker a rank. May be called again: time goes on.
  /// @returns false: stopped.
  /// @throws what the worker of the lowest rank that threw has thrown
  bool run(const std::vector<Worker*>& workers, const ScheduleOptions& options = {});
  /// Messages that were sent and not received.
  [[nodiscard]] std::size_t num_under_way() const;
  /// When the last rank left the last run, s.
  [[nodiscard]] double makespan() const { return makespan_; }
  /// Of one rank in the last run.
  [[nodiscard]] const ScheduleReport& report(int rank) const { return reports_[rank]; }

 private:
  class RankNetwork;
  struct Event {
    double time;
    std::uint64_t number;
    int rank;
    /// Of a message that arrives; −1: the rank takes a step.
    std::int64_t message;
    bool operator<(const Event& other) const;
  };
  struct Rank {
    std::unique_ptr<RankNetwork> network;
    /// Until when it is busy.
    double clock = 0;
    /// Of its next step.
    double planned = 0;
    bool idle = false;
    double out_is_free = 0;
    std::size_t burden = 0;
    std::deque<Message> arrived;
  };

  void post(int from, int to, int tag, Bytes content);
  void plan(int rank, double time);
  void add_event(double time, int rank, std::int64_t message);

  Machine machine_;
  std::vector<Rank> ranks_;
  std::priority_queue<Event> events_;
  std::uint64_t num_events_ = 0;
  /// Under way, and the places that are free among them.
  std::vector<Message> messages_;
  std::vector<std::int64_t> free_;
  /// When the last message between two ranks arrives, where they do not come in order by
  /// themselves.
  std::unordered_map<std::uint64_t, double> last_arrival_;
  std::uint64_t random_;
  double makespan_ = 0;
  std::vector<ScheduleReport> reports_;
};

/// Tasks that follow from each other, of one active node say: each starts from the state that its
/// parent has found.
struct TaskTree {
  /// Of each task, s.
  std::vector<double> seconds;
  /// Comes before the task; −1 for task 0 alone.
  std::vector<int> parent;
};

struct Forest {
  std::vector<TaskTree> trees;
  /// Of each site, index into trees.
  std::vector<int> tree_of_site;

  [[nodiscard]] std::int64_t num_tasks() const;
  /// Of all tasks, s.
  [[nodiscard]] double work() const;
  /// Of the longest path from a root to a leaf, s: no number of ranks is faster.
  [[nodiscard]] double critical_path() const;
};

/// @throws InputError a tree without tasks, a parent that does not come before, a cost below 0, a
///   tree that is not there.
void validate(const Forest& forest);

struct ForestOptions {
  Machine machine;
  ScheduleOptions schedule;
  /// A busy rank polls so often at the least: the length of a factorisation, s.
  double poll_interval = 25e-3;
  /// The state that a task starts from where it is sent with it.
  std::size_t state_bytes = 200'000;
  /// Before the first task of a share that starts from a state: its factorisation, which the giver
  /// has, s.
  double start_seconds = 25e-3;
  /// What is posted to the home of a state that was found.
  std::size_t summary_bytes = 300;
};

struct ForestResult {
  double makespan = 0;
  /// Of the tasks that were executed, s.
  double work = 0;
  std::int64_t tasks = 0;
  /// work / (ranks · makespan)
  double efficiency = 0;
  /// Of all ranks; empty where the scheduler does not run.
  ScheduleReport report;
};

/// Each rank executes depth first what follows from its own tasks, at the start those of the sites
/// that are at home there; a share is half of what waits at the far end. A task is followed by a
/// summary to the home of its state.
[[nodiscard]] ForestResult simulate_tds(const Forest& forest, int num_ranks,
                                        const ForestOptions& options);

enum class StaticShare { round_robin, by_hash };
/// Each site is one rank's; there are no messages.
[[nodiscard]] ForestResult simulate_static(const Forest& forest, int num_ranks, StaticShare share);

/// Rank 0 hands out the tasks, one at a time, oldest first, and executes none (unless it is alone).
/// A rank goes on with the first child of what it has done, for which it has the state; where there
/// are more, the state goes to rank 0 and from there out with each of them.
[[nodiscard]] ForestResult simulate_master_worker(const Forest& forest, int num_ranks,
                                                  const ForestOptions& options);

}  // namespace palpate
