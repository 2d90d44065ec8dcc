// SPDX-License-Identifier: BSD-3-Clause
// The output of palpate-servo: a line for each subject, in SI units except for times in µs.
#pragma once

#include "haptic/profile/specification.h"
#include "haptic/recording/recorder.h"
#include "haptic/servo/servo.h"
#include "haptic/simulating/reduced_body_thread.h"
#include "haptic/touching/touchable.h"
#include "haptic/transport/simulated_board.h"

namespace palpate {

void print(const Specification& device);
void print(const Touchable& body, Method method);
/// @param limit The force limit that holds, N.
void print(const Counters& counters, double limit);
void print_timing(const Statistics& statistics);
/// Prints the results of a servo loop that was stopped.
/// @param board The board of a simulated device whose loop has ended, or nullptr.
/// @param force_limit As ServoSettings::force_limit.
void print_end(Servo& servo, SimulatedBoard* board, double force_limit);
/// Prints the results of a body that was stopped.
void print_end(ReducedBodyThread& body);
/// Prints the results of a recorder that was closed.
void print(const Recorder& recorder);

}  // namespace palpate
