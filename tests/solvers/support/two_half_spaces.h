// SPDX-License-Identifier: BSD-3-Clause
// Two elastic bodies with round surfaces that press each other without friction in a circle of
// radius a (Hertz; Johnson, Contact Mechanics, 1985, §4.2): with 1/E* = (1 − ν₁²)/E₁ + (1 − ν₂²)/E₂
// and 1/R = 1/R₁ + 1/R₂
//
//   F = 4/3 E* a³/R,   dF/dd = 2 E* a
//
// so that at a given force the stiffness is (6 E*² R F)^{1/3}. Each body is a quarter of a
// half-space (half_space.h) whose surface is bent to a paraboloid; materials are linear. a is a
// fifth of R or less.
#pragma once

#include "base/types.h"

namespace palpate::test {

struct TwoHalfSpacesOptions {
  /// The number of edges of the mesh along a, in the lower and the upper body.
  int lower_edges = 4;
  int upper_edges = 4;
  /// Height and radius of the bodies over a.
  double extent = 128;
  /// R of the pair, and its share that is the curvature of the upper body: 1 is a sphere on a flat
  /// block, ½ are two equal spheres.
  double radius = 0.05;
  double of_upper = 0.5;
  /// δ over an edge of the lower body; the default of filters is 0.2. κ over the modulus of the
  /// softer body.
  double thickness = 0.2;
  double stiffness = 2;
  /// E of the upper body over that of the lower one.
  double stiffer = 1;
  double poissons_ratio = 0.4;
  /// The lower body does not deform, and is flat.
  bool is_lower_rigid = false;
  /// How far the upper body comes nearer after the layers have met, m.
  double approach = 0.003;
};

struct TwoHalfSpacesResult {
  /// Of the whole bodies, N and N/m.
  double force = 0;
  double stiffness = 0;
  /// (6 E*² R F)^{1/3}, N/m.
  double hertz_stiffness = 0;
  /// a by the force, m.
  double radius = 0;
  /// The part of the force that is told as the layer's, N.
  double layer_force = 0;
  Index num_unknowns = 0;
};

/// @throws InputError the solve did not converge.
[[nodiscard]] TwoHalfSpacesResult press_half_spaces(const TwoHalfSpacesOptions& options);

}  // namespace palpate::test
