// SPDX-License-Identifier: BSD-3-Clause
// Decides what the guardian does and when. It makes no system call itself:
// palpate_guardian/main.cpp waits and writes.
#pragma once

#include <optional>

#include "haptic/guardian/channel.h"

namespace palpate {

class Watch {
 public:
  /// The time from one zero report to the next while a trip is new, the same later on, and how long
  /// a trip counts as new.
  static constexpr Duration kZeroPeriod = std::chrono::milliseconds(2);
  static constexpr Duration kSlowZeroPeriod = std::chrono::milliseconds(20);
  static constexpr Duration kNew = std::chrono::milliseconds(100);
  /// The number of zero reports that the device must take after the host has died.
  static constexpr int kLastZeros = 3;

  /// The state of the process that the loop runs in.
  enum class Host {
    running,
    /// HostWatch finds that it hangs; it may go on.
    hanging,
    /// It has said that it no longer needs a guardian.
    finished,
    /// It ended without a word.
    dead,
  };

  struct Step {
    enum class Action { none, zero, end };
    Action action = Action::none;
    /// The longest time until the next look.
    Duration wait{0};
  };

  explicit Watch(GuardianChannel& channel) : channel_(channel) {}

  [[nodiscard]] Step look(Time now, Host host) noexcept;
  /// Says that the device has taken a zero report.
  void zero_was_taken() noexcept { ++num_taken_; }

 private:
  GuardianChannel& channel_;
  /// When the trip that is not acknowledged was latched.
  std::optional<Time> tripped_at_;
  bool host_was_dead_ = false;
  /// The number of zero reports that were taken since the host has died.
  int num_taken_ = 0;
};

}  // namespace palpate
