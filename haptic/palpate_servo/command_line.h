// SPDX-License-Identifier: BSD-3-Clause
// The command line of palpate-servo.
#pragma once

#include <optional>
#include <string>

#include "haptic/servo/options.h"
#include "haptic/touching/settings.h"
#include "haptic/touching/touchable.h"

namespace palpate {

enum class HandMotion { tap, press, slide, circle };

struct CommandLine {
  std::string space;
  /// "simulated", "list", or a device as open_device() takes it.
  std::string device = "simulated";
  HandMotion motion = HandMotion::press;
  /// How deep the simulated hand wants to be, m in the scene; 0: half of what the space reaches.
  double depth = 0;
  /// The point of the mesh that is touched; empty: the first active node.
  std::optional<Index> node;
  /// How long the loop runs, s; 0: until a signal comes.
  double seconds = 60;
  std::string record;
  std::string replay;
  TouchableOptions touchable;
  ServoOptions options;
  ServoSettings settings;
  TouchSettings touch;
  /// The stiffness of the coupling, N/m; empty: what the device displays, where the body is
  /// stiffer.
  std::optional<double> coupling;
};

/// Reads the command line.
/// @return Empty: help was asked for, and printed.
/// @throws InputError an argument makes no sense.
[[nodiscard]] std::optional<CommandLine> parse_command_line(int argc, char** argv);

}  // namespace palpate
