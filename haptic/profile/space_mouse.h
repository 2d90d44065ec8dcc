// SPDX-License-Identifier: BSD-3-Clause
// 3Dconnexion's SpaceMouse and its relatives: a cap that is pushed and turned, without motors.
//
// The device reports the deflection of the cap. The profile takes it as a rate and integrates it;
// the point stays within the workspace. While nothing changes, no report comes.
//
// Input reports, little endian: 1 translation int16 × 3, or of newer ones translation and rotation
// int16 × 6; 2 rotation int16 × 3; 3 buttons, a bit each. Full deflection is about 350
// counts. Its axes are right, towards the user, down, and turns are right-handed about them, as in
// spacenavd (github.com/FreeSpacenav/spacenavd) with ROS's spacenav_node.
#pragma once

#include "haptic/profile/profile.h"

namespace palpate {

class SpaceMouse final : public Profile {
 public:
  /// Speed of the point, m/s, and turn, rad/s, at full deflection.
  static constexpr double kFullSpeed = 0.1;
  static constexpr double kFullTurn = 1.5;
  static constexpr int kFullDeflection = 350;
  /// A deflection of fewer counts is taken for none, because the cap does not return to zero
  /// exactly.
  static constexpr int kDeadZone = 10;

  SpaceMouse();

  [[nodiscard]] static bool matches(const DeviceInfo& device) noexcept;

  bool decode(const Report& report, DeviceState& state) const noexcept override;
  void advance(DeviceState& state, Duration duration) const noexcept override;
  /// Gives an empty report, because there are no motors.
  Report zero_force(const DeviceState& state) const noexcept override;

 private:
  Report do_encode(const Vec3& force, const DeviceState& state) const noexcept override;
};

}  // namespace palpate
