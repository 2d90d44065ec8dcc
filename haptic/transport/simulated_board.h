// SPDX-License-Identifier: BSD-3-Clause
// A device that is not there: the firmware of a board that speaks our report, and the queue of the
// kernel's hidraw between it and the host.
//
// Everything happens by the clock, in the order of its times, when the host calls: with a virtual
// clock each run goes the same way. The motors hold a force until the next one takes effect.
#pragma once

#include <limits>
#include <memory>

#include "haptic/profile/palpate_report.h"
#include "haptic/transport/motion.h"
#include "haptic/transport/transport.h"

namespace palpate {

/// What goes wrong and when, since the board was switched on.
struct BoardFaults {
  static constexpr Time kNever = Time::max();
  struct Span {
    Time from = kNever;
    Time to = kNever;
    [[nodiscard]] bool contains(Time time) const { return from <= time && time < to; }
  };

  /// It measures and reports nothing.
  Span silent;
  /// Reports lack their last byte.
  Span short_reports;
  /// Each report comes twice.
  Span duplicates;
  /// An empty packet comes before each report: one read gives nothing though more is there.
  Span empty_packets;
  /// The first report does not arrive.
  bool first_report_lost = false;
  Span failing_writes;
  /// A write in this span returns at its end; where that is never, when release_writes() is called
  /// or the board is unplugged. It has no effect.
  Span blocking_writes;
  Time unplugged = kNever;
};

struct BoardOptions {
  palpate_report::Feature feature;
  /// What the board's clock and its counter show when it is switched on.
  std::uint32_t first_time_us = 0;
  std::uint16_t first_counter = 0;
  /// The board's clock gains that much on ours, s/s.
  double clock_drift = 0;
  /// From a measurement until the host can read it; from a write until the motors follow.
  Duration report_delay{0};
  Duration force_delay{0};
  BoardFaults faults;
};

/// What the board is doing and has done.
struct BoardStatus {
  /// Of the motors [3], N.
  Vec3 force = Vec3::Zero();
  bool motors_on = false;
  Motion::Pose pose;
  /// Reports that were sent, and of them those that found the host's queue full.
  std::uint64_t reports = 0;
  std::uint64_t lost = 0;
  /// Output reports that arrived whole, and others.
  std::uint64_t outputs = 0;
  std::uint64_t bad_outputs = 0;
  /// The last of them; its counter is that of the report it answers.
  palpate_report::Output last_output;
  /// Times that the watchdog has cut the motors.
  std::uint64_t cuts = 0;
};

class SimulatedBoard final : public Transport {
 public:
  /// Unread reports that hidraw keeps, the oldest: its ring has 64 places, and one stays empty
  /// (HIDRAW_BUFFER_SIZE in the kernel's drivers/hid/hidraw.c).
  static constexpr int kQueue = 63;
  /// Reports, and forces, that can be on their way at once.
  static constexpr int kOnTheWay = 64;

  /// Switched on.
  /// @throws InputError the options are out of range.
  SimulatedBoard(std::shared_ptr<Clock> clock, std::shared_ptr<Motion> motion,
                 const BoardOptions& options = {});
  ~SimulatedBoard() override;

  /// The answer to the request for the feature report.
  [[nodiscard]] Report feature() const;

  TransportStatus read(Report& report, Duration timeout) noexcept override;
  TransportStatus write(const Report& report) noexcept override;
  std::string problem() const override;

  /// From any thread.
  [[nodiscard]] BoardStatus status() noexcept;
  /// Writes that block return, and none blocks from now on. From any thread.
  void release_writes() noexcept;
  /// As if its plug was pulled now. From any thread.
  void unplug() noexcept;

 private:
  struct Firmware;
  std::unique_ptr<Firmware> firmware_;
};

}  // namespace palpate
