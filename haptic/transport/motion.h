// SPDX-License-Identifier: BSD-3-Clause
// What moves the point of a simulated device: the hand, and the mechanics between it and the
// motors.
#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <vector>

#include "base/types.h"
#include "haptic/realtime/clock.h"
#include "haptic/realtime/triple_buffer.h"

namespace palpate {

class Motion {
 public:
  struct Pose {
    /// As in DeviceState.
    Vec3 position = Vec3::Zero();
    Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
    std::uint8_t buttons = 0;
  };

  virtual ~Motion() = default;

  /// Moves on.
  /// @param time Where to, since the board was switched on; never before that of the last call.
  /// @param force Of the motors, constant since the last call [3], N.
  /// @return Where the point then is.
  virtual Pose advance(Time time, const Vec3& force) noexcept = 0;
};

/// Goes its way whatever the force.
class ScriptedMotion final : public Motion {
 public:
  struct Waypoint {
    Time time{0};
    Vec3 position = Vec3::Zero();
  };

  explicit ScriptedMotion(std::function<Pose(Time)> pose) : pose_(std::move(pose)) {}
  /// From rest to rest between two waypoints, with the least jerk; before the first and after the
  /// last at rest there.
  /// @param repeat From the last the script begins anew.
  /// @throws InputError there are none, or their times do not increase.
  explicit ScriptedMotion(std::vector<Waypoint> waypoints, bool repeat = false);

  Pose advance(Time time, const Vec3& force) noexcept override;

 private:
  std::function<Pose(Time)> pose_;
};

/// Follows a target that another thread sets, critically damped: no jump of position or velocity.
class MouseMotion final : public Motion {
 public:
  /// @param settling Time constant.
  explicit MouseMotion(Duration settling = std::chrono::milliseconds(15))
      : settling_(seconds(settling)) {}

  /// From one thread.
  void set_target(const Vec3& position, std::uint8_t buttons = 0) noexcept;

  Pose advance(Time time, const Vec3& force) noexcept override;

 private:
  struct Target {
    Vec3 position = Vec3::Zero();
    std::uint8_t buttons = 0;
  };

  double settling_;
  TripleBuffer<Target> target_;
  Time time_{0};
  Vec3 position_ = Vec3::Zero();
  Vec3 velocity_ = Vec3::Zero();
};

}  // namespace palpate
