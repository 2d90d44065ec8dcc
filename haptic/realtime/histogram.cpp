// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/realtime/histogram.h"

#include <algorithm>
#include <cmath>

namespace palpate {

// Below 16 ns each nanosecond has a bucket. From there on a bucket follows from the exponent and
// the four bits after the leading one.
int DurationHistogram::bucket_of(std::uint64_t nanoseconds) noexcept {
  if (nanoseconds < 16) return static_cast<int>(nanoseconds);
  const int exponent = 63 - __builtin_clzll(nanoseconds);
  return 16 * (exponent - 3) + static_cast<int>((nanoseconds >> (exponent - 4)) & 15);
}

std::uint64_t DurationHistogram::end_of(int bucket) noexcept {
  if (bucket < 16) return static_cast<std::uint64_t>(bucket) + 1;
  const int exponent = bucket / 16 + 3;
  return (std::uint64_t{16} + static_cast<std::uint64_t>(bucket % 16) + 1) << (exponent - 4);
}

void DurationHistogram::add(Duration duration) noexcept {
  const std::int64_t nanoseconds = std::max<std::int64_t>(duration.count(), 0);
  std::atomic<std::uint64_t>& count =
      counts_[std::min(bucket_of(static_cast<std::uint64_t>(nanoseconds)), kBuckets - 1)];
  // There is one writer, so no read-modify-write is needed.
  count.store(count.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
  if (nanoseconds > largest_.load(std::memory_order_relaxed)) {
    largest_.store(nanoseconds, std::memory_order_relaxed);
  }
}

Percentiles DurationHistogram::percentiles() const noexcept {
  std::array<std::uint64_t, kBuckets> counts;
  std::uint64_t total = 0;
  for (int b = 0; b < kBuckets; ++b) {
    counts[b] = counts_[b].load(std::memory_order_relaxed);
    total += counts[b];
  }
  const std::int64_t largest = largest_.load(std::memory_order_relaxed);
  const auto percentile = [&](double share) {
    const double wanted = std::ceil(share * static_cast<double>(total));
    std::uint64_t sum = 0;
    for (int b = 0; b < kBuckets; ++b) {
      sum += counts[b];
      if (counts[b] > 0 && static_cast<double>(sum) >= wanted) {
        return Duration(std::min<std::int64_t>(static_cast<std::int64_t>(end_of(b)), largest));
      }
    }
    return Duration(0);
  };
  return {percentile(0.5), percentile(0.99), percentile(0.999), Duration(largest)};
}

}  // namespace palpate
