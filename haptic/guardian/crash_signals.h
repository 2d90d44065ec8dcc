// SPDX-License-Identifier: BSD-3-Clause
// Tells the guardian's channels that this program crashes, before anything else handles that.
//
// A crash need not end a program. What handles the signal may wait for ever: ParaView's handler
// prints where the program was, for which it allocates, and waits for the lock of the allocation
// that has crashed. The servo loop has a thread of its own, and would go on.
//
// So here is a handler in front of the one that is there, which does no more than say `crashed` in
// each channel. Then it gives way: it restores what was there and sends the signal again, with the
// same information, so that the program ends, or does not, as if nobody had been in between.
#pragma once

#include "haptic/guardian/channel.h"

namespace palpate {

/// A channel that hears of a crash, as long as this lives.
class CrashSignals {
 public:
  /// @throws BackendError there are too many.
  explicit CrashSignals(GuardianChannel& channel);
  ~CrashSignals();
  CrashSignals(const CrashSignals&) = delete;
  CrashSignals& operator=(const CrashSignals&) = delete;

  /// Puts the handler in front of those that were set since, too.
  static void stay_in_front() noexcept;

 private:
  GuardianChannel& channel_;
};

}  // namespace palpate
