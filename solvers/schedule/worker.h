// SPDX-License-Identifier: BSD-3-Clause
// What a user of the scheduler implements, and what the scheduler gives for it.
#pragma once

#include <cstdint>

#include "schedule/network.h"
#include "schedule/owner.h"

namespace palpate {

/// The way out of a worker's member functions.
class Mail {
 public:
  [[nodiscard]] virtual int rank() const = 0;
  [[nodiscard]] virtual int size() const = 0;

  /// Posts a message: Worker::receive gets it there, later; also on this rank, and never from
  /// within this call. Messages to one rank arrive in the order in which they were posted.
  virtual void send(int rank, Bytes message) = 0;
  /// The same, to the owner of a key.
  void send_to_owner(std::uint64_t key, Bytes message) {
    send(owner_of(key, size()), std::move(message));
  }

  /// Call this now and then within Worker::work where a task is long: it gives tasks to ranks that
  /// have none, through Worker::give, and hands on what keeps the run going. Delivers nothing to
  /// this rank: Worker::receive and Worker::take wait for the end of the task.
  /// @returns false when the run is to end early: the task may give up, its result is not needed.
  virtual bool poll() = 0;

  /// Ends the run early, on all ranks.
  virtual void stop() = 0;

 protected:
  Mail() = default;
  ~Mail() = default;
  Mail(const Mail&) = delete;
  Mail& operator=(const Mail&) = delete;
};

/// The tasks of one rank, and what they mean. All functions are called on the thread of run(), one
/// at a time, but give() also from within Mail::poll(). What they throw ends the run on all ranks.
class Worker {
 public:
  virtual ~Worker() = default;

  /// This is called before all other functions.
  virtual void start(Mail&) {}

  /// A message has come that `from` posted. To be cheap: it is no task. Comes between tasks, and
  /// before the next one.
  virtual void receive(int from, const Bytes& message, Mail& mail) = 0;

  /// There is a task to be executed. Changes only in the functions of this class: a rank without
  /// work and without messages is idle.
  [[nodiscard]] virtual bool has_work() const = 0;
  /// Executes one task.
  virtual void work(Mail& mail) = 0;

  /// Splits off about half of this rank's tasks for one that has none; empty: none can be spared.
  /// Within a task (from Mail::poll) the others may all go; between tasks one must stay, or it
  /// could travel from rank to rank and never be executed.
  [[nodiscard]] virtual Bytes give() = 0;
  /// Takes what give() of another rank has split off. There may be tasks here already.
  virtual void take(const Bytes& share, Mail& mail) = 0;

  /// The run ends early: drops all tasks. Nothing else is called afterwards.
  virtual void discard() = 0;

 protected:
  Worker() = default;
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;
};

}  // namespace palpate
