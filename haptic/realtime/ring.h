// SPDX-License-Identifier: BSD-3-Clause
// A queue of fixed size from one thread to another; neither ever waits for the other.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>

namespace palpate {

/// One thread pushes, and one other pops.
template <class T>
class Ring {
 public:
  /// @param capacity The ring holds at least so many values.
  explicit Ring(std::size_t capacity) {
    while (size_ < capacity) size_ *= 2;
    slots_.reset(new T[size_]());
  }

  /// Adds a value. Where the ring is full the value is dropped, and counted.
  /// @note Realtime-safe.
  void push(const T& value) noexcept {
    const std::uint64_t head = head_.load(std::memory_order_relaxed);
    if (head - tail_.load(std::memory_order_acquire) == size_) {
      dropped_.store(dropped_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
      return;
    }
    slots_[head & (size_ - 1)] = value;
    head_.store(head + 1, std::memory_order_release);
  }

  /// Takes the oldest value.
  /// @return false: the ring is empty.
  /// @note Realtime-safe.
  [[nodiscard]] bool pop(T& value) noexcept {
    const std::uint64_t tail = tail_.load(std::memory_order_relaxed);
    if (tail == head_.load(std::memory_order_acquire)) return false;
    value = slots_[tail & (size_ - 1)];
    tail_.store(tail + 1, std::memory_order_release);
    return true;
  }

  /// The number of values that were dropped.
  [[nodiscard]] std::uint64_t dropped() const noexcept {
    return dropped_.load(std::memory_order_relaxed);
  }

 private:
  std::size_t size_ = 1;
  std::unique_ptr<T[]> slots_;
  alignas(64) std::atomic<std::uint64_t> head_{0};
  alignas(64) std::atomic<std::uint64_t> tail_{0};
  alignas(64) std::atomic<std::uint64_t> dropped_{0};
};

}  // namespace palpate
