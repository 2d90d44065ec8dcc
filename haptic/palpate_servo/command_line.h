// SPDX-License-Identifier: BSD-3-Clause
// The command line of palpate-servo.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "haptic/servo/options.h"
#include "haptic/touching/settings.h"
#include "haptic/touching/touchable.h"

namespace palpate {

enum class HandMotion { tap, press, slide, circle };

/// What --device is for a board and a hand that are not there, and to print what is plugged in.
inline constexpr const char* kSimulated = "simulated";
inline constexpr const char* kList = "list";

struct CommandLine {
  std::string space;
  /// kSimulated, kList, or a device as open_device() takes it; the n-th moves the n-th tool of a
  /// reduced model.
  std::vector<std::string> devices = {kSimulated};
  /// Which reduced model of the file is touched, from 1; empty: the state space, or in a file that
  /// has none its only model.
  std::optional<std::int64_t> reduced;
  HandMotion motion = HandMotion::press;
  /// How deep the simulated hand wants to be, m in the scene; 0: half of what the space reaches, or
  /// 0.6 of what the reduced model was trained for.
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
  /// stiffer; of a reduced body that of SimulatedToolOptions, or what the device displays.
  std::optional<double> coupling;
  /// The damping of the coupling to a reduced body, N·s/m.
  double coupling_damping = 0;
  /// The length of a step of a reduced body, s.
  double step = 0.002;
  /// The options that were given, as "--depth".
  std::set<std::string> given;
};

/// Reads the command line.
/// @return Empty: help was asked for, and printed.
/// @throws InputError an argument makes no sense.
[[nodiscard]] std::optional<CommandLine> parse_command_line(int argc, char** argv);

}  // namespace palpate
