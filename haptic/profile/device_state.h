// SPDX-License-Identifier: BSD-3-Clause
// What a device says of itself in a report.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>

#include "base/types.h"
#include "haptic/realtime/clock.h"

namespace palpate {

/// Axes as in CHAI3D: x towards the user, y to the user's right, z up.
struct DeviceState {
  /// Of the point that is held, from the centre of the workspace [3], m.
  Vec3 position = Vec3::Zero();
  /// From the tool's axes to the device's.
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  /// Bit i: button i is held down.
  std::uint32_t buttons = 0;
  /// When the device measured, by its own clock, which does not wrap here; meaningless where the
  /// profile has_device_time is false.
  Time device_time{0};
  /// Of the report, as far as the device counts them; goes back with the force that answers it.
  std::uint32_t counter = 0;
  /// Where the device tells rates: of the position [3], m/s, and of the rotation [3], rad/s.
  Vec3 rate = Vec3::Zero();
  Vec3 angular_rate = Vec3::Zero();
  /// A device that has to be calibrated was.
  bool calibrated = false;
  /// Angles of the joints [3], rad, where forces take the way by these.
  Vec3 joints = Vec3::Zero();
};

}  // namespace palpate
