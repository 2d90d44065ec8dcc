// SPDX-License-Identifier: BSD-3-Clause
// What the tool touches, and the force there.
#pragma once

#include <array>
#include <cstdint>

#include "interpolation/interpolator.h"
#include "state_space/tool_space_key.h"

namespace palpate {

/// How the tool touches the body. The numbers are stored in recordings: keep them.
enum class ContactStatus : int {
  /// There is no body.
  nothing = 0,
  /// The tool is outside the body.
  free = 1,
  /// The tool is inside the body at rest without touching it: it began there, has let go there, or
  /// came in where no active node is near.
  inside = 2,
  /// The tool is attached to the surface.
  attached = 3,
  /// A rigid tool presses the body, and glides on it: nothing is attached.
  pressing = 4,
  /// A blade is in the cut.
  cutting = 5,
};

/// Whether there is a force between tool and body.
[[nodiscard]] constexpr bool touches(ContactStatus status) noexcept {
  return status == ContactStatus::attached || status == ContactStatus::pressing ||
         status == ContactStatus::cutting;
}

struct Contact {
  ContactStatus status = ContactStatus::nothing;
  /// Distance from the tool's place to the surface at rest while the tool touches nothing, m;
  /// negative inside.
  double distance = 0;
  /// The active nodes that are moved, −1: none, and their weights, which add up to 1.
  std::array<std::int32_t, 3> nodes{-1, -1, -1};
  /// The bodies of the state space on which these nodes are.
  std::array<BodyId, 3> bodies{kFirstBody, kFirstBody, kFirstBody};
  std::array<double, 3> weights{};
  /// The branch that the body is on at each of them.
  std::array<std::int32_t, 3> branches{};
  /// The point of the surface at rest to which the tool is attached, or which is nearest to it
  /// while it is free. For a rigid tool that presses: the tool's centre, which differs from the
  /// hand's place by the stretch of a coupling. For a blade: where it is in the cut. For a reduced
  /// body: the place of its tool at rest [3], m.
  Vec3 anchor = Vec3::Zero();
  /// Displacement of the active nodes, or of the tool of a reduced body [3], m.
  Vec3 displacement = Vec3::Zero();
  /// Force on the tool [3], N: the opposite of the force that holds the nodes or the tool.
  Vec3 force = Vec3::Zero();
  /// −∂force/∂(tool) [3×3], N/m.
  Mat3 stiffness = Mat3::Zero();
  /// Energy that body, coupling and sticking friction store, J: with a blade, also that of the
  /// tissue before its edge. coupled_tool.h says what it is for
  /// a reduced body.
  double energy = 0;
  /// The least certain support among the nodes, or the support at a rigid tool's place.
  Support support = Support::none;
  /// The area of the cut that is open, m².
  double torn_area = 0;
  /// Since the body was whole: what tearing and cutting have taken, what the friction of a blade
  /// has taken, and what the hand has done to a body with a cut, by the forces before and after
  /// each tick, J. The hand's work less `energy` and these is what unstable tears have lost, and
  /// what was stored when the hand let go; it is not below 0.
  double torn_work = 0;
  double friction_work = 0;
  double hand_work = 0;
  /// What the mesh does to the force that holds the nodes or the tool.
  TouchMeshError mesh_error;
  /// ReducedState::trust of a reduced body: do not trust the force above 2. 0 for other bodies.
  double trust = 0;

  /// Where the tool is while it touches [3], m.
  [[nodiscard]] Vec3 tool_place() const noexcept {
    return status == ContactStatus::cutting ? anchor : Vec3(anchor + displacement);
  }
};

}  // namespace palpate
