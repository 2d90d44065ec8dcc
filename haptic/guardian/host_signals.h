// SPDX-License-Identifier: BSD-3-Clause
// Tells the guardian's channels that this program crashes, or is asked to end, before anything
// else handles that.
//
// Neither need end a program. What handles the signal may wait for ever: ParaView's handler, of
// SIGTERM and SIGINT too, prints where the program was, for which it allocates, and waits for the
// lock of the allocation that the signal has come into. The servo loop has a thread of its own, and
// would go on. Who asks a program to end wants no force from it, either, as long as it tidies up.
//
// So here is a handler in front of the one that is there, which does no more than say `crashed` or
// `ending` in each channel. Then it gives way: it restores what was there and sends the signal
// again, with the same information, so that the program ends, or does not, as if nobody had been in
// between.
#pragma once

#include <signal.h>

#include <array>

#include "haptic/guardian/channel.h"

namespace palpate {

/// A signal, and what it makes of the host.
struct HostSignal {
  int signal;
  HostState state;
};

/// The signals that a host may live on after, though nobody should command its motors any more.
inline constexpr std::array<HostSignal, 9> kHostSignals = {{{SIGSEGV, HostState::crashed},
                                                            {SIGABRT, HostState::crashed},
                                                            {SIGBUS, HostState::crashed},
                                                            {SIGFPE, HostState::crashed},
                                                            {SIGILL, HostState::crashed},
                                                            {SIGTERM, HostState::ending},
                                                            {SIGINT, HostState::ending},
                                                            {SIGHUP, HostState::ending},
                                                            {SIGQUIT, HostState::ending}}};

/// A channel that hears of such signals, as long as this lives.
class HostSignals {
 public:
  /// @throws BackendError there are too many.
  explicit HostSignals(GuardianChannel& channel);
  ~HostSignals();
  HostSignals(const HostSignals&) = delete;
  HostSignals& operator=(const HostSignals&) = delete;

  /// Puts the handler in front of those that were set since, too.
  static void stay_in_front() noexcept;

 private:
  GuardianChannel& channel_;
};

}  // namespace palpate
