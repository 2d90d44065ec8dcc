// SPDX-License-Identifier: BSD-3-Clause
// The coarser spaces that a space contains: they show what more configurations are worth.
#pragma once

#include <vector>

#include "state_space/touch_space.h"

namespace palpate {

/// The side of the smallest cells that the configurations of a tool space of a rigid tool make, in
/// steps of the grid; of an active node 1.
[[nodiscard]] std::int32_t smallest_side(const TouchToolSpace& tool_space);

/// The factors by which a tool space can be coarsened, ascending, 1 the first. On a uniform grid
/// these are the factors that keep rest and the border as check-points; where cells have several
/// sizes, the powers of two up to the coarsest.
/// @param smallest The factors up to this, 1 apart, are left out: they change nothing.
[[nodiscard]] std::vector<std::int32_t> coarsening_factors(const Grid& grid,
                                                           std::int32_t smallest = 1);

/// The tool space with the configurations at every factor-th check-point alone, without levels and
/// intermediate states. Where cells have several sizes, none is smaller than the factor then. Of a
/// rigid tool the grid stays, and the configurations that are left have their check-points, by
/// which their fields are found in the file.
/// @param factor One of coarsening_factors(); 1 is the tool space itself.
[[nodiscard]] TouchToolSpace coarsened(const TouchToolSpace& tool_space, std::int32_t factor);

}  // namespace palpate
