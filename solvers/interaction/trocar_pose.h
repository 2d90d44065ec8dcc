// SPDX-License-Identifier: BSD-3-Clause
// An instrument that goes through a trocar: it pivots about the point o and slides through it. Its
// coordinates are the place q of its tip. With the own axis e of the tool, from the tip y_t towards
// the handle, and a = (o − q)/|o − q|,
//
//   R(q) = R₁(b → a) R₀(e → b),   p(q) = q − R(q) y_t,
//
// where each of both is the least rotation from one direction to the other, and b is a direction
// about which the tool is moved. So the tool does not roll about its axis as it comes and goes. The
// torque of a force h at the tip about o is (q − o) × h.
#pragma once

#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "interaction/pose_map.h"

namespace palpate {

struct Trocar {
  /// o, m.
  Vec3 place = Vec3::Zero();
  /// e, of unit length, and y_t from the tool's centre, m: both in the tool's own axes.
  Vec3 axis = Vec3::UnitZ();
  Vec3 tip = Vec3::Zero();
  /// b, of unit length.
  Vec3 towards = Vec3::UnitZ();
  /// The largest angle between a and b, rad, at most a right one, and the largest |o − q|, m; 0:
  /// any. They are the cone in which the instrument may be, and how deep it may go.
  double tilt = M_PI / 2;
  double depth = 0;

  /// In the order of the members.
  [[nodiscard]] std::vector<double> numbers() const;
  /// @throws InputError these are not kCount finite numbers, or one is out of its range.
  [[nodiscard]] static Trocar from(const std::vector<double>& numbers);

  static constexpr std::size_t kCount = 14;
  /// Where `towards` begins.
  static constexpr std::size_t kTowards = 9;
};

/// "through the trocar at 0 0 0.1 m, tilted by at most 60 degrees".
[[nodiscard]] std::string description(const Trocar& trocar);

[[nodiscard]] PoseMapPtr trocar_pose(const Trocar& trocar);

}  // namespace palpate
