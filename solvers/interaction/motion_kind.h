// SPDX-License-Identifier: BSD-3-Clause
// The meaning of the numbers of a stored tool's motion (rigid_tool.h), for each kind of motion. A
// kind makes the map from coordinates to poses (pose_map.h).
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "assembly/scene.h"
#include "interaction/pose_map.h"
#include "interaction/rigid_tool.h"

namespace palpate {

class MotionKind {
 public:
  virtual ~MotionKind() = default;
  MotionKind(const MotionKind&) = delete;
  MotionKind& operator=(const MotionKind&) = delete;

  /// The number under which the kind is stored.
  [[nodiscard]] virtual ToolMotion number() const = 0;
  /// @throws InputError the numbers are not those of such a motion.
  [[nodiscard]] virtual PoseMapPtr make(const std::vector<double>& numbers) const = 0;
  /// The motion in words: "translated".
  [[nodiscard]] virtual std::string description(const std::vector<double>& /*numbers*/) const {
    return "turned";
  }
  /// Fills in numbers that were left open, for a body.
  /// @throws InputError the motion does not suit the body.
  virtual void complete(const Scene& /*scene*/, std::vector<double>& /*numbers*/) const {}
  /// Turns the tool as it is at each place of which no orientation is told.
  /// @throws InputError it cannot be turned so far, or not at all.
  virtual void turn(const Eigen::Quaterniond& orientation, std::vector<double>& numbers) const;
  /// The torque of a tool about the point around which it turns [3], N·m; nothing: it does not
  /// turn.
  /// @param q,h Its coordinates and ∂Π/∂q [d].
  [[nodiscard]] virtual std::optional<Vec3> torque(const std::vector<double>& /*numbers*/,
                                                   const Eigen::VectorXd& /*q*/,
                                                   const Eigen::VectorXd& /*h*/) const {
    return {};
  }

 protected:
  MotionKind() = default;
};

/// The kind with a number.
/// @throws InputError there is no such kind.
[[nodiscard]] const MotionKind& motion_kind(ToolMotion number);

/// Adds a kind for as long as the program runs. Call this before any tool of the kind is made.
/// @throws InputError its number is taken.
void add_motion_kind(std::unique_ptr<const MotionKind> kind);

}  // namespace palpate
