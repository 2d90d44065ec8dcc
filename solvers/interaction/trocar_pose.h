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

  /// In the order of the members.
  [[nodiscard]] std::vector<double> numbers() const;
  /// @throws InputError these are not twelve finite numbers, or a direction is not of unit length.
  [[nodiscard]] static Trocar from(const std::vector<double>& numbers);
};

[[nodiscard]] PoseMapPtr trocar_pose(const Trocar& trocar);

}  // namespace palpate
