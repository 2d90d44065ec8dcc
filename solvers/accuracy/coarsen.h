// SPDX-License-Identifier: BSD-3-Clause
// The coarser spaces that a space contains. They show what further configurations gain.
#pragma once

#include <vector>

#include "state_space/touch_space.h"

namespace palpate {

/// The side of the smallest cells of a rigid tool's space, in steps of the grid; 1 for an active
/// node.
[[nodiscard]] std::int32_t smallest_side(const TouchToolSpace& tool_space);

/// The factors by which a tool space can be coarsened, ascending, 1 first. On a uniform grid they
/// keep rest and the border as check-points; if cells have several sizes, they are the powers of
/// two up to the coarsest size.
/// @param smallest Factors up to this, except 1, are left out, since they would change nothing.
[[nodiscard]] std::vector<std::int32_t> coarsening_factors(const Grid& grid,
                                                           std::int32_t smallest = 1);

/// The tool space with only the configurations at every factor-th check-point, without levels and
/// intermediate states. If cells have several sizes, none is smaller than the factor afterwards.
/// For a rigid tool the grid is unchanged, and the remaining configurations keep their
/// check-points, by which their fields are found in the file.
/// @param factor One of coarsening_factors(); 1 gives the tool space itself.
[[nodiscard]] TouchToolSpace coarsened(const TouchToolSpace& tool_space, std::int32_t factor);

}  // namespace palpate
