// SPDX-License-Identifier: BSD-3-Clause
// The memory that the servo loop shares with its guardian, a process of its own.
//
// The loop says that it lives whenever it commands the motors, and the guardian whenever it looks.
// When the loop falls silent, the guardian latches a trip and sets the motors to zero, again and
// again until the loop has acknowledged the trip:
//
//   loop       beat, no trip? force …        (held up)      … trip! zero, acknowledge, zero …
//   guardian   look        look         trip, zero, zero, zero, zero,           look …
//
// A loop that was held up between its look for a trip and its write sends one force that is too
// late. It sees the trip in its next tick, and the guardian's next zero comes in any case, because
// nothing has acknowledged the trip.
//
// The loop may live on where the rest of its program, the host, has failed: a thread that has
// crashed hangs in a handler of the crash, or the main thread waits for something that never comes.
// Then nobody commands what the loop sends. So the channel also has the state of the host:
// `crashed` or `ending`, which the host sets for good in a handler of the signal (host_signals.h),
// or `hanging`, which the guardian sets as long as it finds the host so (host_watch.h).
#pragma once

#include <atomic>
#include <cstdint>

#include "haptic/profile/report.h"
#include "haptic/realtime/clock.h"

namespace palpate {

/// The state of the program that the loop is a part of.
enum class HostState : std::uint32_t {
  living,
  /// The thread by which a person commands the program waits for something that does not come, or
  /// handles a signal of host_signals.h.
  hanging,
  /// The program was asked to end, by a signal.
  ending,
  /// A thread of the program has crashed.
  crashed,
};

/// The shared memory. All times are those of MonotonicClock. All calls are realtime-safe and make
/// no system call.
class GuardianChannel {
 public:
  /// The loop counts as silent when it has not commanded the motors for this long.
  static constexpr Duration kLoopSilence = std::chrono::milliseconds(20);
  /// The guardian counts as dead when it has not looked for this long. It looks once every kLook.
  static constexpr Duration kGuardianSilence = std::chrono::milliseconds(60);
  static constexpr Duration kLook = std::chrono::milliseconds(10);
  /// The version of this class, which must be the same in both programs.
  static constexpr std::uint32_t kVersion = 3;

  /// @param its_zero The report that switches the motors off, whatever the device's state is.
  explicit GuardianChannel(const Report& its_zero = {}) : zero(its_zero) {}
  GuardianChannel(const GuardianChannel&) = delete;
  GuardianChannel& operator=(const GuardianChannel&) = delete;

  // The loop calls these.

  /// Says that the loop is about to command the motors.
  void beat(Time now) noexcept { loop_lives_.store(now.count(), std::memory_order_release); }
  /// Says that the motors have zero force, and that the loop commands them no longer.
  void rest() noexcept { loop_lives_.store(kResting, std::memory_order_release); }
  /// Whether the guardian has latched a trip that the loop has not acknowledged.
  [[nodiscard]] bool tripped() const noexcept {
    return trips_.load(std::memory_order_acquire) != acknowledged_.load(std::memory_order_acquire);
  }
  /// Says that the loop has seen the trip and has set the motors to zero since then.
  void acknowledge() noexcept {
    acknowledged_.store(trips_.load(std::memory_order_acquire), std::memory_order_release);
  }
  /// Whether the guardian has looked within kGuardianSilence.
  [[nodiscard]] bool guarded(Time now) const noexcept {
    const std::int64_t lives = guardian_lives_.load(std::memory_order_acquire);
    return lives != kNever && now.count() - lives <= kGuardianSilence.count();
  }
  /// Whether the guardian has ended because the device is unplugged.
  [[nodiscard]] bool device_is_gone() const noexcept {
    return device_is_gone_.load(std::memory_order_acquire);
  }

  [[nodiscard]] bool resting() const noexcept {
    return loop_lives_.load(std::memory_order_acquire) == kResting;
  }
  [[nodiscard]] HostState host() const noexcept { return host_.load(std::memory_order_acquire); }

  // Other threads of the host call these.

  /// Says that the thread lives by which a person commands the program. From the first call on it
  /// is watched.
  /// @param thread The system's number of the thread (gettid()).
  void host_beat(Time now, std::int32_t thread) noexcept {
    host_thread_.store(thread, std::memory_order_relaxed);
    host_lives_.store(now.count(), std::memory_order_release);
  }
  /// Says that the host has crashed, or was asked to end. Handlers of signals may call this.
  /// @param state `crashed` or `ending`; a host that has crashed stays `crashed`.
  void say_host_fails(HostState state) noexcept {
    HostState before = host_.load(std::memory_order_relaxed);
    while (before != HostState::crashed &&
           !host_.compare_exchange_weak(before, state, std::memory_order_acq_rel)) {
    }
  }

  // The guardian calls these.

  void look(Time now) noexcept { guardian_lives_.store(now.count(), std::memory_order_release); }
  void trip() noexcept { trips_.fetch_add(1, std::memory_order_acq_rel); }
  void say_device_is_gone() noexcept { device_is_gone_.store(true, std::memory_order_release); }
  /// How long the loop may still be silent; zero or less: it was silent for too long.
  [[nodiscard]] Duration until_loop_is_silent(Time now) const noexcept {
    const std::int64_t lives = loop_lives_.load(std::memory_order_acquire);
    if (lives == kResting) return Duration::max();
    // The loop may have beaten after the caller has asked for the time, but only just. A beat from
    // much later means that something has overwritten the memory.
    const Duration since = now - Time(lives);
    return since < -kLoopSilence ? Duration(0) : kLoopSilence - since;
  }
  /// The thread that is watched; 0: none.
  [[nodiscard]] std::int32_t host_thread() const noexcept {
    return host_lives_.load(std::memory_order_acquire) == kNever
               ? 0
               : host_thread_.load(std::memory_order_relaxed);
  }
  /// When that thread last said that it lives.
  [[nodiscard]] Time host_lived() const noexcept {
    return Time(host_lives_.load(std::memory_order_acquire));
  }
  /// Says whether the host hangs. A host that has crashed or ends stays so.
  void say_host_hangs(bool hangs) noexcept {
    HostState other = hangs ? HostState::living : HostState::hanging;
    host_.compare_exchange_strong(other, hangs ? HostState::hanging : HostState::living,
                                  std::memory_order_acq_rel);
  }

  // These are written before the guardian starts.
  const std::uint32_t version = kVersion;
  const Report zero;

 private:
  static constexpr std::int64_t kResting = -1;
  static constexpr std::int64_t kNever = -1;

  // Each process writes to lines of the cache that the other only reads.
  alignas(64) std::atomic<std::int64_t> loop_lives_{kResting};
  std::atomic<std::uint32_t> acknowledged_{0};
  alignas(64) std::atomic<std::int64_t> guardian_lives_{kNever};
  std::atomic<std::uint32_t> trips_{0};
  std::atomic<bool> device_is_gone_{false};
  alignas(64) std::atomic<std::int64_t> host_lives_{kNever};
  std::atomic<std::int32_t> host_thread_{0};
  std::atomic<HostState> host_{HostState::living};

  static_assert(std::atomic<std::int64_t>::is_always_lock_free);
  static_assert(std::atomic<std::uint32_t>::is_always_lock_free);
  static_assert(std::atomic<HostState>::is_always_lock_free);
};

}  // namespace palpate
