// SPDX-License-Identifier: BSD-3-Clause
// A simulated device: the firmware of a board that speaks our report, and the queue of the kernel's
// hidraw between it and the host.
//
// The board advances when the host calls: everything that was due by the clock until then happens
// in order of time. So with a virtual clock each run goes the same way. The motors hold a force
// until the next one takes effect.
#pragma once

#include <limits>
#include <memory>

#include "haptic/profile/palpate_report.h"
#include "haptic/transport/motion.h"
#include "haptic/transport/transport.h"

namespace palpate {

/// What goes wrong, and when. Times are since the board was switched on.
struct BoardFaults {
  static constexpr Time kNever = Time::max();
  struct Span {
    Time from = kNever;
    Time to = kNever;
    [[nodiscard]] bool contains(Time time) const { return from <= time && time < to; }
  };

  /// In this span the board measures and reports nothing.
  Span silent;
  /// In this span reports lack their last byte.
  Span short_reports;
  /// In this span each report comes twice.
  Span duplicates;
  /// In this span an empty packet comes before each report, so that a read gives nothing though
  /// there is more.
  Span empty_packets;
  /// The first report does not arrive.
  bool first_report_lost = false;
  Span failing_writes;
  /// A write in this span returns at the end of the span, or where that is never, when
  /// release_writes() is called or the board is unplugged. It has no effect.
  Span blocking_writes;
  Time unplugged = kNever;
};

struct BoardOptions {
  palpate_report::Feature feature;
  /// What the board's clock and counter show when it is switched on.
  std::uint32_t first_time_us = 0;
  std::uint16_t first_counter = 0;
  /// How much the board's clock gains on the host's, s/s.
  double clock_drift = 0;
  /// The time from a measurement until the host can read it, and from a write until the motors
  /// follow.
  Duration report_delay{0};
  Duration force_delay{0};
  BoardFaults faults;
};

/// What the board is doing and has done.
struct BoardStatus {
  /// Force of the motors [3], N.
  Vec3 force = Vec3::Zero();
  bool motors_on = false;
  Motion::Pose pose;
  /// The number of reports that were sent, and of those among them that found the host's queue
  /// full.
  std::uint64_t reports = 0;
  std::uint64_t lost = 0;
  /// The number of output reports that have arrived whole, and of others.
  std::uint64_t outputs = 0;
  std::uint64_t bad_outputs = 0;
  /// The last whole output report. Its counter is that of the input report which it answers.
  palpate_report::Output last_output;
  /// The number of times that the watchdog has cut the motors.
  std::uint64_t cuts = 0;
};

class SimulatedBoard final : public Transport {
 public:
  /// The number of unread reports that hidraw keeps; it keeps the oldest. Its ring has 64 places,
  /// of which one stays empty (HIDRAW_BUFFER_SIZE in the kernel's drivers/hid/hidraw.c).
  static constexpr int kQueue = 63;
  /// The number of reports, and of forces, that can be on their way at once.
  static constexpr int kOnTheWay = 64;

  /// Makes a board that is switched on.
  /// @throws InputError the options are out of range.
  SimulatedBoard(std::shared_ptr<Clock> clock, std::shared_ptr<Motion> motion,
                 const BoardOptions& options = {});
  ~SimulatedBoard() override;

  /// The answer to the request for the feature report.
  [[nodiscard]] Report feature() const;

  TransportStatus read(Report& report, Duration timeout) noexcept override;
  TransportStatus write(const Report& report) noexcept override;
  std::string problem() const override;

  /// What the board is doing and has done. It may be called from any thread.
  [[nodiscard]] BoardStatus status() noexcept;
  /// Lets writes that block return; from then on none blocks. It may be called from any thread.
  void release_writes() noexcept;
  /// Pulls the plug of the board. It may be called from any thread.
  void unplug() noexcept;

 private:
  struct Firmware;
  std::unique_ptr<Firmware> firmware_;
};

}  // namespace palpate
