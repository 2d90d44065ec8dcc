// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/palpate_servo/signals.h"

#include <pthread.h>

#include <initializer_list>

namespace palpate {

Signals::Signals() {
  sigemptyset(&signals_);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGTSTP}) {
    sigaddset(&signals_, signal);
  }
  pthread_sigmask(SIG_BLOCK, &signals_, &before_);
}

Signals::~Signals() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }

bool Signals::wait_for(std::chrono::milliseconds time) const {
  const timespec timeout{0, static_cast<long>(time.count()) * 1'000'000};
  return sigtimedwait(&signals_, nullptr, &timeout) > 0;
}

}  // namespace palpate
