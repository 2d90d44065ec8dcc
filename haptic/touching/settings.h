// SPDX-License-Identifier: BSD-3-Clause
// How the tool attaches to the body and lets go of it.
#pragma once

namespace palpate {

struct TouchSettings {
  /// The tool moves the three nodes of the triangle that was touched, by weights that stay as they
  /// are while it is attached. Where one of these nodes is not active, and without this setting, it
  /// moves the nearest active node alone.
  bool blended = true;
  /// A bonded tool also pulls, and lets go only above release_force. Another tool lets go as soon
  /// as it would pull. Where such a tool has gone aside beyond the tool space it slips: it goes on
  /// from where it then is.
  bool bonded = false;
  /// A bonded tool lets go where the body pulls with more than this, N; 0: never. The usual value
  /// is below what the devices that we know give at most (5 N and more): the pull ends before the
  /// force limit cuts it, and no hand is held against the largest force of a motor.
  double release_force = 3;
  /// The tool is attached to an active node no farther than this from where it comes in, m; 0: the
  /// longest side of the triangle there, or the radius of the tip if that is more.
  double reach = 0;
  /// Stiffness of the virtual coupling between tool and body, N/m in the scene; 0: none.
  double coupling_stiffness = 0;
  /// The space grows while it is touched: where a rigid tool has come from outside to a place that
  /// is not known yet, there is a force as soon as it is known, which comes in within a fifth of a
  /// second. Otherwise such a tool has to go outside first.
  bool grows = false;
  /// The energy that it takes to open an area of a cut whose stages the space has, J/m²; 0: the cut
  /// stays as it is.
  double fracture_toughness = 0;
  /// A bonded tool is a blade (blade.h). What it held when it became one stays held where it is, as
  /// by another hand, until the tool is no blade any more.
  bool is_blade = false;
  /// The energy that it takes the blade to cut an area, J/m²; 0: as much as it takes to tear it.
  double blade_toughness = 0;
  /// The stiffness of the tissue before the edge of the blade, N/m. A coupling that is softer
  /// stands in its place.
  double blade_stiffness = 500;
  /// The force that it takes to draw the blade through what is cut, N.
  double blade_friction = 0;
  /// Coefficient of Coulomb friction between a rigid tool and the body; 0: it glides freely.
  double friction = 0;
};

/// @throws InputError a value is out of range.
void validate(const TouchSettings& settings);

}  // namespace palpate
