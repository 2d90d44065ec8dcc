// SPDX-License-Identifier: BSD-3-Clause
// What the tool touches, and what it feels there.
#pragma once

#include <array>
#include <cstdint>

#include "interpolation/interpolator.h"

namespace palpate {

/// Numbers are stored in recordings: keep them.
enum class ContactStatus : int {
  /// There is no body.
  nothing = 0,
  /// Outside the body.
  free = 1,
  /// Inside the body at rest without touching it: the tool began there, was let go there, or came
  /// in where no active node is near.
  inside = 2,
  /// Attached to the surface.
  attached = 3,
};

struct Contact {
  ContactStatus status = ContactStatus::nothing;
  /// Distance to the surface at rest while not attached, m, negative inside.
  double distance = 0;
  /// The active nodes that are moved and their weights, which sum to 1; −1: none.
  std::array<std::int32_t, 3> nodes{-1, -1, -1};
  std::array<double, 3> weights{};
  /// The branch that the body is on at each of them.
  std::array<std::int32_t, 3> branches{};
  /// Point of the surface at rest that the tool is attached to; while free, the nearest one [3], m.
  Vec3 anchor = Vec3::Zero();
  /// Displacement of the active nodes [3], m.
  Vec3 displacement = Vec3::Zero();
  /// On the tool [3], N: the opposite of what holds the nodes.
  Vec3 force = Vec3::Zero();
  /// −∂force/∂(tool) [3×3], N/m.
  Mat3 stiffness = Mat3::Zero();
  /// That body and coupling store, J.
  double energy = 0;
  /// The least certain of the nodes'.
  Support support = Support::none;
};

}  // namespace palpate
