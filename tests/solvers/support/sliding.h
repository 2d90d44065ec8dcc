// SPDX-License-Identifier: BSD-3-Clause
// A rigid sphere that slides over a flat block of soft tissue, pressed into it. On a half-space it
// would feel the same normal force everywhere, and none along the surface: what differs is the
// mesh, and a little of it the sides of the block.
#pragma once

#include "base/types.h"

namespace palpate::test {

struct SlidingOptions {
  /// The mean edge of the surface under the tool, m.
  double edge = 0.01;
  /// How often the tool moves on, by kSlidingStep.
  int steps = 12;
  /// Of the irregular mesh.
  int seed = 1;
  /// Of the layer of contact, m; 0: the one that is calibrated.
  double thickness = 0;
};

inline constexpr double kSlidingStep = 2e-4;

/// The largest of all places or steps.
struct SlidingResult {
  /// The force along the surface over that along its normal.
  double lateral = 0;
  /// The change of the stiffness k in a step over k.
  double stiffness_jump = 0;
  /// How far the force at a place is from the middle of those before and after it, over the force.
  double roughness = 0;
  Index num_unknowns = 0;
};

/// @throws InputError a solve did not converge.
[[nodiscard]] SlidingResult slide(const SlidingOptions& options);

}  // namespace palpate::test
