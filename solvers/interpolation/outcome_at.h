// SPDX-License-Identifier: BSD-3-Clause
// The outcome of the solves on which an interpolated answer is based.
#pragma once

#include <vector>

#include "interpolation/check_point_grid.h"

namespace palpate {

/// The outcome at a displacement of the tool: Outcome::converged if the tool is free there, or if
/// no corner of the cell that t is in or beside has failed; a corner that was not solved for has
/// not failed. Otherwise it is the outcome of the nearest failed corner. If the support is `none`,
/// it is the outcome of the nearest of all configurations, and not_converged if there is none.
/// @param grid The grid of the usable configurations of a tool space.
/// @param configurations All configurations of the tool space in their order, also those on other
///   branches than the grid's.
/// @param t The coordinates of the tool [3], m.
[[nodiscard]] Outcome outcome_at(const CheckPointGrid& grid,
                                 const std::vector<ConfigurationSummary>& configurations,
                                 const Vec3& t);

}  // namespace palpate
