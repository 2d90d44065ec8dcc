// SPDX-License-Identifier: BSD-3-Clause
// The devices that the program opens: real ones, or a simulated board with a simulated hand.
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
  /// What a recording says about the device.
  RecordedSetup setup;
  /// The path of the device in the system; empty: the device is simulated.
  std::string path;
  /// The transport, where it is simulated; else nullptr.
  SimulatedBoard* board = nullptr;
};

/// The motion of a simulated hand: from the centre of the workspace down, again and again.
struct Wish {
  HandMotion motion = HandMotion::press;
  /// The way from the centre of the workspace to where the hand touches, and from there on down, m
  /// in the scene.
  double clearance = 0;
  double depth = 0;
};

/// @param scale Metres in the scene for a metre at the device.
/// @throws InputError the workspace is too small for the motion.
[[nodiscard]] Device simulated_device(const std::shared_ptr<Clock>& clock, const Wish& wish,
                                      double scale);
/// @param which As open_device() takes it.
/// @throws InputError, BackendError as open_device().
[[nodiscard]] Device opened_device(const std::string& which);

/// The distance of the centre of a workspace above the surface that is touched, m in the scene.
/// @param scale Metres in the scene for a metre at the device.
[[nodiscard]] double clearance_of(const Specification& device, double scale);
/// The same for a simulated device.
[[nodiscard]] double clearance_of_simulated(double scale);

/// Puts the device's workspace over a place, its z along the outward normal: down is into the body.
/// @param place The centre of the workspace [3], m. @param normal [3], of unit length.
void place_workspace(const Vec3& place, const Vec3& normal, ServoSettings& settings);

/// Prints a line for each device that is plugged in.
void print_devices();

}  // namespace palpate
