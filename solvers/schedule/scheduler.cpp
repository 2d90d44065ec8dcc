// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/scheduler.h"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <limits>
#include <utility>

namespace palpate {
namespace {

enum Tag : int {
  kMail,
  /// The number of bytes of mail that were read.
  kConfirmation,
  kStop,
  kPause,
  /// The answers to a request.
  kShare,
  kRefusal,
  kRequest,
  /// A wave on its way down the tree, and on its way up.
  kWave,
  kLastWave,
  kJoined,
  kLeave,
};

/// Whether messages of a kind can make a rank busy, or follow from one that did. Only these are
/// counted.
bool is_counted(int tag) { return tag <= kShare; }

/// The number of children of a rank in the tree of the waves.
constexpr int kChildren = 4;
/// Pause between two waves while messages are under way, s: long for the network, short for a task.
constexpr double kBetweenWaves = 1e-3;

/// The number of requests that are repeated at once after a refusal.
constexpr int kEarlyTries = 2;
/// Pause after a later refusal, which is doubled each time, s. With the longest pause, a busy rank
/// spends a few µs of each 4 ms on refusals, however many ranks are idle.
constexpr double kShortestPause = 1e-3;
constexpr double kLongestPause = 4e-3;
/// Time without an answer after which another rank is asked too, s: a rank that does not poll
/// answers late. It is not shorter than a common task, or shares would arrive in pairs.
constexpr double kPatience = 50e-3;
constexpr int kMostUnanswered = 4;

template <class T>
Bytes bytes_of(const T& value) {
  Bytes bytes(sizeof value);
  std::memcpy(bytes.data(), &value, sizeof value);
  return bytes;
}

template <class T>
T value_of(const Bytes& bytes) {
  T value;
  std::memcpy(&value, bytes.data(), sizeof value);
  return value;
}

}  // namespace

ScheduleReport& ScheduleReport::operator+=(const ScheduleReport& other) {
  tasks += other.tasks;
  messages += other.messages;
  bytes += other.bytes;
  steals_asked += other.steals_asked;
  steals_granted += other.steals_granted;
  idle_seconds += other.idle_seconds;
  most_queued = std::max(most_queued, other.most_queued);
  most_queued_bytes = std::max(most_queued_bytes, other.most_queued_bytes);
  return *this;
}

bool run(Worker& worker, Communicator& communicator, ScheduleReport* report,
         const ScheduleOptions& options) {
  Network& network = communicator.network();
  Scheduler scheduler(worker, network, options);
  // From here on the ranks wait for each other's messages, so all of them begin or none.
  agree(communicator, [] {});
  agree(communicator, [&] {
    for (;;) {
      Scheduler::Step step = Scheduler::Step::busy;
      try {
        step = scheduler.step();
      } catch (...) {
        // The other ranks wait until this rank has heard of the end too.
        scheduler.fail();
      }
      if (step == Scheduler::Step::over) break;
      if (step == Scheduler::Step::idle) network.rest(scheduler.idle_until());
    }
    network.flush();
    if (report != nullptr) *report = scheduler.report();
    if (scheduler.error()) std::rethrow_exception(scheduler.error());
  });
  return !scheduler.stopped() && !scheduler.paused();
}

ScheduleReport sum(Communicator& communicator, const ScheduleReport& mine) {
  ScheduleReport total;
  for (const Bytes& one : communicator.all_gather(bytes_of(mine))) {
    total += value_of<ScheduleReport>(one);
  }
  return total;
}

Scheduler::Scheduler(Worker& worker, Network& network, const ScheduleOptions& options)
    : worker_(worker),
      network_(network),
      rank_(network.rank()),
      size_(network.size()),
      most_unread_(options.most_unread_bytes),
      pause_(kShortestPause),
      random_(mix(static_cast<std::uint64_t>(rank_))) {
  if (rank_ > 0) parent_ = (rank_ - 1) / kChildren;
  for (std::int64_t i = 1; i <= kChildren; ++i) {
    const std::int64_t child = std::int64_t{kChildren} * rank_ + i;
    if (child < size_) children_.push_back(static_cast<int>(child));
  }
}

Scheduler::Step Scheduler::step() {
  if (!std::exchange(started_, true)) guard([&] { worker_.start(*this); });
  take_in_messages();
  if (over_) return note(Step::over);
  if (stopped_ && !std::exchange(discarded_, true)) guard([&] { worker_.discard(); });
  take_shares();
  deliver();
  if (may_work()) {
    note(Step::busy);
    execute_task();
    return Step::busy;
  }
  if (!inbox_.empty()) return note(Step::busy);
  if (passive()) {
    if (rank_ == 0 && !wave_open_ && network_.now() >= next_wave_) open_wave(false);
    while (may_join_wave()) join_wave();
    if (over_) return note(Step::over);
    if (may_ask() && network_.now() >= next_try_) ask_for_work();
  }
  return note(Step::idle);
}

double Scheduler::idle_until() const {
  double until = std::numeric_limits<double>::infinity();
  if (!passive()) return until;
  if (rank_ == 0 && !wave_open_) until = next_wave_;
  if (may_ask()) until = std::min(until, next_try_);
  return until;
}

Scheduler::Step Scheduler::note(Step step) {
  const bool was_idle = idle_since_ >= 0;
  if (step == Step::idle && !was_idle) idle_since_ = network_.now();
  if (step != Step::idle && was_idle) {
    report_.idle_seconds += network_.now() - std::exchange(idle_since_, -1);
  }
  return step;
}

/// Calls the worker. An exception ends the run.
template <class F>
void Scheduler::guard(F&& call) {
  try {
    call();
  } catch (...) {
    fail();
  }
}

void Scheduler::fail() {
  if (!error_) error_ = std::current_exception();
  // Once this rank has joined the last wave, nothing is left to stop. Other ranks may have left,
  // and would take the message for one of their next run.
  if (!last_wave_ || wave_open_) stop();
}

// Mail

void Scheduler::send(int rank, Bytes message) {
  if (rank == rank_) {
    keep({rank_, kMail, std::move(message)});
    return;
  }
  unread_ += message.size() + kMessageBytes;
  transmit(rank, kMail, std::move(message));
}

bool Scheduler::poll() {
  if (in_task_) take_in_messages();
  return !stopped_;
}

void Scheduler::stop() { spread_stop(rank_); }

void Scheduler::pause() { spread_pause(rank_); }

void Scheduler::transmit(int to, int tag, Bytes content) {
  const std::size_t bytes = content.size();
  network_.send(to, tag, std::move(content));
  ++report_.messages;
  report_.bytes += static_cast<std::int64_t>(bytes);
  if (is_counted(tag)) ++counts_.sent;
}

void Scheduler::take_in_messages() {
  while (auto message = network_.receive()) take_in(std::move(*message));
}

void Scheduler::take_in(Message&& message) {
  if (is_counted(message.tag)) ++counts_.received;
  switch (message.tag) {
    case kMail: keep(std::move(message)); break;
    case kConfirmation: unread_ -= value_of<std::size_t>(message.content); break;
    case kStop: spread_stop(message.from); break;
    case kPause: spread_pause(message.from); break;
    case kShare:
      --num_asked_;
      ++report_.steals_granted;
      last_giver_ = message.from;
      shares_.push_back(std::move(message));
      break;
    case kRefusal: hear_refusal(); break;
    case kRequest: answer(message.from); break;
    case kWave: open_wave(false); break;
    case kLastWave: open_wave(true); break;
    case kJoined: {
      const auto below = value_of<Counts>(message.content);
      wave_.sent += below.sent;
      wave_.received += below.received;
      --num_awaited_;
      break;
    }
    case kLeave: leave(); break;
  }
}

void Scheduler::keep(Message&& mail) {
  inbox_bytes_ += mail.content.size() + kMessageBytes;
  inbox_.push_back(std::move(mail));
  report_.most_queued = std::max(report_.most_queued, static_cast<std::int64_t>(inbox_.size()));
  report_.most_queued_bytes =
      std::max(report_.most_queued_bytes, static_cast<std::int64_t>(inbox_bytes_));
}

/// Delivers the mail that is there now. Mail that this rank sends to itself meanwhile waits for the
/// next call, since it might never end.
void Scheduler::deliver() {
  for (std::size_t n = inbox_.size(); n > 0; --n) {
    const Message mail = std::move(inbox_.front());
    inbox_.pop_front();
    const std::size_t bytes = mail.content.size() + kMessageBytes;
    inbox_bytes_ -= bytes;
    if (!stopped_) guard([&] { worker_.receive(mail.from, mail.content, *this); });
    if (mail.from != rank_) confirm(mail.from, bytes);
  }
}

/// Confirms mail to its sender, but not each message: what all receivers together have read without
/// confirming is at most half of what lets the sender work.
void Scheduler::confirm(int sender, std::size_t bytes) {
  std::size_t& unconfirmed = unconfirmed_[sender];
  unconfirmed += bytes;
  if (unconfirmed < most_unread_ / 2 / static_cast<std::size_t>(size_)) return;
  transmit(sender, kConfirmation, bytes_of(std::exchange(unconfirmed, 0)));
}

void Scheduler::take_shares() {
  while (!shares_.empty()) {
    const Message share = std::move(shares_.front());
    shares_.pop_front();
    if (!stopped_) guard([&] { worker_.take(share.content, *this); });
  }
}

bool Scheduler::may_work() const {
  return !stopped_ && !paused_ && unread_ <= most_unread_ && worker_.has_work();
}

void Scheduler::execute_task() {
  num_tries_ = 0;
  next_try_ = 0;
  pause_ = kShortestPause;
  ++report_.tasks;
  in_task_ = true;
  guard([&] { worker_.work(*this); });
  in_task_ = false;
}

// Stealing

void Scheduler::answer(int asker) {
  Bytes share;
  if (!stopped_ && !paused_ && (in_task_ || worker_.has_work()))
    guard([&] { share = worker_.give(); });
  assert(in_task_ || share.empty() || worker_.has_work());
  const Tag tag = share.empty() ? kRefusal : kShare;
  transmit(asker, tag, std::move(share));
}

bool Scheduler::may_ask() const {
  return num_asked_ < kMostUnanswered && !last_wave_ && !stopped_ && !paused_ && size_ > 1;
}

void Scheduler::ask_for_work() {
  const bool first = num_tries_++ == 0;
  next_try_ = network_.now() + kPatience;
  ++num_asked_;
  ++report_.steals_asked;
  transmit(first && last_giver_ >= 0 ? last_giver_ : random_rank(), kRequest, {});
}

void Scheduler::hear_refusal() {
  --num_asked_;
  if (num_tries_ < kEarlyTries) {
    next_try_ = 0;
  } else {
    next_try_ = std::min(next_try_, network_.now() + pause_);
    pause_ = std::min(2 * pause_, kLongestPause);
  }
}

/// A random rank other than this one.
int Scheduler::random_rank() {
  const int other = owner_of(++random_, size_ - 1);
  return other < rank_ ? other : other + 1;
}

// Termination

bool Scheduler::passive() const {
  const bool ends = stopped_ || paused_;
  return inbox_.empty() && shares_.empty() && (ends || !worker_.has_work());
}

void Scheduler::open_wave(bool last) {
  wave_open_ = true;
  last_wave_ = last;
  num_awaited_ = static_cast<int>(children_.size());
  wave_ = {};
  for (const int child : children_) transmit(child, last ? kLastWave : kWave, {});
}

bool Scheduler::may_join_wave() const {
  return wave_open_ && num_awaited_ == 0 && (!last_wave_ || num_asked_ == 0);
}

void Scheduler::join_wave() {
  wave_open_ = false;
  wave_.sent += counts_.sent;
  wave_.received += counts_.received;
  rank_ == 0 ? end_wave() : transmit(parent_, kJoined, bytes_of(wave_));
}

void Scheduler::end_wave() {
  if (last_wave_) {
    leave();
  } else if (has_previous_ && previous_wave_.received == wave_.sent) {
    open_wave(true);
  } else {
    has_previous_ = true;
    previous_wave_ = wave_;
    if (wave_.received == wave_.sent) {
      open_wave(false);
    } else {
      next_wave_ = network_.now() + kBetweenWaves;
    }
  }
}

void Scheduler::leave() {
  for (const int child : children_) transmit(child, kLeave, {});
  over_ = true;
}

/// Spreads over the tree that the run stops, away from the rank that has told this one.
void Scheduler::spread_stop(int heard_from) {
  if (!std::exchange(stopped_, true)) spread(kStop, heard_from);
}

void Scheduler::spread_pause(int heard_from) {
  if (!std::exchange(paused_, true)) spread(kPause, heard_from);
}

void Scheduler::spread(int tag, int heard_from) {
  if (rank_ > 0 && parent_ != heard_from) transmit(parent_, tag, {});
  for (const int child : children_) {
    if (child != heard_from) transmit(child, tag, {});
  }
}

}  // namespace palpate
