// SPDX-License-Identifier: BSD-3-Clause
// What a piece of work takes of a processor.
#pragma once

#include <ctime>

namespace palpate {

/// Time that this thread alone has worked, whatever else the machine does, s.
inline double own_seconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace palpate
