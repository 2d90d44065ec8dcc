// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/device/board.h"

#include <linux/uhid.h>
#include <poll.h>
#include <signal.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "haptic/device/check.h"
#include "haptic/profile/palpate_report.h"
#include "haptic/realtime/clock.h"

namespace palpate::test {
namespace {

/// What the board takes for 1 ms. Its clock is as slow as USB allows a full-speed device's to be:
/// the servo's ticks and the reports come in all phases, and the times drift apart.
constexpr long kPeriod = 1'002'500;

/// Both counts wrap while it runs.
constexpr std::uint32_t kFirstTime = 0xFFFFFFFF - 1'500'000;
constexpr std::uint16_t kFirstCounter = 0xFFFF - 800;

/// Where no force report comes at all the script begins after so many reports.
constexpr int kLongestWait = 2000;

/// Report descriptor of a mouse with one button: a device that is not ours.
constexpr std::array<std::uint8_t, 46> kMouse{
    0x05, 0x01,                                                  // usage page (generic desktop)
    0x09, 0x02,                                                  // usage (mouse)
    0xA1, 0x01,                                                  // collection (application)
    0x09, 0x01,                                                  //   usage (pointer)
    0xA1, 0x00,                                                  //   collection (physical)
    0x05, 0x09, 0x19, 0x01, 0x29, 0x01, 0x15, 0x00, 0x25, 0x01,  // button 1, 0 or 1
    0x95, 0x01, 0x75, 0x01, 0x81, 0x02,                          // a bit of input
    0x75, 0x07, 0x81, 0x03,                                      // seven bits of padding
    0x05, 0x01, 0x09, 0x30, 0x09, 0x31,                          // x and y
    0x25, 0x7F, 0x75, 0x08, 0x95, 0x02, 0x81, 0x06,              // a byte of input each
    0xC0, 0xC0,
};

long long microseconds() { return MonotonicClock().now().count() / 1000; }

}  // namespace

void Board::run() {
  // Before the board, so that it is found first.
  Uhid mouse;
  mouse.plug("Mouse", 0x046D, 0xC077, kMouse.data(), kMouse.size());
  const int timer = timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC);
  const itimerspec every{{0, kPeriod}, {0, kPeriod}};
  check(timer >= 0 && timerfd_settime(timer, 0, &every, nullptr) == 0, "timer");
  time_us_ = kFirstTime;
  measured_.counter = kFirstCounter;
  log_.add("units %g %g", kPositionUnit, kForceUnit);
  plug();
  while (stroke_ < static_cast<int>(script_.size())) {
    pollfd ready[2] = {{uhid_.file(), POLLIN, 0}, {timer, POLLIN, 0}};
    check(poll(ready, 2, -1) > 0, "poll");
    if (ready[0].revents != 0) take_event();
    if (ready[1].revents == 0) continue;
    std::uint64_t expired = 0;
    check(read(timer, &expired, sizeof expired) == sizeof expired, "timer");
    step();
  }
  close(timer);
}

void Board::plug() {
  using palpate_report::kDescriptor;
  // Vendor and product are those for tests of pid.codes; the profile goes by the usage page.
  uhid_.plug("Palpate test board", 0x1209, 0x0001, kDescriptor, sizeof kDescriptor);
}

void Board::unplug() {
  uhid_.unplug();
  open_ = false;
}

/// What the kernel has for the device.
void Board::take_event() {
  const uhid_event event = uhid_.next();
  if (event.type == UHID_OPEN || event.type == UHID_CLOSE) {
    open_ = event.type == UHID_OPEN;
    log_.add("%s %lld", open_ ? "open" : "close", microseconds());
  } else if (event.type == UHID_GET_REPORT) {
    log_.add("ask %lld %s", microseconds(), stalls_ ? "stalled" : "answered");
    firmware::Feature feature;
    feature.position_unit_nm = std::lround(kPositionUnit * 1e9);
    feature.force_unit_un = std::lround(kForceUnit * 1e6);
    if (!stalls_) uhid_.answer(event.u.get_report.id, &feature, sizeof feature);
    stalls_ = false;
  } else if (event.type == UHID_OUTPUT) {
    firmware::Output output;
    std::memcpy(&output, event.u.output.data, sizeof output);
    log_.add("out %lld %u %d %d %d %d %u", microseconds(), output.counter, output.force[0],
             output.force[1], output.force[2], output.number, event.u.output.size);
    stroke_ = std::max(stroke_, 0);
  }
}

/// What is due each millisecond.
void Board::step() {
  Fault fault = Fault::none;
  if (stroke_ < 0 && ++waited_ == kLongestWait) stroke_ = 0;
  if (stroke_ >= 0) {
    const Stroke& stroke = script_[stroke_];
    if (step_ == 0) log_.add("stroke %lld %s", microseconds(), name(stroke.fault));
    if (stroke.begins(step_)) begin(stroke.fault);
    if (stroke.ends(step_)) end(stroke.fault);
    fault = stroke.fault_at(step_);
  }
  time_us_ += 1000;
  if (fault != Fault::frozen) {
    measured_.time_us = time_us_;
    ++measured_.counter;
    const int number = std::max(stroke_, 0);
    const Vec3 position = stylus(script_[number], number, step_) / kPositionUnit;
    for (int k = 0; k < 3; ++k) measured_.position[k] = std::lround(position[k]);
  }
  measured_.buttons = (fault == Fault::stop ? 1 : 0) | (fault == Fault::leave ? 2 : 0) |
                      (fault == Fault::write_error ? 4 : 0);
  if (open_) {
    constexpr std::size_t whole = sizeof measured_;
    switch (fault) {
      case Fault::device_pause:
      case Fault::away: break;
      case Fault::wrong_size:
        if (step_ % 2 == 0)
          send("short", whole - 1);
        else
          send("long", whole + 1);
        break;
      case Fault::empty: send("empty", 0); break;
      case Fault::doubled: send("whole", whole); [[fallthrough]];
      default: send("whole", whole);
    }
  }
  if (stroke_ >= 0 && ++step_ == script_[stroke_].length) {
    ++stroke_;
    step_ = 0;
  }
}

void Board::begin(Fault fault) {
  log_.add("begin %lld %s", microseconds(), name(fault));
  switch (fault) {
    case Fault::host_pause: host_.signal(SIGSTOP); break;
    case Fault::kill: host_.signal(SIGKILL); break;
    case Fault::crash: host_.signal(SIGSEGV); break;
    case Fault::interrupt: host_.signal(SIGINT, true); break;
    case Fault::unplug:
    case Fault::stall: unplug(); break;
    default: break;
  }
}

void Board::end(Fault fault) {
  log_.add("end %lld %s", microseconds(), name(fault));
  stalls_ = fault == Fault::stall;
  switch (fault) {
    case Fault::host_pause: host_.signal(SIGCONT); break;
    case Fault::kill:
    case Fault::crash:
    case Fault::interrupt: host_.restart(); break;
    case Fault::unplug:
    case Fault::stall: plug(); break;
    default: break;
  }
}

void Board::send(const char* how, std::size_t size) {
  // One byte more than a report has.
  std::array<std::uint8_t, sizeof measured_ + 1> bytes{};
  std::memcpy(bytes.data(), &measured_, sizeof measured_);
  uhid_.send(bytes.data(), size);
  const auto& position = measured_.position;
  log_.add("in %lld %u %d %d %d %s", microseconds(), measured_.counter, position[0], position[1],
           position[2], how);
}

}  // namespace palpate::test
