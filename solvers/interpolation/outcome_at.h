// SPDX-License-Identifier: BSD-3-Clause
// How the solves ended that an answer of a space comes from.
#pragma once

#include <vector>

#include "interpolation/check_point_grid.h"

namespace palpate {

/// @param grid Of the usable configurations of a tool space.
/// @param configurations All of it in their order, also those on other branches than the grid's.
/// @param t The coordinates of the tool [3], m.
/// @return Outcome::converged where the tool is free, and where no corner of the cell that t is in
///   or beside has failed; a corner that was not solved for has not. Else the outcome of the
///   nearest one that has. Where nothing is found it is that of the nearest configuration of all,
///   and not_converged where there is none.
[[nodiscard]] Outcome outcome_at(const CheckPointGrid& grid,
                                 const std::vector<ConfigurationSummary>& configurations,
                                 const Vec3& t);

}  // namespace palpate
