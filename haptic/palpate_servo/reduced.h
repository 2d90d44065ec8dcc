// SPDX-License-Identifier: BSD-3-Clause
// Lets several devices touch a reduced model, one for each of its tools.
#pragma once

#include "haptic/palpate_servo/command_line.h"
#include "haptic/palpate_servo/reduced_file.h"

namespace palpate {

/// @return The exit code of the program.
/// @throws InputError, BackendError an argument, the file or a device is at fault.
int touch_reduced(const CommandLine& line, StateSpaceFile file);

}  // namespace palpate
