// SPDX-License-Identifier: BSD-3-Clause
// What the hand at the board does, and what goes wrong meanwhile: one stroke after another, each
// into the body, along in it, and out again, with a fault while it is inside.
#pragma once

#include <vector>

#include "base/types.h"

namespace palpate::test {

enum class Fault {
  none,
  /// The board is silent.
  device_pause,
  /// Silent, and the stylus is 5 cm away when the reports come again.
  away,
  /// The host's program gets a signal: SIGSTOP, and SIGCONT at the end.
  host_pause,
  /// SIGKILL, SIGSEGV, and SIGINT for its whole process group, as Ctrl+C has it. At the end the
  /// program is started again.
  kill,
  crash,
  interrupt,
  /// Writes fail; not of the board either: button 2 tells the program to let them.
  write_error,
  /// Reports end early, or late.
  wrong_size,
  /// Each report comes twice.
  doubled,
  /// The same report comes again and again.
  frozen,
  /// Packets without a byte.
  empty,
  unplug,
  /// Unplugged; when it is back the first question for the feature report stays without answer.
  stall,
  /// Not of the board: the person presses button 0, and the program stops the loop.
  stop,
  /// Button 1: the program ends without having stopped the loop.
  leave,
};

/// As in the log.
[[nodiscard]] const char* name(Fault fault);

/// Lengths are in reports of the board.
struct Stroke {
  Fault fault = Fault::none;
  int fault_length = 0;
  int length = 500;

  /// While the stylus is inside.
  static constexpr int kFaultFrom = 180;
  [[nodiscard]] bool begins(int step) const { return fault != Fault::none && step == kFaultFrom; }
  [[nodiscard]] bool ends(int step) const {
    return fault != Fault::none && step == kFaultFrom + fault_length;
  }
  [[nodiscard]] Fault fault_at(int step) const {
    return step >= kFaultFrom && step < kFaultFrom + fault_length ? fault : Fault::none;
  }
};

/// Each fault once.
[[nodiscard]] std::vector<Stroke> script();

/// The faults that end or stop the host's program, that many times each.
[[nodiscard]] std::vector<Stroke> trials(int number);

/// Where the stylus is, in the device's axes, m: above the body, down into it, along, up.
/// @param number Of the stroke in its script.
[[nodiscard]] Vec3 stylus(const Stroke& stroke, int number, int step);

}  // namespace palpate::test
