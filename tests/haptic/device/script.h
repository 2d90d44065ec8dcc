// SPDX-License-Identifier: BSD-3-Clause
// What the hand at the board does, and what goes wrong meanwhile: one stroke after another, each
// into the body, along in it, and out again, with a fault while it is inside.
#pragma once

#include <array>

#include "base/types.h"

namespace palpate::test {

enum class Fault {
  none,
  /// The board is silent.
  device_pause,
  /// The servo's process does not run; the board goes on.
  host_pause,
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
  [[nodiscard]] bool begins(int step) const {
    return fault != Fault::none && step == kFaultFrom;
  }
  [[nodiscard]] bool ends(int step) const {
    return fault != Fault::none && step == kFaultFrom + fault_length;
  }
  [[nodiscard]] Fault fault_at(int step) const {
    return step >= kFaultFrom && step < kFaultFrom + fault_length ? fault : Fault::none;
  }
};

inline constexpr std::array kScript{
    Stroke{},
    Stroke{Fault::device_pause, 100},
    Stroke{Fault::host_pause, 200, 600},
    Stroke{Fault::wrong_size, 50},
    Stroke{Fault::doubled, 50},
    Stroke{Fault::frozen, 50},
    Stroke{Fault::empty, 50},
    Stroke{Fault::unplug, 100},
    // The kernel waits 5 s for a feature report.
    Stroke{Fault::stall, 100, 6000},
    Stroke{Fault::stop, 50},
    Stroke{},
    Stroke{Fault::leave, 50},
};

/// Where the stylus is, in the device's axes, m: above the body, down into it, along, up.
[[nodiscard]] Vec3 stylus(int stroke, int step);

}  // namespace palpate::test
