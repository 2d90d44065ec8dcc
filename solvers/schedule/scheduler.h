// SPDX-License-Identifier: BSD-3-Clause
// Transposition-driven scheduling [TDS] of opaque tasks on all ranks: no master, no barrier, and no
// rank waits for an answer.
//
// Mail. What concerns a state is posted to its owner rank, the hash of its key (owner.h),
// which so knows of duplicates. It is delivered between tasks, before the next one.
//
// Stealing. Hashing alone leaves ranks idle, so a rank without work asks others for a share of
// theirs: first the one that gave last, then one at random after the other, with a pause of a few
// ms where it is refused. Because of the pauses, and since a request may go to any rank, the many
// that are idle at the end do not drown the few that are busy: each of these is asked as often as
// each idle rank asks. Where a request stays unanswered for long, since the other one does not
// poll, a next one is asked as well. In the simulator, lifelines [LGB], over which a rank that has
// got work shares it with neighbours that asked before, took longer and moved four times as many
// shares: many went to ranks that had got work meanwhile.
//
// Termination. The four-counter method [Mattern, section 4]: waves run over a tree of all ranks;
// each rank joins a wave once it has neither work nor mail, with the numbers of messages that it
// has sent and received. Once as many had been received in a wave as had been sent in the next one,
// nothing was under way and nobody busy at the end of the former. Requests for work and refusals
// are not counted, since they make nobody busy; so one more wave, which a rank joins when its
// requests are answered, sees to it that no message at all is left behind. A wave waits at a busy
// rank, so there are few.
//
// Memory. The worker's tasks are its own matter. A rank executes no task while more than
// ScheduleOptions::most_unread_bytes of its mail lie unread at their receivers (who tell the
// sender): so all ranks together hold at most P times as much, and what one task and the answers to
// its messages post. Of shares at most one for each unanswered request is under way to a rank, of
// which there are four at most.
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
  /// Of a rank's mail that its receivers have not read; each message counts kMessageBytes more than
  /// its content.
  std::size_t most_unread_bytes = 16 << 20;
};

/// Counted for a message besides its content.
inline constexpr std::size_t kMessageBytes = 64;

/// What one rank has done, or what several have done together.
struct ScheduleReport {
  std::int64_t tasks = 0;
  /// Sent, of all kinds, and their contents.
  std::int64_t messages = 0;
  std::int64_t bytes = 0;
  /// Requests for work sent, and those that brought a share.
  std::int64_t steals_asked = 0;
  std::int64_t steals_granted = 0;
  /// Time without work, s.
  double idle_seconds = 0;
  /// Most mail that lay unread at one time, messages and bytes (with kMessageBytes each).
  std::int64_t most_queued = 0;
  std::int64_t most_queued_bytes = 0;

  /// Adds; of the last two, the larger.
  ScheduleReport& operator+=(const ScheduleReport& other);
};

/// Executes the workers' tasks until no rank has work and no message is under way.
/// @returns false: it was stopped. The same on every rank.
/// @param report Of this rank.
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
  /// Takes in what has come, and executes one task at the most.
  Step step();
  /// Takes the exception that is being handled for the error of this rank, and stops all. step() is
  /// to be called on until all is over.
  void fail();
  /// A time by the clock of the network, which may be infinite.
  [[nodiscard]] double idle_until() const;

  [[nodiscard]] bool stopped() const { return stopped_; }
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
  void conclude_wave();
  void leave();
  void spread_stop(int heard_from);

  Worker& worker_;
  Network& network_;
  const int rank_;
  const int size_;
  const std::size_t most_unread_;
  ScheduleReport report_;
  bool started_ = false;
  bool in_task_ = false;
  bool stopped_ = false;
  bool discarded_ = false;
  bool over_ = false;
  std::exception_ptr error_;
  /// Since when; negative: not idle.
  double idle_since_ = -1;

  /// Mail that waits for the end of a task, and its bytes with kMessageBytes each.
  std::deque<Message> inbox_;
  std::size_t inbox_bytes_ = 0;
  std::deque<Message> shares_;
  /// Bytes of this rank's mail that are unread at others.
  std::size_t unread_ = 0;
  /// Bytes of each rank's mail that were read here without its knowing.
  std::unordered_map<int, std::size_t> unconfirmed_;

  /// Requests that are not answered yet.
  int num_asked_ = 0;
  int last_giver_ = -1;
  /// Since there was work last.
  int num_tries_ = 0;
  double next_try_ = 0;
  double pause_;
  std::uint64_t random_;

  /// These count the messages that can make a rank busy.
  Counts counts_;
  int parent_ = -1;
  std::vector<int> children_;
  bool wave_open_ = false;
  bool last_wave_ = false;
  /// Children that have not joined yet.
  int num_awaited_ = 0;
  Counts wave_;
  // On rank 0.
  bool has_previous_ = false;
  Counts previous_wave_;
  double next_wave_ = 0;
};

}  // namespace palpate
