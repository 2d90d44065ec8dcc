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

/// The values of --device that ask for a simulated board and hand, and for a list of the devices
/// that are plugged in.
inline constexpr const char* kSimulated = "simulated";
inline constexpr const char* kList = "list";

struct CommandLine {
  std::string space;
  /// kSimulated, kList, or a device as open_device() takes it. The n-th device moves the n-th tool
  /// of a reduced model.
  std::vector<std::string> devices = {kSimulated};
  /// The number of the reduced model of the file that is touched, from 1; empty: the state space is
  /// touched or, in a file that has none, the only model.
  std::optional<std::int64_t> reduced;
  HandMotion motion = HandMotion::press;
  /// How deep the simulated hand wants to be, m in the scene; 0: half of the depth of the space, or
  /// 0.6 of the displacement that the reduced model was trained for.
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
  /// stiffer. For a reduced body it is that of SimulatedToolOptions, or what the device displays
  /// where that is less.
  std::optional<double> coupling;
  /// The damping of the coupling to a reduced body, N·s/m.
  double coupling_damping = 0;
  /// The length of a step of a reduced body, s.
  double step = 0.002;
  /// The options that were given, such as "--depth".
  std::set<std::string> given;
};

/// Reads the command line.
/// @return The command line; empty: help was asked for, and was printed.
/// @throws InputError an argument makes no sense.
[[nodiscard]] std::optional<CommandLine> parse_command_line(int argc, char** argv);

}  // namespace palpate
