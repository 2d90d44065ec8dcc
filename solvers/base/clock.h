// SPDX-License-Identifier: BSD-3-Clause
// The clock by which times are taken.
#pragma once

#include <chrono>

namespace palpate {

using SteadyClock = std::chrono::steady_clock;

inline double seconds_since(SteadyClock::time_point start) {
  return std::chrono::duration<double>(SteadyClock::now() - start).count();
}

}  // namespace palpate
