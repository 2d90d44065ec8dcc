// SPDX-License-Identifier: BSD-3-Clause
// Sphere and capsule. A capsule of radius R is the set of places that are nearer than R to a
// segment of length L along the unit axis a, with its middle at the tool's centre. With s = a·y and
// ρ = y − s a the distance is
//
//   d(y) = √Q − R,   Q = |ρ|² + u(s)²,   u(s) = s − min(max(s, −L/2), L/2),
//
// where u is how far a place lies beyond the end of the segment. u has kinks, and so the Hessian of
// d jumps where the cylinder becomes a cap. Instead, the smooth capsule has the mean of the clamped
// coordinate over a width w,
//
//   u(s) = U(s − L/2) − U(−s − L/2),   U(x) = ∫ S dx,   S(x) = t³ (10 − 15 t + 6 t²),
//   t = x/w + 1/2 within 0 … 1,
//
// where U is a ramp that is C³, and exact for |x| ≥ w/2. So d is C³, is exact farther than w/2 from
// the seam, and is never below the distance. With L = 0, u(s) = s, which gives a sphere. The tool
// is thinner by up to 0.0045 w²/R around the seam. On the surface the error and the largest second
// and third derivative along one direction, which on a sphere are 1/R and 1.15/R², are
//
//   w / R     S cubic, d C²          S quintic, d C³        S septic, d C⁴
//   0.25      0.0004 R  1.16  12.5   0.0003 R  1.12  12.7   0.0002 R  1.11  14.6
//   0.5       0.0016 R  1.16   6.8   0.0011 R  1.12   6.4   0.0009 R  1.11   7.3
//   1         0.0064 R  1.14   4.1   0.0045 R  1.11   3.2   0.0034 R  1.10   3.7
//   2         0.0254 R  1.09   2.0   0.0178 R  1.08   1.7   0.0137 R  1.08   1.9
//
// In a core around the segment, √Q ≤ R/10, the root is continued by its Taylor polynomial of order
// three at the border of the core: d is C³ through the centre as well, where its gradient is zero.
#pragma once

#include "interaction/rigid_shape.h"

namespace palpate {

struct Capsule {
  /// The radius R, m.
  double radius = 0;
  /// The length L of the segment, m: the whole tool is longer by twice the radius. 0 makes a
  /// sphere.
  double length = 0;
  /// The direction of the segment, of any length but zero.
  Vec3 axis = Vec3::UnitZ();
  /// The width of the smooth seam between cylinder and cap, as a share of the radius.
  double seam = 1;
};

/// @throws InputError the radius is not positive, or not finite.
[[nodiscard]] RigidShapePtr make_sphere(double radius);

/// @throws InputError a length or the axis is out of its range, or not finite.
[[nodiscard]] RigidShapePtr make_capsule(const Capsule& capsule);

}  // namespace palpate
