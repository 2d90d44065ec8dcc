// SPDX-License-Identifier: BSD-3-Clause
// The coarser spaces that a space contains: what more configurations are worth is seen from one.
#pragma once

#include <vector>

#include "state_space/touch_space.h"

namespace palpate {

/// The factors by which a site can be coarsened, ascending, 1 the first: of a uniform grid those
/// that leave rest and the border check-points; of cells of several sizes the powers of two up to
/// the coarsest.
[[nodiscard]] std::vector<std::int32_t> coarsening_factors(const Site& site);

/// The configurations at every factor-th check-point, without levels and intermediate states; of
/// cells of several sizes none is smaller than the factor then.
/// @param factor One of coarsening_factors(); 1 is the site itself.
[[nodiscard]] TouchSite coarsened(const TouchSite& site, std::int32_t factor);

}  // namespace palpate
