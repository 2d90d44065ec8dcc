// SPDX-License-Identifier: BSD-3-Clause
// A monitor reports the progress of all ranks to the user, and tells the solvers when to stop: when
// an abort was asked for on any rank. It pauses the run when that was asked for.
#pragma once

#include <cstdint>
#include <map>
#include <utility>

#include "exploration/progress.h"
#include "schedule/packing.h"
#include "schedule/scheduler.h"

namespace palpate {

class Monitor {
 public:
  /// @param network The monitor goes by its clock.
  Monitor(Progress progress, const Network& network)
      : progress_(std::move(progress)),
        network_(network),
        start_(network.now()),
        last_sent_(start_) {}

  /// What a rank knows: configurations that were found in this run or an earlier one, those among
  /// them from an earlier run, and those that are expected in all.
  struct Count {
    std::int64_t found = 0;
    std::int64_t reused = 0;
    std::int64_t expected = 0;

    template <class Visit>
    friend void for_each_part(Count& count, Visit&& visit) {
      visit(count.found);
      visit(count.reused);
      visit(count.expected);
    }
  };
  /// Set the mailbox at the start of a run, and null at its end. In between, go_on() serves
  /// messages of other ranks.
  void set_mail(Mail* mail) { mail_ = mail; }
  /// The mailbox; null: no run is going on.
  [[nodiscard]] Mail* mail() const { return mail_; }
  /// Pauses the run when `until` says so; empty: it never does.
  void pause_when(Until until) { until_ = std::move(until); }

  /// Stores the progress of this rank, and sends it to rank 0 every kInterval. Call this during a
  /// run.
  /// @param message The beginning of the message, by which the worker recognises it.
  void tell(const Count& count, Packer message = {}) {
    of_ranks_[mail_->rank()] = count;
    if (mail_->rank() == 0 || network_.now() - last_sent_ < kInterval) return;
    last_sent_ = network_.now();
    message.put(count);
    mail_->send(0, message.take());
  }
  /// Stores the progress that another rank has sent.
  void hear(int from, Unpacker& message) { of_ranks_[from] = message.take<Count>(); }

  bool go_on() {
    if (mail_ != nullptr && !mail_->poll()) stopped_ = true;
    if (!stopped_ && progress_ && !progress_(state())) stopped_ = true;
    if (!stopped_ && mail_ != nullptr && until_ && until_(state())) {
      until_ = {};
      mail_->pause();
    }
    return !stopped_;
  }

 private:
  /// The time between two messages of a rank to rank 0, s.
  static constexpr double kInterval = 0.5;

  [[nodiscard]] ProgressState state() const {
    ProgressState state;
    for (const auto& [rank, count] : of_ranks_) {
      state.num_done += count.found;
      state.num_expected += count.expected;
      state.num_solved += count.found - count.reused;
    }
    state.seconds = network_.now() - start_;
    const auto solved = static_cast<double>(state.num_solved);
    if (solved > 0) {
      state.seconds_left =
          state.seconds / solved * static_cast<double>(state.num_expected - state.num_done);
    }
    return state;
  }

  Progress progress_;
  Until until_;
  /// On rank 0 the counts of all ranks, elsewhere that of this one.
  std::map<int, Count> of_ranks_;
  const Network& network_;
  Mail* mail_ = nullptr;
  double start_;
  double last_sent_;
  bool stopped_ = false;
};

}  // namespace palpate
