// SPDX-License-Identifier: BSD-3-Clause
// What the interpolated force of a tool space does that the force of a body does not.
//
// Energy Hermite gives the gradient of one continuous energy, so that a closed loop does no work
// within a branch. Two things are left. A leaf in which contact begins may attract the tool before
// it touches the body. And where the leaves lie across branches of the solution, the energy that
// the configurations have jumps from one to the next: so much a way that comes back on another
// branch may gain.
#pragma once

#include "state_space/touch_space.h"

namespace palpate {

struct PassivityFigures {
  /// The largest |force| of a usable configuration within the force limit, N.
  double largest_force = 0;
  /// The largest interpolated |force| at 9³ places of each leaf at which the tool touches nothing,
  /// N.
  double attraction = 0;
  /// The largest jump of the energy along an edge that lies across branches (branch_test.h), J.
  double energy_jump = 0;
};

/// The figures of Energy Hermite.
/// @throws InputError as make_interpolator().
[[nodiscard]] PassivityFigures passivity_figures(const TouchToolSpace& tool_space);

}  // namespace palpate
