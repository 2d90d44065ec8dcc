// SPDX-License-Identifier: BSD-3-Clause
// Passes the newest value from one thread to another; neither ever waits for the other.
#pragma once

#include <array>
#include <atomic>

namespace palpate {

/// One thread writes, and one other reads.
template <class T>
class TripleBuffer {
 public:
  /// @note Realtime-safe.
  void write(const T& value) noexcept {
    slots_[back_] = value;
    back_ = middle_.exchange(back_ | kFresh, std::memory_order_acq_rel) & kSlot;
  }

  /// Whether a value was written that read() has not given yet.
  /// @note Realtime-safe.
  [[nodiscard]] bool has_new() const noexcept {
    return (middle_.load(std::memory_order_relaxed) & kFresh) != 0;
  }

  /// The newest value that was written, or T() before the first. It is valid until the next call.
  /// @note Realtime-safe.
  [[nodiscard]] const T& read() noexcept {
    if (has_new()) {
      front_ = middle_.exchange(front_, std::memory_order_acq_rel) & kSlot;
    }
    return slots_[front_];
  }

 private:
  static constexpr int kSlot = 3;
  static constexpr int kFresh = 4;

  std::array<T, 3> slots_{T(), T(), T()};
  alignas(64) int back_ = 0;
  alignas(64) std::atomic<int> middle_{1};
  alignas(64) int front_ = 2;
};

}  // namespace palpate
