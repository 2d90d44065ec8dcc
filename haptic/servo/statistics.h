// SPDX-License-Identifier: BSD-3-Clause
// How well a servo loop keeps its time, and what it has sent.
#pragma once

#include <array>
#include <cstdint>

#include "haptic/realtime/clock.h"

namespace palpate {

/// Durations by size: buckets of a sixteenth of their size, 1 µs and more fine.
class DurationHistogram;

struct Percentiles {
  Duration median{0};
  Duration p99{0};
  Duration p999{0};
  Duration largest{0};
};

struct Statistics {
  std::uint64_t ticks = 0;
  /// Time since the first tick.
  Duration running{0};
  /// Ticks that should have been and were not: the loop was late by a period or more.
  std::uint64_t missed = 0;
  /// How late ticks began after their time.
  Percentiles lateness;
  /// From the beginning of a tick to its end: with, and without what the device's driver takes.
  Percentiles tick_time;
  Percentiles own_time;
  std::uint64_t reports = 0;
  /// Reports that were none of the profile's: short, or of another number.
  std::uint64_t bad_reports = 0;
  /// Reports that the device counted and that were not read.
  std::uint64_t lost_reports = 0;
  std::uint64_t failed_writes = 0;
  /// Ticks in the state stale.
  std::uint64_t stale_ticks = 0;
  /// Ticks in which the force was cut, held back, or not finite.
  std::uint64_t magnitude_limited = 0;
  std::uint64_t slew_limited = 0;
  std::uint64_t not_finite = 0;
  /// Ticks in which the tool was attached, and the mean and largest force that was sent in them, N.
  std::uint64_t touching_ticks = 0;
  double mean_force = 0;
  double largest_force = 0;
  /// Least of Tick::dissipated, J.
  double least_dissipated = 0;
  /// The thread has real-time priority; its memory is locked.
  bool realtime_priority = false;
  bool memory_locked = false;

  /// Ticks a second.
  [[nodiscard]] double rate() const { return running.count() > 0 ? ticks / seconds(running) : 0; }
};

}  // namespace palpate
