// SPDX-License-Identifier: BSD-3-Clause
// How the servo loop runs: options that are fixed, and settings that may change while it runs.
#pragma once

#include <cstdint>

#include "base/types.h"
#include "haptic/profile/specification.h"
#include "haptic/realtime/clock.h"

namespace palpate {

/// Options that are fixed while the loop runs.
struct ServoOptions {
  /// The period of the loop, where the loop sets the pace.
  Duration period = std::chrono::milliseconds(1);
  /// A report older than this gives no force.
  Duration stale_after = std::chrono::milliseconds(5);
  /// When no fresh report has come for this long the tool lets go, and there is no force until it
  /// was outside of the body.
  Duration release_after = std::chrono::milliseconds(20);
  /// When no report of a device in lock-step has come for this long, a zero-force report is sent so
  /// that it reports again.
  Duration lock_step_timeout = std::chrono::milliseconds(2);
  /// stop() returns after this at the latest, whatever the device does.
  Duration stop_timeout = std::chrono::milliseconds(200);
  /// Real-time priority (SCHED_FIFO) of the thread, 1 to 99, where the system permits; 0: none.
  int priority = 80;
};

/// @throws InputError a value is out of range.
void validate(const ServoOptions& options);

/// Settings that may change from tick to tick.
struct ServoSettings {
  /// Whether forces are permitted. While they are not, the device is read but the tool touches
  /// nothing; afterwards there is no force until the tool was outside of the body.
  bool engaged = true;
  /// A dead-man switch: forces are permitted only as long as this button of the device is held,
  /// counted from 0; −1: no button is required.
  std::int32_t dead_man_button = -1;
  /// A rigid tool holds the active node at which it presses as long as this button of the device is
  /// held, counted from 0; −1: it only presses. The tool of a reduced body is held as long as this
  /// button is; −1: whenever the hand has come within its reach.
  std::int32_t grasp_button = -1;
  /// Place in the scene of the centre of the device's workspace [3], m. This, the rotation and the
  /// scale stay as they are while the tool touches: others take effect when it is free, and
  /// where they bring it into the body there is no force until it was outside.
  Vec3 workspace_centre = Vec3::Zero();
  /// The rotation from the device's axes to those of the scene.
  Mat3 workspace_rotation = Mat3::Identity();
  /// Metres in the scene for a metre at the device.
  double workspace_scale = 1;
  /// Newtons at the device for a newton of the body.
  double force_scale = 1;
  /// Largest force, N; 0: that of the device. It is never above that of the device.
  double force_limit = 0;
  /// Largest change of the force in a second, N/s; it may always fall to zero at once.
  double slew_limit = 500;
  /// Viscous damping of the hand while it touches, N·s/m at the device.
  double damping = 0;
  /// Whether damping is added when the sampled loop has made energy.
  bool passivity_control = true;
};

/// @throws InputError a value is out of range.
void validate(const ServoSettings& settings);
/// @throws InputError a value is out of range, or the device lacks what is required.
void validate(const ServoSettings& settings, const Specification& device);

/// The button that serves as dead-man switch where forces are wanted only while a person holds a
/// button: the first one; −1: the device has neither buttons nor motors.
/// @throws InputError the device has motors, but no button that a person could hold.
[[nodiscard]] std::int32_t dead_man_button_of(const Specification& device);

/// The largest force that may be sent, N.
/// @param limit As ServoSettings::force_limit, N.
[[nodiscard]] double largest_force(const Specification& device, double limit) noexcept;

/// The stiffness of the coupling that lets a body feel no stiffer than the device can display
/// stably, N/m in the scene; 0: the body needs no coupling.
/// @param body_stiffness The largest stiffness of the body, N/m.
[[nodiscard]] double coupling_stiffness_for(const Specification& device, double body_stiffness,
                                            const ServoSettings& settings);

/// The stiffness of the virtual coupling (simulating/simulated_tool.h) of a tool that this device
/// moves, N/m in the scene: `wanted`, or what the device displays stably where that is known and
/// less.
/// @param wanted N/m.
[[nodiscard]] double coupling_stiffness_of_tool(const Specification& device, double wanted,
                                                const ServoSettings& settings);

}  // namespace palpate
