// SPDX-License-Identifier: BSD-3-Clause
// A rigid sphere of radius R that is pressed by d into an elastic half-space without friction
// (Hertz; Johnson, Contact Mechanics, 1985, §4.2): with E* = E/(1 − ν²)
//
//   a = √(R d),   F = 4/3 E* √R d^{3/2},   dF/dd = 2 E* a,   p(r) = p₀ √(1 − r²/a²),
//   p₀ = 2 E* a/(π R)
//
// where a ≪ R: here d = R/10000. It is solved on a sector of a cylinder (half_space.h), one cell
// wide, between two planes of symmetry: the mirror images of the sector around the axis make the
// whole body.
//
// What presses is a layer of thickness δ (rigid_contact.h), in which a pressure p is at the gap
// g(p) = δ (1 − (p/κ)^{1/3}): the tool seems larger. By the principle of complementary energy a
// layer that is thin beside d adds ∫∫ g dp dA, over Hertz's pressure, to the energy of the
// half-space, and so the force is that of a sphere that is larger by
//
//   c = δ (1 − ¾ (p₀/κ)^{1/3}),
//
// the mean of the gap, but for terms in (δ/d)². The depth d is counted with it. For κ = 2 E and
// d = R/10000 it is 0.88 δ; it is δ/2 where κ = 3.4 p₀.
#pragma once

#include "base/types.h"

namespace palpate::test {

/// Of the closed form.
struct HertzContact {
  /// F, N.
  double force = 0;
  /// dF/dd, N/m.
  double stiffness = 0;
};
[[nodiscard]] HertzContact hertz_contact(double poissons_ratio);

struct HertzOptions {
  /// The number of edges of the mesh along a, under the tool.
  int edges = 3;
  /// δ/d.
  double thickness = 0.04;
  /// Height and radius of the body over a. It is fixed at its bottom and its side, and too stiff by
  /// 1.2 a/extent for that.
  double extent = 256;
  /// The number of sectors around the axis.
  int sectors = 16;
  /// The number of parts of an edge for the integration of contact.
  int divisions = 4;
  double poissons_ratio = 0.4;
};

/// Ratios are to what the half-space has.
struct HertzResult {
  double force = 0;
  /// The same with a depth that is counted from the middle of the layer, c = δ/2.
  double force_from_middle = 0;
  double stiffness = 0;
  /// a, by the second moment of the pressure, ∫ p r² dA = 2/5 a² F.
  double radius = 0;
  /// The root of the mean square error of the pressure at points of the mesh within 0.8 a, over p₀.
  double pressure_error = 0;
  /// The force on points below the surface, N: 0 unless a point of integration of a plane of
  /// symmetry lies in the layer.
  double force_below = 0;
  Index num_unknowns = 0;
};

/// @throws InputError the solve did not converge.
[[nodiscard]] HertzResult press_half_space(const HertzOptions& options);

}  // namespace palpate::test
