// SPDX-License-Identifier: BSD-3-Clause
// How the tool attaches to the body and lets go of it.
#pragma once

namespace palpate {

struct TouchSettings {
  /// The displacement moves the three nodes of the triangle that was touched, by weights that stay
  /// as they are while attached; where one of them is not active, and without this, the nearest
  /// active node alone.
  bool blended = true;
  /// Bonded: the tool also pulls, and lets go only above release_force. Else it lets go as soon as
  /// it would pull, and slips where it has gone aside beyond what the space holds: it goes on from
  /// where it then is.
  bool bonded = false;
  /// A bonded tool lets go where the body pulls with more than this, N; 0: never. The usual value
  /// is below what the devices that we know give at most (5 N and more): the pull ends before the
  /// force limit cuts it, and no hand is held against the largest force of a motor.
  double release_force = 3;
  /// Active nodes are attached to up to this distance from where the tool comes in, m; 0: the
  /// longest side of the triangle there, or the radius of the tip if that is more.
  double reach = 0;
  /// Stiffness of the virtual coupling between tool and body, N/m in the scene; 0: none.
  double coupling_stiffness = 0;
};

/// @throws InputError a value is out of range.
void validate(const TouchSettings& settings);

}  // namespace palpate
