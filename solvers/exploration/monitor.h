// SPDX-License-Identifier: BSD-3-Clause
// Reports progress, and knows whether to go on: not once an abort was asked for on any rank.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>

#include "exploration/precompute.h"
#include "schedule/communicator.h"

namespace palpate {

class Monitor {
 public:
  Monitor(Progress progress, Communicator& communicator)
      : progress_(std::move(progress)), communicator_(communicator) {}

  void expect(std::int64_t num_configurations) { num_expected_ = num_configurations; }
  void solved_one() { ++num_done_here_; }
  /// What all ranks have done is known.
  void set_done(std::int64_t num_configurations) {
    num_done_ = num_configurations;
    num_done_here_ = 0;
  }

  bool go_on() {
    if (stopped_) return false;
    const auto done = static_cast<double>(num_done_ + num_done_here_ * communicator_.size());
    if (progress_ && !progress_(std::min(1.0, done / static_cast<double>(num_expected_)))) {
      communicator_.ask_to_stop();
      stopped_ = true;
    }
    stopped_ = stopped_ || communicator_.stop_asked();
    return !stopped_;
  }

 private:
  Progress progress_;
  Communicator& communicator_;
  std::int64_t num_expected_ = 1;
  std::int64_t num_done_ = 0;
  /// On this rank, in the batch that is being made.
  std::int64_t num_done_here_ = 0;
  bool stopped_ = false;
};

}  // namespace palpate
