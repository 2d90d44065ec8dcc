// SPDX-License-Identifier: BSD-3-Clause
// The processor time that a piece of work takes.
#pragma once

#include <ctime>

namespace palpate {

/// The processor time of the calling thread alone, s; other load on the machine does not count.
inline double own_seconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace palpate
