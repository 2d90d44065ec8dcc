// SPDX-License-Identifier: BSD-3-Clause
// Tells the guardian's channels that this program has crashed or was asked to end, before any other
// handler of the signal runs.
//
// Neither need end a program. The other handler may wait for ever: ParaView's, also that of SIGTERM
// and SIGINT, prints where the program was. For that it allocates memory, and it waits for ever
// where the signal has interrupted an allocation, which holds the lock. The servo loop, on a thread
// of its own, would go on. And whoever asks a program to end wants no force from it while it tidies
// up.
//
// So this handler is put in front of the one that is there. It only says `crashed` or `ending` in
// each channel. Then it gives way: it restores the earlier handler and sends the signal again, with
// the same information, so that the program ends, or does not, as if this handler were not there.
#pragma once

#include <signal.h>

#include <array>

#include "haptic/guardian/channel.h"

namespace palpate {

/// A signal, and the state of the host that follows from it.
struct HostSignal {
  int signal;
  HostState state;
};

/// The signals after which a host may live on, though nobody should command its motors any more.
inline constexpr std::array<HostSignal, 9> kHostSignals = {{{SIGSEGV, HostState::crashed},
                                                            {SIGABRT, HostState::crashed},
                                                            {SIGBUS, HostState::crashed},
                                                            {SIGFPE, HostState::crashed},
                                                            {SIGILL, HostState::crashed},
                                                            {SIGTERM, HostState::ending},
                                                            {SIGINT, HostState::ending},
                                                            {SIGHUP, HostState::ending},
                                                            {SIGQUIT, HostState::ending}}};

/// As long as this object lives, its channel hears of such signals.
class HostSignals {
 public:
  /// @throws BackendError too many devices are open.
  explicit HostSignals(GuardianChannel& channel);
  ~HostSignals();
  HostSignals(const HostSignals&) = delete;
  HostSignals& operator=(const HostSignals&) = delete;

  /// Puts the handler in front again where another one was set since.
  static void stay_in_front() noexcept;

 private:
  GuardianChannel& channel_;
};

}  // namespace palpate
