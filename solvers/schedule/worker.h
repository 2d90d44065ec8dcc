// SPDX-License-Identifier: BSD-3-Clause
// What a user of the scheduler implements (Worker), and what the scheduler offers to it (Mail).
#pragma once

#include <cstdint>

#include "schedule/network.h"
#include "schedule/owner.h"

namespace palpate {

/// The mailbox through which a worker sends messages.
class Mail {
 public:
  [[nodiscard]] virtual int rank() const = 0;
  [[nodiscard]] virtual int size() const = 0;

  /// Sends a message, which Worker::receive of that rank takes later. The rank may be this one; the
  /// message is never delivered from within this call. Messages to one rank arrive in the order in
  /// which they were sent.
  virtual void send(int rank, Bytes message) = 0;
  /// Sends a message to the owner of a key.
  void send_to_owner(std::uint64_t key, Bytes message) {
    send(owner_of(key, size()), std::move(message));
  }

  /// Call this repeatedly within a long Worker::work. It gives tasks to ranks that have none, by
  /// Worker::give, and forwards the messages that keep the run going. It delivers nothing to this
  /// rank: Worker::receive and Worker::take wait for the end of the task.
  /// @returns false: the run ends early. The task may give up, since its result is not needed.
  virtual bool poll() = 0;

  /// Ends the run early, on all ranks.
  virtual void stop() = 0;
  /// Ends the run before its tasks are done, on all ranks, and loses nothing: no task begins any
  /// more, tasks that are being executed are completed, and all mail is delivered. Another run of
  /// the same workers goes on with the tasks that are left.
  virtual void pause() = 0;

 protected:
  Mail() = default;
  ~Mail() = default;
  Mail(const Mail&) = delete;
  Mail& operator=(const Mail&) = delete;
};

/// The tasks of one rank, and what they mean. All functions are called on the thread of run(), one
/// at a time; give() may also be called from within Mail::poll(). An exception ends the run on all
/// ranks.
class Worker {
 public:
  virtual ~Worker() = default;

  /// Called before all other functions.
  virtual void start(Mail&) {}

  /// Takes a message of the rank `from`. It is called between tasks and must be cheap, since it is
  /// no task.
  virtual void receive(int from, const Bytes& message, Mail& mail) = 0;

  /// Whether there is a task to be executed. The answer may change only within functions of this
  /// class. A rank without tasks and without messages is idle.
  [[nodiscard]] virtual bool has_work() const = 0;
  /// Executes one task.
  virtual void work(Mail& mail) = 0;

  /// Removes about half of this rank's tasks and returns them, for a rank that has none; empty:
  /// none can be spared. Within a task (from Mail::poll) all other tasks may be given. Between
  /// tasks one must stay, or it could travel from rank to rank without being executed.
  [[nodiscard]] virtual Bytes give() = 0;
  /// Takes tasks that give() of another rank has returned. This rank may have tasks already.
  virtual void take(const Bytes& share, Mail& mail) = 0;

  /// Drops all tasks, since the run ends early. No other function is called afterwards.
  virtual void discard() = 0;

 protected:
  Worker() = default;
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;
};

}  // namespace palpate
