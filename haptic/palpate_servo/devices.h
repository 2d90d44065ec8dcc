// SPDX-License-Identifier: BSD-3-Clause
// The devices that the program opens: real ones, and a board and a hand that are not there.
#pragma once

#include <memory>
#include <string>

#include "haptic/palpate_servo/command_line.h"
#include "haptic/recording/setup.h"
#include "haptic/servo/options.h"
#include "haptic/transport/simulated_board.h"

namespace palpate {

struct Device {
  std::unique_ptr<Transport> transport;
  std::shared_ptr<const Profile> profile;
  /// What a recording says of it.
  RecordedSetup setup;
  /// Of the system; empty where it is simulated.
  std::string path;
  /// The same as the transport where it is simulated.
  SimulatedBoard* board = nullptr;
};

/// What a simulated hand wants: from the centre of the workspace down, again and again.
struct Wish {
  HandMotion motion = HandMotion::press;
  /// From the centre of the workspace to where it touches, and from there on, m in the scene.
  double clearance = 0;
  double depth = 0;
};

/// @param scale Metres in the scene for a metre at the device.
/// @throws InputError the workspace ends before.
[[nodiscard]] Device simulated_device(const std::shared_ptr<Clock>& clock, const Wish& wish,
                                      double scale);
/// @param which As open_device() takes it.
/// @throws InputError, BackendError as open_device().
[[nodiscard]] Device opened_device(const std::string& which);

/// How far the centre of a workspace is put above what is touched there, m in the scene.
/// @param scale Metres in the scene for a metre at the device.
[[nodiscard]] double clearance_of(const Specification& device, double scale);
/// The same of a simulated device.
[[nodiscard]] double clearance_of_simulated(double scale);

/// Puts the device's workspace over a place, its z along the outward normal: down is into the body.
/// @param place Of its centre [3], m. @param normal [3], of unit length.
void place_workspace(const Vec3& place, const Vec3& normal, ServoSettings& settings);

/// A line for each device that is plugged in.
void print_devices();

}  // namespace palpate
