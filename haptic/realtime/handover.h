// SPDX-License-Identifier: BSD-3-Clause
// Replaces a large object that a real-time thread is using. That thread neither waits nor
// frees: what it has let go of is taken back, and destroyed, by the one who replaces.
#pragma once

#include <atomic>
#include <memory>

namespace palpate {

/// One thread offers, one other (the real-time one) takes.
template <class T>
class Handover {
 public:
  Handover() = default;
  Handover(const Handover&) = delete;
  Handover& operator=(const Handover&) = delete;
  ~Handover() {
    delete offered_.load();
    delete returned_.load();
    delete current_;
  }

  /// In place of what is there; an earlier offer that was not taken is destroyed.
  void offer(std::shared_ptr<T> value) {
    collect();
    delete offered_.exchange(new Held(std::move(value)), std::memory_order_acq_rel);
  }

  /// Destroys what the other thread has returned. Called by offer(); by itself it frees memory
  /// earlier.
  void collect() { delete returned_.exchange(nullptr, std::memory_order_acq_rel); }

  /// The newest offer, or nullptr before the first. Valid until the next call.
  /// @note Realtime-safe.
  [[nodiscard]] T* take() noexcept {
    // With the last one not yet collected there is no place to return another: it stays in use, and
    // the offer waits.
    if (offered_.load(std::memory_order_relaxed) != nullptr &&
        returned_.load(std::memory_order_acquire) == nullptr) {
      Held* next = offered_.exchange(nullptr, std::memory_order_acq_rel);
      if (next != nullptr) {
        returned_.store(current_, std::memory_order_release);
        current_ = next;
      }
    }
    return current_ != nullptr ? current_->get() : nullptr;
  }

 private:
  using Held = std::shared_ptr<T>;

  std::atomic<Held*> offered_{nullptr};
  std::atomic<Held*> returned_{nullptr};
  Held* current_ = nullptr;
};

}  // namespace palpate
