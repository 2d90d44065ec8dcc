// SPDX-License-Identifier: BSD-3-Clause
// Figures that tell how far the interpolated force of a tool space is from that of a passive body.
//
// Energy Hermite gives the gradient of one continuous energy, so that a closed loop does no work
// within a branch. Two errors are left. A leaf in which contact begins may attract the tool before
// it touches the body. And where leaves lie across branches, the energy jumps from one
// configuration to the next: a loop that returns on another branch may gain as much.
#pragma once

#include "state_space/touch_space.h"

namespace palpate {

struct PassivityFigures {
  /// The largest |force| of a usable configuration within the force limit, N.
  double largest_force = 0;
  /// The largest interpolated |force|, N, at those of 9³ places of each leaf where the tool touches
  /// nothing.
  double attraction = 0;
  /// The largest jump of the energy along an edge that lies across branches (branch_test.h), J.
  double energy_jump = 0;
};

/// The figures of Energy Hermite.
/// @throws InputError as make_interpolator().
[[nodiscard]] PassivityFigures passivity_figures(const TouchToolSpace& tool_space);

}  // namespace palpate
