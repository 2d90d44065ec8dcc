// SPDX-License-Identifier: BSD-3-Clause
// The board: a stylus with motors that speaks our own report and goes through the script. What it
// sends and what comes goes into the log:
//
//   units <m> <N>                              kPositionUnit, kForceUnit
//   in <µs> <counter> <x> <y> <z> <how>        an input report, in counts of kPositionUnit
//   out <µs> <counter> <x> <y> <z> <number> <size>   a force report, in counts of kForceUnit
//   open|close <µs>                            someone begins, ends to use the device
//   ask <µs> answered|stalled                  the feature report is asked for
//   stroke <µs> <fault>                        of the script
//   begin|end <µs> <fault>
#pragma once

#include <utility>
#include <vector>

#include "haptic/device/firmware.h"
#include "haptic/device/host.h"
#include "haptic/device/log.h"
#include "haptic/device/script.h"
#include "haptic/device/uhid.h"

namespace palpate::test {

class Board {
 public:
  /// m and N.
  static constexpr double kPositionUnit = 1e-6;
  static constexpr double kForceUnit = 2e-4;

  /// @param host Whose program uses the board.
  Board(Log& log, Host& host, std::vector<Stroke> script)
      : log_(log), host_(host), script_(std::move(script)) {}

  /// Waits for the first force report, but not forever, and then goes through the script.
  void run();

 private:
  void plug();
  void unplug();
  void take_event();
  void step();
  void begin(Fault fault);
  void end(Fault fault);
  void send(const char* how, std::size_t size);

  Log& log_;
  Host& host_;
  std::vector<Stroke> script_;
  Uhid uhid_;
  /// Someone reads: a device that nobody reads sends nothing.
  bool open_ = false;
  bool stalls_ = false;
  /// Place in the script; −1: it has not begun.
  int stroke_ = -1;
  int step_ = 0;
  /// Reports before it began.
  int waited_ = 0;
  /// The board's clock.
  std::uint32_t time_us_ = 0;
  firmware::Input measured_;
};

}  // namespace palpate::test
