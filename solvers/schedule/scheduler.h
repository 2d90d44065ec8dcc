// SPDX-License-Identifier: BSD-3-Clause
// Transposition-driven scheduling [TDS] of opaque tasks on all ranks: no master, no barrier, and no
// rank waits for an answer.
//
// Mail. A message about a state is sent to the owner rank of the state, which follows from the hash
// of its key (owner.h); so the owner knows of duplicates. Mail is delivered between tasks, before
// the next task begins.
//
// Stealing. Hashing alone leaves ranks idle, so a rank without work asks others for a share of
// theirs: first the rank that gave last, then random ranks, with a pause of a few ms after a
// refusal. Since it pauses, and since its request may go to any rank, the many idle ranks at the
// end do not drown the few busy ones: on average a busy rank is asked as often as an idle rank
// asks. If a request stays unanswered for long, because the other rank does not poll, a further
// rank is asked. Lifelines [LGB], over which a rank that has got work shares it with neighbours
// that asked before, were slower in the simulator and moved four times as many shares: many went to
// ranks that had got work meanwhile.
//
// Termination. The four-counter method [Mattern, section 4] sends waves over a tree of all ranks.
// Each rank joins a wave once it has neither work nor mail, and adds the numbers of messages that
// it has sent and received. If the number received by one wave equals the number sent by the next,
// then at the end of the first no message was under way and no rank was busy. Requests for work and
// refusals are not counted, since they make no rank busy. One more wave, which a rank joins when
// its own requests are answered, makes sure that no message at all is left. A wave waits at a busy
// rank, so there are few waves.
//
// Memory. The tasks are the worker's own matter. A rank executes no task while more than
// ScheduleOptions::most_unread_bytes of the mail that it has sent is unread; receivers confirm what
// they have read. So all ranks together hold at most P times this, plus the messages of one task
// and of the replies to them. At most one share is under way to a rank for each of its unanswered
// requests, of which there are at most four.
//
// [TDS] Romein, Plaat, Bal, Schaeffer, Transposition Table Driven Work Scheduling in Distributed
// Search, AAAI 1999.
// [LGB] Saraswat, Kambadur, Kodali, Grove, Krishnamoorthy, Lifeline-based Global Load Balancing,
// PPoPP 2011.
// [Mattern] F. Mattern, Algorithms for Distributed Termination Detection, Distributed Computing 2,
// 1987.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <exception>
#include <unordered_map>
#include <vector>

#include "schedule/communicator.h"
#include "schedule/network.h"
#include "schedule/worker.h"

namespace palpate {

struct ScheduleOptions {
  /// The largest amount of mail of a rank that its receivers have not read, bytes; each message
  /// counts kMessageBytes more than its content.
  std::size_t most_unread_bytes = 16 << 20;
};

/// Bytes that a message counts besides its content.
inline constexpr std::size_t kMessageBytes = 64;

/// What one rank has done, or several together.
struct ScheduleReport {
  std::int64_t tasks = 0;
  /// Messages of all kinds that were sent, and the bytes of their contents.
  std::int64_t messages = 0;
  std::int64_t bytes = 0;
  /// Requests for work, and those among them that brought a share.
  std::int64_t steals_asked = 0;
  std::int64_t steals_granted = 0;
  /// Time without work, s.
  double idle_seconds = 0;
  /// The most mail that was unread at one time, messages and bytes (with kMessageBytes each).
  std::int64_t most_queued = 0;
  std::int64_t most_queued_bytes = 0;

  /// Adds the figures; of the last two it takes the larger.
  ScheduleReport& operator+=(const ScheduleReport& other);
};

/// Executes the workers' tasks until no rank has work and no message is under way.
/// @returns false: the run was stopped or paused. It is the same on every rank.
/// @param report Receives the figures of this rank.
/// @note Collective. A worker's error is thrown on all ranks, see agree().
[[nodiscard]] bool run(Worker& worker, Communicator& communicator, ScheduleReport* report = nullptr,
                       const ScheduleOptions& options = {});

/// Gives every rank the sum over all ranks.
/// @note Collective
[[nodiscard]] ScheduleReport sum(Communicator& communicator, const ScheduleReport& mine);

/// The state machine of one rank behind run().
class Scheduler final : private Mail {
 public:
  Scheduler(Worker& worker, Network& network, const ScheduleOptions& options);

  enum class Step {
    busy,
    idle,  ///< Nothing to do before idle_until() unless a message comes.
    over,  ///< On all ranks; nothing is under way.
  };
  /// Takes in the messages that have come, and executes at most one task.
  Step step();
  /// Takes the exception that is being handled as the error of this rank, and stops all ranks. Go
  /// on to call step() until the run is over.
  void fail();
  /// A time by the clock of the network, which may be infinite.
  [[nodiscard]] double idle_until() const;

  /// Whether the run has ended early.
  [[nodiscard]] bool stopped() const { return stopped_; }
  [[nodiscard]] bool paused() const { return paused_; }
  /// What the worker threw on this rank; null if it threw nothing.
  [[nodiscard]] std::exception_ptr error() const { return error_; }
  [[nodiscard]] const ScheduleReport& report() const { return report_; }

 private:
  struct Counts {
    std::uint64_t sent = 0;
    std::uint64_t received = 0;
  };

  // Mail
  [[nodiscard]] int rank() const override { return rank_; }
  [[nodiscard]] int size() const override { return size_; }
  void send(int rank, Bytes message) override;
  bool poll() override;
  void stop() override;
  void pause() override;

  template <class F>
  void guard(F&& call);
  void transmit(int to, int tag, Bytes content);
  void take_in_messages();
  void take_in(Message&& message);
  void keep(Message&& mail);
  void deliver();
  void confirm(int sender, std::size_t bytes);
  void take_shares();
  [[nodiscard]] bool may_work() const;
  void execute_task();
  Step note(Step step);

  // Stealing
  void answer(int asker);
  [[nodiscard]] bool may_ask() const;
  void ask_for_work();
  void hear_refusal();
  [[nodiscard]] int random_rank();

  // Termination
  [[nodiscard]] bool passive() const;
  void open_wave(bool last);
  [[nodiscard]] bool may_join_wave() const;
  void join_wave();
  void end_wave();
  void leave();
  void spread_stop(int heard_from);
  void spread_pause(int heard_from);
  void spread(int tag, int heard_from);

  Worker& worker_;
  Network& network_;
  const int rank_;
  const int size_;
  const std::size_t most_unread_;
  ScheduleReport report_;
  bool started_ = false;
  bool in_task_ = false;
  bool stopped_ = false;
  bool paused_ = false;
  bool discarded_ = false;
  bool over_ = false;
  std::exception_ptr error_;
  /// Time at which the rank became idle; negative: it is not idle.
  double idle_since_ = -1;

  /// Mail that waits for the end of a task, and its bytes, with kMessageBytes for each message.
  std::deque<Message> inbox_;
  std::size_t inbox_bytes_ = 0;
  std::deque<Message> shares_;
  /// Bytes of mail from this rank that other ranks have not confirmed as read.
  std::size_t unread_ = 0;
  /// Bytes of mail that were read here and not confirmed yet, by sender.
  std::unordered_map<int, std::size_t> unconfirmed_;

  /// The number of own requests that are not answered yet.
  int num_asked_ = 0;
  int last_giver_ = -1;
  /// The number of requests since this rank last had work.
  int num_tries_ = 0;
  double next_try_ = 0;
  double pause_;
  std::uint64_t random_;

  /// Numbers of those messages that can make a rank busy.
  Counts counts_;
  int parent_ = -1;
  std::vector<int> children_;
  bool wave_open_ = false;
  bool last_wave_ = false;
  /// The number of children that have not joined the wave yet.
  int num_awaited_ = 0;
  Counts wave_;
  // On rank 0.
  bool has_previous_ = false;
  Counts previous_wave_;
  double next_wave_ = 0;
};

}  // namespace palpate
