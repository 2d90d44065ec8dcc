// SPDX-License-Identifier: BSD-3-Clause
// What a device can do.
#pragma once

#include <array>
#include <string>

#include "haptic/realtime/clock.h"

namespace palpate {

/// Who sets the pace of the servo loop.
enum class Pacing {
  /// The device reports by itself; the loop goes by a clock of its own.
  free_running,
  /// The device reports in answer to each force, and the loop waits for the report.
  lock_step,
  /// The device reports when something changes, so that silence means that nothing does.
  on_change,
};

struct Specification {
  std::string manufacturer;
  std::string model;
  /// Largest force that may be sent, N; 0: the device has no motors.
  double max_linear_force = 0;
  /// Largest stiffness that the device displays stably at 1 kHz, N/m.
  double max_linear_stiffness = 0;
  /// Largest damping that the device displays stably at 1 kHz, N·s/m.
  double max_linear_damping = 0;
  /// Radius of the sphere that the hand can reach, m.
  double workspace_radius = 0;
  /// The smallest steps of position, m, and of force, N; 0: not known.
  double position_resolution = 0;
  double force_resolution = 0;
  std::array<bool, 3> actuated{};
  bool senses_rotation = false;
  int num_buttons = 0;
  Pacing pacing = Pacing::free_running;
  /// Whether reports tell when the device measured.
  bool has_device_time = false;
  /// The time without a force report after which the device itself switches its motors off; 0:
  /// never.
  Duration watchdog{0};
};

}  // namespace palpate
