// SPDX-License-Identifier: BSD-3-Clause
// Time as the servo loop sees it: a real clock, or a virtual one that tests advance.
#pragma once

#include <chrono>

namespace palpate {

/// A time since the origin of the clock that gave it.
using Time = std::chrono::nanoseconds;
using Duration = std::chrono::nanoseconds;

/// A duration in s.
[[nodiscard]] constexpr double seconds(Duration d) { return 1e-9 * static_cast<double>(d.count()); }

class Clock {
 public:
  virtual ~Clock() = default;
  /// @note Realtime-safe.
  [[nodiscard]] virtual Time now() noexcept = 0;
  /// Sleeps until a time, and returns at once where that time is past.
  virtual void sleep_until(Time time) noexcept = 0;
};

/// The monotonic clock of the system, which does not jump when the time of day is set.
class MonotonicClock final : public Clock {
 public:
  Time now() noexcept override;
  void sleep_until(Time time) noexcept override;
};

/// A clock that moves only in sleep_until() and advance(). A test with it takes no time and runs
/// the same way each time.
class VirtualClock final : public Clock {
 public:
  Time now() noexcept override { return now_; }
  void sleep_until(Time time) noexcept override {
    if (time > now_) now_ = time;
  }
  void advance(Duration duration) noexcept { now_ += duration; }

 private:
  Time now_{0};
};

}  // namespace palpate
