// SPDX-License-Identifier: BSD-3-Clause
// Lets one device touch a state space.
#pragma once

#include <optional>

#include "haptic/palpate_servo/command_line.h"
#include "storage/state_space_file.h"

namespace palpate {

/// Touches the space of a file. Without a file it prints where the device is.
/// @return The exit code of the program.
/// @throws InputError, BackendError an argument, the file or the device is at fault.
int touch_space(CommandLine line, std::optional<StateSpaceFile> file);

/// Runs the ticks of the recording again.
/// @return, @throws Those of touch_space().
int replay_space(CommandLine line, const StateSpaceFile& file);

}  // namespace palpate
