// SPDX-License-Identifier: BSD-3-Clause
// What the guardian does and when, without the system: palpate_guardian/main.cpp waits and writes.
#pragma once

#include <optional>

#include "haptic/guardian/channel.h"

namespace palpate {

class Watch {
 public:
  /// Between zero reports, as long as a trip is new and later on.
  static constexpr Duration kZeroPeriod = std::chrono::milliseconds(2);
  static constexpr Duration kSlowZeroPeriod = std::chrono::milliseconds(20);
  static constexpr Duration kNew = std::chrono::milliseconds(100);
  /// Zero reports that the device has to have taken after the host has died.
  static constexpr int kLastZeros = 3;

  /// How the process that the loop runs in is doing.
  enum class Host {
    running,
    /// It has said that it needs no guardian any more.
    finished,
    /// It ended without a word.
    dead,
  };

  struct Step {
    enum class Action { none, zero, end };
    Action action = Action::none;
    /// Until the next look at the latest.
    Duration wait{0};
  };

  explicit Watch(GuardianChannel& channel) : channel_(channel) {}

  [[nodiscard]] Step look(Time now, Host host) noexcept;
  /// The device has taken a zero report.
  void zero_was_taken() noexcept { ++num_taken_; }

 private:
  GuardianChannel& channel_;
  /// When the trip was latched that is not acknowledged.
  std::optional<Time> tripped_at_;
  bool host_was_dead_ = false;
  /// Zero reports since the host has died.
  int num_taken_ = 0;
};

}  // namespace palpate
