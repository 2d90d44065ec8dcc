// SPDX-License-Identifier: BSD-3-Clause
// A tool that is turned freely. Its coordinates are the place p of its reference point y_r, and how
// far it is turned, as lengths: s = L θ, so that all coordinates are in m, and all of what follows
// from them is in N and N/m. With the rotation vector ω of θ and the orientation R₀ of θ = 0,
//
//   R(q) = exp[ω]× R₀,   place(q) = p − R(q) y_r.
//
// A tool that is turned about all three axes has ω = θ, and six coordinates. One that is round
// about an axis e is turned across it alone: ω = θ₁ e₁ + θ₂ e₂, where e₁ and e₂ are perpendicular
// to R₀ e, and it has five. The torque τ of the tool about its reference point follows from
// τ · ω̇ = ∂Π/∂s · ṡ with the angular velocity ω̇ = J θ̇ (left Jacobian of the exponential map).
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "interaction/pose_map.h"

namespace palpate {

struct Turning {
  /// e, of unit length, in the tool's own axes; 0: the tool is turned about all three axes.
  Vec3 axis = Vec3::Zero();
  /// y_r from the tool's centre, m, in its own axes.
  Vec3 point = Vec3::Zero();
  /// R₀, of unit length.
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();
  /// L, m: a turn by an angle moves what is so far from the reference point as much as its
  /// coordinate changes.
  double lever = 1;
  /// The largest |θ|, rad, below π.
  double farthest = M_PI / 2;
  /// How far a tool is turned of which only the place is told: θ, rad; the third is 0 of one that
  /// is round.
  Vec3 angles = Vec3::Zero();

  /// The number of angles, 2 or 3.
  [[nodiscard]] int num_angles() const { return axis.isZero(0) ? 3 : 2; }
  /// The directions in the scene about which the angles turn, as columns; of a tool that is round
  /// the third is 0.
  [[nodiscard]] Mat3 axes() const;
  /// θ of an orientation of the tool. The roll of one that is round is left out.
  /// @note Realtime-safe.
  [[nodiscard]] Vec3 angles_of(const Eigen::Quaterniond& turned) const noexcept;
  /// R.
  /// @note Realtime-safe.
  [[nodiscard]] Eigen::Quaterniond orientation_at(const Vec3& theta) const noexcept;
  /// The coordinates at a place, as the tool is turned by θ.
  [[nodiscard]] Eigen::VectorXd coordinates(const Vec3& place, const Vec3& theta) const;
  /// θ of coordinates.
  [[nodiscard]] Vec3 angles_at(const Eigen::VectorXd& q) const;
  /// τ, N·m.
  /// @param by_angle ∂Π/∂θ, N·m.
  /// @note Realtime-safe.
  [[nodiscard]] Vec3 torque(const Vec3& theta, const Vec3& by_angle) const noexcept;

  /// In the order of the members, the quaternion as w, x, y, z.
  [[nodiscard]] std::vector<double> numbers() const;
  /// @throws InputError these are not kCount finite numbers, or one is out of its range.
  [[nodiscard]] static Turning from(const std::vector<double>& numbers);

  static constexpr std::size_t kCount = 15;
};

/// The tool at the orientations of a grid that holds each one it may have. The angles of one are
/// multiples of the same step along each axis.
struct TurnGrid {
  std::vector<Turning> turns;
  /// rad.
  double step = 0;
};
/// @param spacing The step at most, rad.
[[nodiscard]] TurnGrid grid_of_turns(const Turning& turning, double spacing);

/// "turned across its axis, by at most 60 degrees, here by 15 degrees and -15 degrees".
[[nodiscard]] std::string description(const Turning& turning);

[[nodiscard]] PoseMapPtr turned_pose(const Turning& turning);

}  // namespace palpate
