// SPDX-License-Identifier: BSD-3-Clause
// The program of the person at the board: finds it, opens it, and touches a body with it, as any
// program does. Into the log, besides what make_body() writes:
//
//   workspace <scale> <R₀₀> <R₀₁> … <R₂₂>    from the device's axes to the scene's
//   opened <µs> <ms that it took> <path>
//   not_opened <µs> <ms that it took>
//   tick <µs> <state> <age, µs> <counter> …  of the loop's recording, with the reports that it read
//   gone <µs>
//   stopped <µs> <µs that it took> <whether the thread has ended>
//   counted <bad> <lost> <missed> <failed writes> <real-time priority> <memory locked>
#pragma once

#include "haptic/device/log.h"

namespace palpate::test {

/// Until button 1 is pressed.
void touch_with_the_board(Log& log);

}  // namespace palpate::test
