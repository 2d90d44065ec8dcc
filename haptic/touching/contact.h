// SPDX-License-Identifier: BSD-3-Clause
// What the tool touches, and what it feels there.
#pragma once

#include <array>
#include <cstdint>

#include "interpolation/interpolator.h"

namespace palpate {

/// How the tool and the body are to each other. The numbers are stored in recordings: keep them.
enum class ContactStatus : int {
  /// There is no body.
  nothing = 0,
  /// The tool is outside the body.
  free = 1,
  /// The tool is inside the body at rest and does not touch it: it began there, has let go there,
  /// or came in where no active node is near.
  inside = 2,
  /// The tool is attached to the surface.
  attached = 3,
  /// A rigid tool presses the body, and glides on it: nothing is attached.
  pressing = 4,
};

/// There is a force between tool and body.
[[nodiscard]] constexpr bool touches(ContactStatus status) noexcept {
  return status == ContactStatus::attached || status == ContactStatus::pressing;
}

struct Contact {
  ContactStatus status = ContactStatus::nothing;
  /// Distance of the tool's place to the surface at rest while it touches nothing, m; negative
  /// inside.
  double distance = 0;
  /// The active nodes that are moved, −1: none, and their weights, which add up to 1.
  std::array<std::int32_t, 3> nodes{-1, -1, -1};
  std::array<double, 3> weights{};
  /// The branch that the body is on at each of them.
  std::array<std::int32_t, 3> branches{};
  /// The point of the surface at rest that the tool is attached to; while it is free, the nearest
  /// point; while a rigid tool presses, where its centre is, from which the hand may be away by
  /// what a coupling gives way; of a reduced body the place of its tool at rest [3], m.
  Vec3 anchor = Vec3::Zero();
  /// Displacement of the active nodes, or of the tool of a reduced body [3], m.
  Vec3 displacement = Vec3::Zero();
  /// Force on the tool [3], N: the opposite of that which holds the nodes, or the tool.
  Vec3 force = Vec3::Zero();
  /// −∂force/∂(tool) [3×3], N/m.
  Mat3 stiffness = Mat3::Zero();
  /// Energy that body, coupling and sticking friction store, J; of a reduced body see
  /// coupled_tool.h.
  double energy = 0;
  /// The least certain support of the nodes, or that of the tool's place.
  Support support = Support::none;
  /// Of a reduced body, see ReducedState::trust: above 2 do not trust the force. 0: it is none.
  double trust = 0;
};

}  // namespace palpate
