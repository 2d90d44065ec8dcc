// SPDX-License-Identifier: BSD-3-Clause
// The root cells of a sparse grid that are absent (cell_tree.h): where the tool touches nothing
// there, and which of the root cells that are there is nearest.
//
// The clearance c at the centre of a cube of half diagonal r decides without looking further where
// |c| > r: it changes by no more than the way.
#pragma once

#include <cstdint>
#include <vector>

#include "interpolation/clearance.h"
#include "state_space/tool_space.h"

namespace palpate {

struct Cell;

/// The clearance proves that the tool touches nothing at any place of a cell; an empty one proves
/// nothing.
[[nodiscard]] bool is_proved_free(const Grid& grid, const Clearance& clearance, const Cell& cell);

/// An absent root cell is halved down to this share of its side to tell what is free of it.
inline constexpr std::int32_t kAbsentParts = 4;

/// Fills in the absent root cells, as CellTree keeps them.
/// @param present The numbers of the root cells that are there.
/// @param cells The root cells; those that are there stay as they are.
void fill_absent_cells(const Grid& grid, const Clearance& clearance,
                       const std::vector<std::int32_t>& present, std::vector<std::int32_t>& cells);

}  // namespace palpate
