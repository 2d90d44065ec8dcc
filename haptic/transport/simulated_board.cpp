// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/transport/simulated_board.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <condition_variable>
#include <limits>
#include <mutex>

#include "base/error.h"

namespace palpate {
namespace {

using palpate_report::Input;
using palpate_report::Output;

/// A queue that does not allocate.
template <class T, std::size_t capacity>
class Queue {
 public:
  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] bool full() const { return size_ == capacity; }
  [[nodiscard]] const T& front() const { return items_[first_]; }
  void push(const T& item) { items_[(first_ + size_++) % capacity] = item; }
  void pop() {
    first_ = (first_ + 1) % capacity;
    --size_;
  }

 private:
  std::array<T, capacity> items_{};
  std::size_t first_ = 0;
  std::size_t size_ = 0;
};

constexpr double kMostCounts = std::numeric_limits<std::int32_t>::max();

template <class T>
struct Dated {
  Time time{0};
  T value{};
};

}  // namespace

/// All times are since the board was switched on.
struct SimulatedBoard::Firmware {
  Firmware(std::shared_ptr<Clock> its_clock, std::shared_ptr<Motion> its_motion,
           const BoardOptions& its_options)
      : clock(std::move(its_clock)),
        motion(std::move(its_motion)),
        options(its_options),
        profile(options.feature),
        lock_step(profile.specification().pacing == Pacing::lock_step),
        interval(std::chrono::microseconds(options.feature.interval_us)),
        on(clock->now()),
        next_measurement(0),
        unplugged(options.faults.unplugged) {}

  [[nodiscard]] Time now() const { return clock->now() - on; }
  [[nodiscard]] bool is_gone(Time time) const { return time >= unplugged; }

  [[nodiscard]] Time watchdog_time() const {
    return status.motors_on ? last_force + profile.specification().watchdog : BoardFaults::kNever;
  }

  [[nodiscard]] Time next_event() const {
    Time next = std::min(next_measurement, watchdog_time());
    if (!forces.empty()) next = std::min(next, forces.front().time);
    if (!reports.empty()) next = std::min(next, reports.front().time);
    return next;
  }

  /// Lets everything happen that is due until that time, in order of time. Where both are due at
  /// once, a force comes before a measurement.
  void run_until(Time time) {
    const Time end = std::min(time, unplugged);
    for (Time next = next_event(); next <= end; next = next_event()) {
      status.pose = motion->advance(next, status.force);
      if (!forces.empty() && forces.front().time == next) {
        obey(forces.front().value, next);
        forces.pop();
      } else if (watchdog_time() == next) {
        switch_off();
        was_cut = true;
        ++status.cuts;
      } else if (!reports.empty() && reports.front().time == next) {
        arrive(reports.front().value);
        reports.pop();
      } else {
        measure(next);
        next_measurement = lock_step ? BoardFaults::kNever : next + interval;
      }
    }
    // A board that is unplugged has no power.
    if (is_gone(time)) switch_off();
    status.pose = motion->advance(time, status.force);
  }

  void obey(const Output& output, Time time) {
    if (output.command == palpate_report::kForce) {
      for (std::size_t i = 0; i < 3; ++i) {
        status.force[static_cast<int>(i)] = 1e-6 * options.feature.force_unit_un * output.force[i];
      }
      status.motors_on = true;
    } else {
      switch_off();
    }
    last_force = time;
    was_cut = false;
  }

  void switch_off() {
    status.force.setZero();
    status.motors_on = false;
  }

  void measure(Time time) {
    Input input;
    const double us = 1e6 * seconds(time) * (1 + options.clock_drift);
    input.time_us = options.first_time_us + static_cast<std::uint32_t>(std::llround(us));
    input.counter = static_cast<std::uint16_t>(options.first_counter + num_measured);
    const bool first = num_measured++ == 0;
    last_measurement = time;
    const BoardFaults& faults = options.faults;
    if (faults.silent.contains(time) || (first && faults.first_report_lost)) return;
    const double unit = profile.specification().position_resolution;
    for (std::size_t i = 0; i < 3; ++i) {
      const double counts = std::round(status.pose.position[static_cast<int>(i)] / unit);
      input.position[i] = static_cast<std::int32_t>(std::clamp(counts, -kMostCounts, kMostCounts));
    }
    const Eigen::Quaterniond& q = status.pose.rotation;
    const std::array<double, 4> rotation{q.w(), q.x(), q.y(), q.z()};
    for (std::size_t i = 0; i < 4; ++i) {
      input.rotation[i] = static_cast<std::int16_t>(std::lround(32767 * rotation[i]));
    }
    input.buttons = status.pose.buttons;
    if (status.motors_on) input.status |= palpate_report::kMotorsOn;
    if (was_cut) input.status |= palpate_report::kWatchdogCut;

    Report report = palpate_report::encode_input(input);
    if (faults.short_reports.contains(time)) --report.size;
    const Time arrival = time + options.report_delay;
    if (faults.empty_packets.contains(time)) send({arrival, Report{}});
    if (faults.duplicates.contains(time)) send({arrival, report});
    send({arrival, report});
  }

  void send(const Dated<Report>& report) {
    ++status.reports;
    if (reports.full()) {
      ++status.lost;
    } else {
      reports.push(report);
    }
  }

  void arrive(const Report& report) {
    if (unread.full()) {
      ++status.lost;
    } else {
      unread.push(report);
    }
  }

  std::shared_ptr<Clock> clock;
  std::shared_ptr<Motion> motion;
  BoardOptions options;
  PalpateReport profile;
  bool lock_step;
  Duration interval;
  Time on;

  std::mutex mutex;
  std::condition_variable released;
  Time next_measurement;
  Time last_measurement{0};
  Time unplugged;
  std::uint64_t num_measured = 0;
  Time last_force{0};
  bool was_cut = false;
  bool writes_are_released = false;
  bool write_failed = false;
  BoardStatus status;
  Queue<Dated<Report>, kOnTheWay> reports;
  Queue<Dated<Output>, kOnTheWay> forces;
  Queue<Report, kQueue> unread;
};

SimulatedBoard::SimulatedBoard(std::shared_ptr<Clock> clock, std::shared_ptr<Motion> motion,
                               const BoardOptions& options) {
  const auto interval = std::chrono::microseconds(options.feature.interval_us);
  // In an interval there are at most two reports, where they come twice, and the writes that answer
  // them.
  const Duration longest = (kOnTheWay / 2 - 1) * interval;
  if (options.report_delay < Duration(0) || options.report_delay > longest ||
      options.force_delay < Duration(0) || options.force_delay > longest) {
    throw InputError("The delays of a simulated board have to be from 0 to " +
                     std::to_string(kOnTheWay / 2 - 1) + " report intervals.");
  }
  firmware_ = std::make_unique<Firmware>(std::move(clock), std::move(motion), options);
}

SimulatedBoard::~SimulatedBoard() = default;

Report SimulatedBoard::feature() const {
  return palpate_report::encode_feature(firmware_->options.feature);
}

TransportStatus SimulatedBoard::read(Report& report, Duration timeout) noexcept {
  Firmware& f = *firmware_;
  std::unique_lock lock(f.mutex);
  const Time deadline = f.now() + timeout;
  while (true) {
    const Time now = f.now();
    f.run_until(now);
    if (f.is_gone(now)) return TransportStatus::gone;
    if (!f.unread.empty()) {
      report = f.unread.front();
      f.unread.pop();
      return report.size == 0 ? TransportStatus::nothing : TransportStatus::data;
    }
    if (now >= deadline) return TransportStatus::nothing;
    const Time wake = std::min({deadline, f.next_event(), f.unplugged});
    lock.unlock();
    f.clock->sleep_until(f.on + wake);
    lock.lock();
  }
}

TransportStatus SimulatedBoard::write(const Report& report) noexcept {
  Firmware& f = *firmware_;
  std::unique_lock lock(f.mutex);
  const Time now = f.now();
  f.run_until(now);
  const BoardFaults& faults = f.options.faults;
  if (faults.blocking_writes.contains(now) && !f.writes_are_released && !f.is_gone(now)) {
    const Time end = std::min(faults.blocking_writes.to, f.unplugged);
    if (end == BoardFaults::kNever) {
      f.released.wait(lock, [&] { return f.writes_are_released || f.is_gone(f.now()); });
    } else {
      lock.unlock();
      f.clock->sleep_until(f.on + end);
      lock.lock();
    }
    f.write_failed = true;
    return f.is_gone(f.now()) ? TransportStatus::gone : TransportStatus::error;
  }
  if (f.is_gone(now)) return TransportStatus::gone;
  if (faults.failing_writes.contains(now)) {
    f.write_failed = true;
    return TransportStatus::error;
  }

  Output output;
  if (!palpate_report::decode_output(report, output) || f.forces.full()) {
    ++f.status.bad_outputs;
    return TransportStatus::data;
  }
  ++f.status.outputs;
  f.status.last_output = output;
  f.forces.push({now + f.options.force_delay, output});
  // The board does not measure twice in an interval, which is the frame of the bus.
  if (f.lock_step) f.next_measurement = std::max(now, f.last_measurement + f.interval);
  f.run_until(now);
  return TransportStatus::data;
}

std::string SimulatedBoard::problem() const {
  Firmware& f = *firmware_;
  const std::lock_guard lock(f.mutex);
  if (f.is_gone(f.now())) return "The simulated board is unplugged.";
  return f.write_failed ? "A write failed." : "";
}

BoardStatus SimulatedBoard::status() noexcept {
  Firmware& f = *firmware_;
  const std::lock_guard lock(f.mutex);
  f.run_until(f.now());
  return f.status;
}

void SimulatedBoard::release_writes() noexcept {
  const std::lock_guard lock(firmware_->mutex);
  firmware_->writes_are_released = true;
  firmware_->released.notify_all();
}

void SimulatedBoard::unplug() noexcept {
  Firmware& f = *firmware_;
  const std::lock_guard lock(f.mutex);
  f.unplugged = std::min(f.unplugged, f.now());
  f.released.notify_all();
}

}  // namespace palpate
