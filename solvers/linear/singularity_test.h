// SPDX-License-Identifier: BSD-3-Clause
// Whether a factor knows the lowest mode of its matrix, or has only rounding there.
//
// The least pivot cannot tell a body that floats, whose rigid motions have pivots of rounding, from
// a stiff inclusion in soft tissue. The former has pivots of 1e-16 to 1e-7 of the greatest (a mode
// that hardly moves the unknown that is eliminated last has a large one), the latter of the
// contrast times a share of the size: 1e-12 to 1e-9 for a contrast of 1e9. What tells them apart is
// whether the stiffness of that mode is known. So solve for a random column, in whose solution y
// the lowest mode outgrows all others, and ask two things.
//
//   Of the matrix: how large is the stiffness yᵀKy beside the rounding of the sums that it is made
//   of, ε |y|ᵀ|K||y|, and Ky beside ε |K||y|? (A constant pressure that nothing determines, in a
//   body whose whole surface is held, shows in the latter alone.)
//   Of the factor: how much of y does one step of refinement change? It removes the error that the
//   rounding of the factor has put into y.
//
// On 290 bodies (contrasts to 1e9, slivers, plates, ν to 0.49999999; floating, held at a point, at
// two) every one with a rigid motion left has 0.5 and more in one of the two, all others have 0.05
// and less in both, but for plates and bars whose bending has really no digit in double precision.
#pragma once

#include <vector>

#include "linear/linear_solver.h"

namespace palpate {

/// The relative error of the stiffness of the lowest mode, roughly: near 1 and more when it has no
/// digit. One solve; a second one when that leaves a doubt. @param solve With the factor of
/// `values`.
[[nodiscard]] double lowest_mode_error(const SymmetricPattern& pattern,
                                       const std::vector<double>& values,
                                       const SolveColumns& solve);

}  // namespace palpate
