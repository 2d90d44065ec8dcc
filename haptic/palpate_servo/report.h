// SPDX-License-Identifier: BSD-3-Clause
// What palpate-servo prints: a line for each subject, in SI units, but times in µs.
#pragma once

#include "haptic/profile/specification.h"
#include "haptic/servo/statistics.h"
#include "haptic/touching/touchable.h"

namespace palpate {

void print(const Specification& device);
void print(const Touchable& body, Method method);
/// @param limit The force limit that holds, N.
void print(const Counters& counters, double limit);
void print_timing(const Statistics& statistics);

}  // namespace palpate
