// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/device/user.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <memory>
#include <string>
#include <thread>

#include "base/error.h"
#include "haptic/device/body.h"
#include "haptic/profile/palpate_report.h"
#include "haptic/servo/servo.h"
#include "haptic/touching/body_touch.h"
#include "haptic/transport/open_device.h"

namespace palpate::test {
namespace {

using namespace std::chrono_literals;

Time now() { return MonotonicClock().now(); }
long long us(Duration duration) { return duration / 1us; }

enum class End { gone, stopped, left };

ServoSettings settings(Log& log) {
  ServoSettings settings;
  // The device's x is the scene's y.
  Mat3& r = settings.workspace_rotation;
  r << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  settings.workspace_scale = 0.5;
  // So that a force follows from one report alone, whatever was sent before.
  settings.slew_limit = 1e6;
  settings.passivity_control = false;
  log.add("workspace %g %g %g %g %g %g %g %g %g %g", settings.workspace_scale, r(0, 0), r(0, 1),
          r(0, 2), r(1, 0), r(1, 1), r(1, 2), r(2, 0), r(2, 1), r(2, 2));
  return settings;
}

/// The newest measurements that the loop has read, tick by tick.
void log_ticks(Log& log, TickRing& ring) {
  TickRecord record;
  while (ring.pop(record)) {
    std::string counters;
    for (const Report& report : record.received) {
      palpate_report::Input input;
      if (decode_input(report, input)) counters += ' ' + std::to_string(input.counter);
    }
    log.add("tick %lld %s %lld%s", us(record.tick.time), to_string(record.tick.state).data(),
            us(std::min<Duration>(record.tick.age, 1h)), counters.c_str());
  }
}

/// hidapi's, of a device whose writes fail as long as button 2 is held in its newest report.
class FailingDevice final : public HidDevice {
 public:
  explicit FailingDevice(std::shared_ptr<HidDevice> device) : device_(std::move(device)) {}

  int read(std::uint8_t* data, std::size_t size, int timeout_ms) noexcept override {
    const int bytes = device_->read(data, size, timeout_ms);
    Report report;
    palpate_report::Input input;
    if (bytes == palpate_report::kInputSize) {
      report.size = palpate_report::kInputSize;
      std::copy_n(data, report.size, report.data.begin());
      if (decode_input(report, input)) fails_ = (input.buttons & 4) != 0;
    }
    return bytes;
  }
  int write(const std::uint8_t* data, std::size_t size) noexcept override {
    return fails_ ? -EIO : device_->write(data, size);
  }
  int get_feature(std::uint8_t* data, std::size_t size) noexcept override {
    return device_->get_feature(data, size);
  }

 private:
  std::shared_ptr<HidDevice> device_;
  bool fails_ = false;
};

class FailingHid final : public Hid {
 public:
  std::vector<DeviceInfo> list() override { return hid_->list(); }
  std::shared_ptr<HidDevice> open(const std::string& path, int& error) override {
    auto device = hid_->open(path, error);
    if (device == nullptr) return nullptr;
    return std::make_shared<FailingDevice>(std::move(device));
  }
  std::unique_ptr<Guardian> guard(const std::string& path, const Report& zero) override {
    return hid_->guard(path, zero);
  }

 private:
  std::shared_ptr<Hid> hid_ = hidapi();
};

End touch(Log& log, OpenedDevice device, const std::shared_ptr<const Touchable>& body) {
  const auto ring = std::make_shared<TickRing>(std::size_t{1} << 13);
  End end = End::left;
  {
    Servo servo(std::move(device.transport), std::move(device.profile),
                std::make_shared<MonotonicClock>());
    servo.set_settings(settings(log));
    servo.set_touch(make_touch(body));
    servo.set_recording(ring);
    servo.start();
    for (bool touching = true; touching;) {
      std::this_thread::sleep_for(1ms);
      const Tick tick = servo.latest();
      if (tick.state == ServoState::gone) {
        end = End::gone;
      } else if (tick.device.buttons & 1) {
        const Time before = now();
        const bool ended = servo.stop();
        log.add("stopped %lld %lld %d", us(now()), us(now() - before), ended);
        end = End::stopped;
      } else if (tick.device.buttons & 2) {
        end = End::left;
      } else {
        continue;
      }
      touching = false;
    }
    const Statistics counted = servo.statistics();
    log.add("counted %llu %llu %llu %llu %d %d", (unsigned long long)counted.bad_reports,
            (unsigned long long)counted.lost_reports, (unsigned long long)counted.missed,
            (unsigned long long)counted.failed_writes, counted.realtime_priority,
            counted.memory_locked);
  }
  log_ticks(log, *ring);
  return end;
}

/// Again and again until it is there.
OpenedDevice wait_for_board(Log& log) {
  for (;; std::this_thread::sleep_for(10ms)) {
    const Time before = now();
    const auto taken = [&] { return us(now() - before) / 1000; };
    try {
      OpenedDevice device = open_device({}, std::make_shared<FailingHid>());
      log.add("opened %lld %lld %s", us(now()), taken(), device.info.path.c_str());
      return device;
    } catch (const InputError&) {
      // It is not plugged in.
    } catch (const BackendError& error) {
      log.add("not_opened %lld %lld", us(now()), taken());
      std::fprintf(stderr, "%s\n", error.what());
    }
  }
}

}  // namespace

void touch_with_the_board(Log& log) {
  const auto body = std::make_shared<const Touchable>(make_body(log));
  for (;;) {
    const End end = touch(log, wait_for_board(log), body);
    if (end == End::left) return;
    // Until the button is no longer held.
    if (end == End::stopped) std::this_thread::sleep_for(100ms);
  }
}

}  // namespace palpate::test
