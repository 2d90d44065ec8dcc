// SPDX-License-Identifier: BSD-3-Clause
// What a recording keeps of a tick: all that a replay needs, and all that the loop has computed
// from it.
#pragma once

#include <array>

#include "haptic/profile/report.h"
#include "haptic/realtime/ring.h"
#include "haptic/servo/options.h"
#include "haptic/servo/tick.h"
#include "haptic/touching/settings.h"

namespace palpate {

struct TickRecord {
  static constexpr int kReports = 4;

  Tick tick;
  /// The settings that held in the tick.
  ServoSettings settings;
  TouchSettings touch;
  /// The newest reports that were read in the tick, the oldest of them first; unused places hold
  /// empty reports.
  std::array<Report, kReports> received{};
  /// The report that was written, and whether writing it has failed.
  Report sent;
  bool write_failed = false;
};

using TickRing = Ring<TickRecord>;

}  // namespace palpate
