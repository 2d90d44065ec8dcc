// SPDX-License-Identifier: BSD-3-Clause
// Moves the bytes of reports between a device and the servo loop, without knowing what they mean.
#pragma once

#include <string>

#include "haptic/guardian/channel.h"
#include "haptic/profile/report.h"
#include "haptic/realtime/clock.h"

namespace palpate {

enum class TransportStatus {
  /// A report was read, or written.
  data,
  /// There is no report (yet).
  nothing,
  /// The device is unplugged, and nothing will come any more.
  gone,
  /// Something failed this time; problem() says what.
  error,
};

class Transport {
 public:
  virtual ~Transport() = default;

  /// Reads the oldest report that was not read yet.
  /// @param timeout How long to wait for a report; 0: not at all.
  /// @note Realtime-safe but for the device's own calls.
  [[nodiscard]] virtual TransportStatus read(Report& report, Duration timeout) noexcept = 0;

  /// Writes a report. It may block for as long as the device's driver does, which can be seconds.
  [[nodiscard]] virtual TransportStatus write(const Report& report) noexcept = 0;

  /// The guardian, which sets the motors to zero when this process no longer does; nullptr: there
  /// is none.
  [[nodiscard]] virtual GuardianChannel* guardian() noexcept { return nullptr; }

  /// Tells the guardian that the calling thread lives. It is the thread by which a person commands
  /// this program.
  virtual void host_lives() noexcept {}

  /// What was last wrong, in words; empty: nothing. It may be called from any thread.
  [[nodiscard]] virtual std::string problem() const = 0;
};

}  // namespace palpate
