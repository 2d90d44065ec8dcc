// SPDX-License-Identifier: BSD-3-Clause
// How far the ranks are, and whether to go on: not once an abort was asked for on any rank.
#pragma once

#include <cstdint>
#include <map>
#include <utility>

#include "exploration/precompute.h"
#include "schedule/scheduler.h"

namespace palpate {

class Monitor {
 public:
  /// @param network Whose clock it goes by.
  Monitor(Progress progress, const Network& network)
      : progress_(std::move(progress)),
        network_(network),
        start_(network.now()),
        last_sent_(start_) {}

  /// What the homes of a rank know of.
  struct Count {
    std::int64_t found = 0;
    std::int64_t reused = 0;
    std::int64_t expected = 0;
  };
  void set_count(int rank, const Count& count) { of_ranks_[rank] = count; }

  /// While there is a run: what comes from other ranks is served.
  void set_mail(Mail* mail) { mail_ = mail; }

  /// Whether to send the count to rank 0 again.
  [[nodiscard]] bool is_due() {
    if (network_.now() - last_sent_ < kInterval) return false;
    last_sent_ = network_.now();
    return true;
  }

  bool go_on() {
    if (mail_ != nullptr && !mail_->poll()) stopped_ = true;
    if (!stopped_ && progress_ && !progress_(state())) stopped_ = true;
    return !stopped_;
  }

 private:
  /// s
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
  /// Of all ranks on rank 0, elsewhere of this one.
  std::map<int, Count> of_ranks_;
  const Network& network_;
  Mail* mail_ = nullptr;
  double start_;
  double last_sent_;
  bool stopped_ = false;
};

}  // namespace palpate
