// SPDX-License-Identifier: BSD-3-Clause
// The coarser spaces that a space contains: they show what more configurations are worth.
#pragma once

#include <vector>

#include "state_space/touch_space.h"

namespace palpate {

/// The factors by which a tool space can be coarsened, ascending, 1 the first. On a uniform grid
/// these are the factors that keep rest and the border as check-points; where cells have several
/// sizes, the powers of two up to the coarsest.
[[nodiscard]] std::vector<std::int32_t> coarsening_factors(const Grid& grid);

/// The tool space with the configurations at every factor-th check-point alone, without levels and
/// intermediate states. Where cells have several sizes, none is smaller than the factor then.
/// @param factor One of coarsening_factors(); 1 is the tool space itself.
[[nodiscard]] TouchToolSpace coarsened(const TouchToolSpace& tool_space, std::int32_t factor);

}  // namespace palpate
