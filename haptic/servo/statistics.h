// SPDX-License-Identifier: BSD-3-Clause
// How well a servo loop keeps its time, and which forces it has sent.
#pragma once

#include <cstdint>

#include "haptic/realtime/clock.h"
#include "haptic/realtime/histogram.h"

namespace palpate {

/// What is counted from tick to tick.
struct Counters {
  std::uint64_t ticks = 0;
  /// Time from the beginning of the first tick to that of the last.
  Duration running{0};
  /// Ticks that were missed because the loop was late by a period or more.
  std::uint64_t missed = 0;
  std::uint64_t reports = 0;
  /// Reports that the profile does not recognise, because they are too short or have another
  /// number.
  std::uint64_t bad_reports = 0;
  /// Reports that the device has counted and that were not read.
  std::uint64_t lost_reports = 0;
  std::uint64_t failed_reads = 0;
  std::uint64_t failed_writes = 0;
  /// Ticks in the state stale.
  std::uint64_t stale_ticks = 0;
  /// Ticks in which the interlock was tripped, and the number of trips by each cause (namespace
  /// trips).
  std::uint64_t tripped_ticks = 0;
  std::uint64_t trips_by_stale_reports = 0;
  std::uint64_t trips_by_failed_writes = 0;
  std::uint64_t trips_by_disengaging = 0;
  std::uint64_t trips_by_guardian = 0;
  std::uint64_t trips_by_body = 0;
  /// Ticks in which the force was above its limit, changed too fast, or was not finite.
  std::uint64_t magnitude_limited = 0;
  std::uint64_t slew_limited = 0;
  std::uint64_t not_finite = 0;
  /// Ticks in which the tool touched, the sum of the forces that were sent in them, and the
  /// largest force that was ever sent, N at the device.
  std::uint64_t touching_ticks = 0;
  double sum_of_forces = 0;
  double largest_force = 0;
  /// The least Tick::dissipated, J.
  double least_dissipated = 0;
  /// Ticks in which the passivity controller added damping.
  std::uint64_t damped_ticks = 0;
  /// Ticks in which a reduced body was held beyond what its model was trained for
  /// (kLargestTrusted).
  std::uint64_t untrusted_ticks = 0;
  /// Ticks with an estimate of what the mesh does to the force, those in which it was reliable, and
  /// the largest bound of such an error, N of the body.
  std::uint64_t mesh_error_ticks = 0;
  std::uint64_t reliable_mesh_error_ticks = 0;
  double largest_mesh_error = 0;
};

struct Statistics : Counters {
  /// How late ticks began.
  Percentiles lateness;
  /// The time between the beginnings of two ticks.
  Percentiles interval;
  /// The time from the beginning of a tick to its end, and that time without the device's driver.
  Percentiles tick_time;
  Percentiles own_time;
  /// Whether the thread has real-time priority, and whether its stack, its objects and the body are
  /// locked in memory.
  bool realtime_priority = false;
  bool memory_locked = false;

  /// Ticks a second.
  [[nodiscard]] double rate() const {
    return ticks > 1 ? static_cast<double>(ticks - 1) / seconds(running) : 0;
  }
  /// The mean force over the ticks in which the tool touched, N.
  [[nodiscard]] double mean_force() const {
    return touching_ticks > 0 ? sum_of_forces / static_cast<double>(touching_ticks) : 0;
  }
};

}  // namespace palpate
