// SPDX-License-Identifier: BSD-3-Clause
// Several devices touch a reduced model, one for each of its tools.
#pragma once

#include "haptic/palpate_servo/command_line.h"
#include "haptic/palpate_servo/reduced_file.h"

namespace palpate {

/// @return The exit code of the program.
/// @throws InputError, BackendError what is wrong with what was given or a device.
int touch_reduced(const CommandLine& line, StateSpaceFile file);

}  // namespace palpate
