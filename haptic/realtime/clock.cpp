// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/realtime/clock.h"

#include <ctime>

#include <cerrno>

namespace palpate {

Time MonotonicClock::now() noexcept {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return std::chrono::seconds(now.tv_sec) + std::chrono::nanoseconds(now.tv_nsec);
}

void MonotonicClock::sleep_until(Time time) noexcept {
  const auto whole = std::chrono::duration_cast<std::chrono::seconds>(time);
  const timespec until{static_cast<time_t>(whole.count()),
                       static_cast<long>((time - whole).count())};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
  }
}

}  // namespace palpate
