// SPDX-License-Identifier: BSD-3-Clause
// What a device measures and reports.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>

#include "base/types.h"
#include "haptic/realtime/clock.h"

namespace palpate {

/// The state of a device. Axes are those of CHAI3D: x towards the user, y to the user's right, z
/// up.
struct DeviceState {
  /// Position of the point that is held, from the centre of the workspace [3], m.
  Vec3 position = Vec3::Zero();
  /// Rotation from the tool's axes to the device's.
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  /// Bit i: button i is held down.
  std::uint32_t buttons = 0;
  /// When the device measured, by its own clock, which does not wrap here. It has no meaning where
  /// Specification::has_device_time is false.
  Time device_time{0};
  /// The number of the report, where the device counts them. It goes back with the force that
  /// answers the report.
  std::uint32_t counter = 0;
  /// The rates of the position [3], m/s, and of the rotation [3], rad/s, of a device that reports
  /// rates.
  Vec3 rate = Vec3::Zero();
  Vec3 angular_rate = Vec3::Zero();
  /// Whether the device was calibrated, where it needs that.
  bool calibrated = false;
  /// Angles of the joints [3], rad, of a device whose forces are computed from them.
  Vec3 joints = Vec3::Zero();
};

}  // namespace palpate
