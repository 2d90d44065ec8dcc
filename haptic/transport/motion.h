// SPDX-License-Identifier: BSD-3-Clause
// The motion of the point of a simulated device: the hand, and the mechanics between it and the
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
    /// Position, rotation and buttons as in DeviceState.
    Vec3 position = Vec3::Zero();
    Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
    std::uint8_t buttons = 0;
  };

  virtual ~Motion() = default;

  /// Moves the point on.
  /// @param time The time until which the point moves, since the board was switched on. It never
  ///   goes back from call to call.
  /// @param force The force of the motors, which was constant since the last call [3], N.
  /// @return Where the point is then.
  virtual Pose advance(Time time, const Vec3& force) noexcept = 0;
};

/// A motion that does not depend on the force.
class ScriptedMotion final : public Motion {
 public:
  struct Waypoint {
    Time time{0};
    Vec3 position = Vec3::Zero();
  };

  explicit ScriptedMotion(std::function<Pose(Time)> pose) : pose_(std::move(pose)) {}
  /// The point goes from waypoint to waypoint, from rest to rest with the least jerk. Before the
  /// first and after the last waypoint it is at rest there.
  /// @param repeat Whether the script begins anew after the last waypoint.
  /// @throws InputError there are no waypoints, or their times do not increase.
  explicit ScriptedMotion(std::vector<Waypoint> waypoints, bool repeat = false);

  Pose advance(Time time, const Vec3& force) noexcept override;

 private:
  std::function<Pose(Time)> pose_;
};

/// A motion that follows a target which another thread sets. It is critically damped, so that
/// neither position nor velocity jumps.
class MouseMotion final : public Motion {
 public:
  /// @param settling The time constant.
  explicit MouseMotion(Duration settling = std::chrono::milliseconds(15))
      : settling_(seconds(settling)) {}

  /// Call this from one thread.
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
