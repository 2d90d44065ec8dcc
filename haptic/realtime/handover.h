// SPDX-License-Identifier: BSD-3-Clause
// Replaces a large object that a real-time thread is using. That thread neither waits nor frees
// memory: it gives back what it no longer uses, and the thread that replaces destroys it.
//
// An object passes through four places, each of which holds at most one: offered → current →
// previous → returned. The first and the last are shared by an atomic exchange; the other two
// belong to the taker. The taker takes an offer only when the place of the previous object is
// empty, and gives that object back only in a later call of take(). So between two calls both are
// alive.
#pragma once

#include <atomic>
#include <memory>

namespace palpate {

/// One thread offers, and one other, the real-time one, takes.
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
    delete previous_;
  }

  /// Offers an object in place of the one there is. An earlier offer that was not taken is
  /// destroyed.
  void offer(std::shared_ptr<T> value) {
    collect();
    delete offered_.exchange(new Held(std::move(value)), std::memory_order_acq_rel);
  }

  /// Destroys what the other thread has returned. offer() does this too; a call of its own frees
  /// the memory earlier.
  void collect() { delete returned_.exchange(nullptr, std::memory_order_acq_rel); }

  /// The newest offer, or nullptr before the first. It is valid until the next call, and so is the
  /// object that the call before has given.
  /// @note Realtime-safe.
  [[nodiscard]] T* take() noexcept {
    // An object that is not yet collected keeps its place, and the offer waits meanwhile.
    if (previous_ != nullptr && returned_.load(std::memory_order_acquire) == nullptr) {
      returned_.store(previous_, std::memory_order_release);
      previous_ = nullptr;
    }
    if (previous_ == nullptr && offered_.load(std::memory_order_relaxed) != nullptr) {
      Held* next = offered_.exchange(nullptr, std::memory_order_acq_rel);
      if (next != nullptr) {
        previous_ = current_;
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
  Held* previous_ = nullptr;
};

}  // namespace palpate
