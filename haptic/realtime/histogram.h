// SPDX-License-Identifier: BSD-3-Clause
// Percentiles of durations that a real-time thread has counted.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

#include "haptic/realtime/clock.h"

namespace palpate {

struct Percentiles {
  Duration median{0};
  Duration p99{0};
  Duration p999{0};
  Duration largest{0};
};

/// Counts durations by size, in sixteen buckets for each doubling, so that a percentile is at most
/// a sixteenth too large. One thread adds; any thread may read meanwhile.
class DurationHistogram {
 public:
  /// @note Realtime-safe.
  void add(Duration duration) noexcept;
  /// The percentiles of all durations that were added so far; zero before the first.
  [[nodiscard]] Percentiles percentiles() const noexcept;

 private:
  static constexpr int kBuckets = 60 * 16;
  [[nodiscard]] static int bucket_of(std::uint64_t nanoseconds) noexcept;
  [[nodiscard]] static std::uint64_t end_of(int bucket) noexcept;

  std::array<std::atomic<std::uint64_t>, kBuckets> counts_{};
  std::atomic<std::int64_t> largest_{0};
};

}  // namespace palpate
