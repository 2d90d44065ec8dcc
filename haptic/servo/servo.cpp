// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/servo/servo.h"

#include <atomic>
#include <future>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "base/error.h"
#include "base/quantity.h"
#include "haptic/realtime/memory_lock.h"
#include "haptic/realtime/realtime_thread.h"
#include "haptic/simulating/simulated_tool.h"

namespace palpate {
namespace {

/// Why the interlock has tripped, in words; empty: it has not, or forces are merely switched off.
std::string why_tripped(const Tick& tick) {
  std::string text;
  if (tick.tripped & trips::failed_writes) {
    text = "Writes to the device fail";
    const double force = tick.force.norm();
    if (force > 0) text += ": its motors may still hold " + quantity(force, "N");
    text += ". ";
  }
  if (tick.tripped & trips::stale) {
    text += "The device or the loop was silent for too long. ";
  }
  if (tick.tripped & trips::guardian) {
    text +=
        "The guardian has set the motors to zero, because the loop was silent or the window has "
        "hung, "
        "or it looks no more. ";
  }
  if (tick.tripped & trips::body) text += "The body was not stepped for too long. ";
  if (!text.empty()) text += "There is no force until the tool was outside of the body.";
  return text;
}

/// A touch that stays in memory as long as the loop may use it.
struct Resident {
  explicit Resident(std::unique_ptr<Touch> its_touch)
      : touch(std::move(its_touch)), lock(touch->memory()) {}

  std::unique_ptr<Touch> touch;
  MemoryLock lock;
};

}  // namespace

/// All that the thread uses. It may outlive the servo where a driver does not let go of the thread.
struct Servo::Shared {
  std::unique_ptr<Transport> transport;
  std::shared_ptr<const Profile> profile;
  std::shared_ptr<Clock> clock;
  ServoOptions options;

  LoopInbox inbox;
  LoopOutbox outbox;
  LoopInbox::Settings settings;
  std::thread thread;
  std::future<void> ended;
  std::atomic<bool> stop{false};
  std::atomic<bool> running{false};
  std::atomic<bool> realtime_priority{false};
  std::atomic<bool> memory_locked{false};
  std::atomic<bool> body_locked{true};
  mutable std::mutex mutex;
  /// Guarded by the mutex, which the loop never takes, as is reading what the loop has sent.
  std::string problem;

  /// What the loop has sent last. Any thread but the loop's may ask.
  LoopOutbox::Newest newest() {
    const std::lock_guard lock(mutex);
    return outbox.newest.read();
  }

  void be_realtime() {
    if (options.priority == 0) return;
    const std::string why_not = take_realtime_priority(options.priority, "The servo loop");
    realtime_priority = why_not.empty();
    const std::lock_guard lock(mutex);
    problem = why_not;
  }

  void run() noexcept {
    try {
      be_realtime();
      std::optional<MemoryLock> lock;
      if (options.priority != 0) {
        lock.emplace(MemoryRanges{own_stack(), {this, sizeof *this}});
        memory_locked = lock->complete();
      }
      Loop loop(*transport, *profile, *clock, options, inbox, outbox);
      while (!stop.load(std::memory_order_relaxed)) {
        loop.tick();
        loop.wait();
      }
      // The session of the loop has sent zero force when it was destroyed.
    } catch (const std::exception& error) {
      const std::lock_guard lock(mutex);
      problem = std::string("The servo loop has ended: ") + error.what();
    }
    running = false;
  }
};

Servo::Servo(std::unique_ptr<Transport> transport, std::shared_ptr<const Profile> profile,
             std::shared_ptr<Clock> clock, const ServoOptions& options)
    : shared_(std::make_shared<Shared>()) {
  validate(options);
  shared_->transport = std::move(transport);
  shared_->profile = std::move(profile);
  shared_->clock = std::move(clock);
  shared_->options = options;
  shared_->inbox.settings.write(shared_->settings);
}

Servo::~Servo() { stop(); }

void Servo::start() {
  if (shared_->ended.valid()) {
    throw BackendError("The servo loop was started before. Make a new one.");
  }
  std::promise<void> ended;
  shared_->ended = ended.get_future();
  shared_->running = true;
  const SignalsBlocked blocked;
  try {
    shared_->thread = std::thread([shared = shared_, ended = std::move(ended)]() mutable {
      shared->run();
      ended.set_value();
    });
  } catch (const std::system_error& error) {
    shared_->running = false;
    throw BackendError(std::string("The thread of the servo loop cannot be started: ") +
                       error.what());
  }
}

bool Servo::stop() noexcept {
  if (!shared_->thread.joinable()) return !shared_->running;
  let_go();
  if (shared_->ended.wait_for(shared_->options.stop_timeout) == std::future_status::ready) {
    shared_->thread.join();
    return true;
  }
  shared_->thread.detach();
  return false;
}

void Servo::let_go() noexcept { shared_->stop = true; }

void Servo::host_lives() noexcept { shared_->transport->host_lives(); }

void Servo::set_touch(std::unique_ptr<Touch> touch) {
  // The memory is locked here, because the loop must make no system call for it.
  if (touch != nullptr && shared_->options.priority != 0) {
    const auto resident = std::make_shared<const Resident>(std::move(touch));
    shared_->body_locked = resident->lock.complete();
    shared_->inbox.touch.offer({resident, resident->touch.get()});
    return;
  }
  shared_->inbox.touch.offer(std::move(touch));
}

void Servo::set_settings(const ServoSettings& settings) {
  validate(settings, specification());
  shared_->settings.servo = settings;
  shared_->inbox.settings.write(shared_->settings);
}

void Servo::set_touch_settings(const TouchSettings& settings) {
  validate(settings);
  shared_->settings.touch = settings;
  shared_->inbox.settings.write(shared_->settings);
}

void Servo::set_recording(std::shared_ptr<TickRing> ring) {
  shared_->inbox.recording.offer(std::move(ring));
}

const Specification& Servo::specification() const { return shared_->profile->specification(); }

Tick Servo::latest() {
  Tick tick = shared_->newest().tick;
  if (!shared_->running) {
    tick.state = ServoState::closed;
  } else if (shared_->clock->now() - tick.time >
                 shared_->options.stale_after + 2 * shared_->options.period &&
             tick.state != ServoState::gone) {
    tick.state = ServoState::stale;
  }
  return tick;
}

Statistics Servo::statistics() {
  Statistics statistics;
  static_cast<Counters&>(statistics) = shared_->newest().counters;
  statistics.lateness = shared_->outbox.lateness.percentiles();
  statistics.interval = shared_->outbox.interval.percentiles();
  statistics.tick_time = shared_->outbox.tick_time.percentiles();
  statistics.own_time = shared_->outbox.own_time.percentiles();
  statistics.realtime_priority = shared_->realtime_priority;
  statistics.memory_locked = shared_->memory_locked && shared_->body_locked;
  return statistics;
}

std::string Servo::problem() {
  std::string text;
  {
    const std::lock_guard lock(shared_->mutex);
    text = shared_->problem;
  }
  const auto add = [&](const std::string& more) {
    if (!text.empty() && !more.empty()) text += ' ';
    text += more;
  };
  add(shared_->transport->problem());
  const std::string why_off = why_motors_stay_off(*shared_->transport, specification());
  add(why_off);
  const LoopOutbox::Newest newest = shared_->newest();
  const Counters& counters = newest.counters;
  if (shared_->running && why_off.empty()) add(why_tripped(newest.tick));
  if (newest.tick.contact.trust > kLargestTrusted) {
    add("The body is moved by " + quantity(newest.tick.contact.trust, "") +
        " times what its reduced model was trained for: its force is not to be trusted.");
  }
  // A few ticks are stale at the beginning and after each pause of the machine.
  constexpr std::uint64_t kManyTicks = 1000;
  constexpr std::uint64_t kShare = 50;
  if (counters.ticks > kManyTicks && counters.stale_ticks > counters.ticks / kShare) {
    add("In " + std::to_string(counters.stale_ticks) + " of " + std::to_string(counters.ticks) +
        " ticks the device's reports were too old for a force: it was silent, its reports are held "
        "up, or its clock is more than 0.3 % slow.");
  }
  return text;
}

}  // namespace palpate
