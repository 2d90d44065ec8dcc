// SPDX-License-Identifier: BSD-3-Clause
// What palpate-servo is asked for.
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
  /// "simulated", "list", or as for open_device().
  std::string device = "simulated";
  HandMotion motion = HandMotion::press;
  /// Where the simulated hand wants to be, m in the scene; 0: half of what the space reaches.
  double depth = 0;
  /// Point of the mesh; none: the first active one.
  std::optional<Index> node;
  /// 0: until a signal.
  double seconds = 60;
  std::string record;
  std::string replay;
  TouchableOptions touchable;
  ServoOptions options;
  ServoSettings settings;
  TouchSettings touch;
  /// None: as stiff as the device displays, where the body is stiffer.
  std::optional<double> coupling;
};

/// @return None: help was asked for, and printed.
/// @throws InputError what is given makes no sense.
[[nodiscard]] std::optional<CommandLine> parse_command_line(int argc, char** argv);

}  // namespace palpate
