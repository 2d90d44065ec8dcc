// SPDX-License-Identifier: BSD-3-Clause
// Finds, for the absent root cells of a sparse grid (cell_tree.h), in which parts of them the tool
// touches nothing, and which existing root cell is nearest.
//
// Let c be the clearance at the centre of a cube, and r half its diagonal. Since c changes by no
// more than the distance, |c| > r decides for the whole cube.
#pragma once

#include <cstdint>
#include <vector>

#include "interpolation/clearance.h"
#include "state_space/tool_space.h"

namespace palpate {

struct Cell;

/// Whether the clearance proves that the tool touches nothing anywhere in a cell. An empty
/// clearance proves nothing.
[[nodiscard]] bool is_proved_free(const Grid& grid, const Clearance& clearance, const Cell& cell);

/// An absent root cell is halved down to this share of its side, to find its free parts.
inline constexpr std::int32_t kAbsentParts = 4;

/// Fills in the absent root cells in the format of CellTree.
/// @param present The numbers of the root cells that exist.
/// @param cells The root cells; the existing ones stay as they are.
void fill_absent_cells(const Grid& grid, const Clearance& clearance,
                       const std::vector<std::int32_t>& present, std::vector<std::int32_t>& cells);

}  // namespace palpate
