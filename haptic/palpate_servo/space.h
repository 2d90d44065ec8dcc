// SPDX-License-Identifier: BSD-3-Clause
// One device touches a state space.
#pragma once

#include <optional>

#include "haptic/palpate_servo/command_line.h"
#include "state_space/state_space_file.h"

namespace palpate {

/// Touches the space of a file, or without one says where the device is.
/// @return The exit code of the program.
/// @throws InputError, BackendError what is wrong with what was given or the device.
int touch_space(CommandLine line, std::optional<StateSpaceFile> file);

/// Runs the ticks of the recording again.
/// @return, @throws As touch_space().
int replay_space(CommandLine line, const StateSpaceFile& file);

}  // namespace palpate
