// SPDX-License-Identifier: BSD-3-Clause
// A rigid flat disc that is bonded to an elastic half-space and does not turn (half_space.h): a
// patch of the surface that moves as one, of half a cylinder on one side of the plane in which it
// moves.
//
// Its border is a polygon. The radius is counted as that of the circle of the same area, which a
// polygon near to a circle has the stiffness of. The stress grows without bound towards the
// border, so that the mesh's share of the error is of first order in the length of an edge.
#pragma once

#include "base/types.h"

namespace palpate::test {

struct BondedDiscOptions {
  double poissons_ratio = 0.4;
  /// The number of edges of the mesh along a.
  int edges = 2;
  /// Height and radius of the body over a.
  double extent = 64;
  /// The number of sectors around the axis, even.
  int sectors = 16;
};

/// Ratios are to what the half-space has.
struct BondedDiscResult {
  double along = 0;
  double into = 0;
  Index num_unknowns = 0;
};

[[nodiscard]] BondedDiscResult move_bonded_disc(const BondedDiscOptions& options);

/// What edges of no length would have, from a mesh and one with edges half as long: the error of
/// first order is left out.
[[nodiscard]] BondedDiscResult extrapolate(const BondedDiscResult& coarse,
                                           const BondedDiscResult& fine);

}  // namespace palpate::test
