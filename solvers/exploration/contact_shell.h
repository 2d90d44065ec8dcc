// SPDX-License-Identifier: BSD-3-Clause
// The check-points of a rigid tool that presses a body anywhere: the corners of the cells of a
// Cartesian grid in which the tool may touch, and is no deeper than asked for.
//
// Each is reached along the normal of the surface: from the neighbour farther out that lies nearest
// to that line, and where that touches nothing, from where the tool touches nothing itself. So the
// exploration begins at all places outside at once, and a chain of starts is no longer than the
// shell is deep.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <vector>

#include "exploration/start_graph.h"
#include "interaction/tool_clearance.h"
#include "interpolation/cell_tree.h"

namespace palpate {

/// Where a rigid tool is to press.
struct ShellOptions {
  /// How deep, measured at rest, m; 0: as deep as the force limit allows.
  double depth = 0;
  /// Whether a place of the surface at rest is to be pressed; empty: all that is touchable.
  std::function<bool(const Vec3&)> region;
  /// Where the exploration begins, m: it grows from there over the surface, so that the place can
  /// be touched long before all is found.
  Vec3 begin_at = Vec3::Zero();
};

/// The grid of a rigid tool around a body, with coarsest cells of a side, and such that they may be
/// halved as often as the numbers of check-points allow, thrice at the most.
/// @param spacing Of the coarsest cells, m.
/// @throws InputError there would be too many of them.
[[nodiscard]] Grid make_shell_grid(const ToolClearance& clearance, double spacing);

/// The corners of the coarsest cells of the shell.
/// @param touchable Of each point of the mesh 1: it may be touched.
/// @throws InputError there is no such cell.
[[nodiscard]] std::vector<StartGraph::Target> shell_targets(const ToolClearance& clearance,
                                                            const Grid& grid,
                                                            const std::vector<char>& touchable,
                                                            const ShellOptions& options);

/// The targets of a further round: the points of the halves of cells that are to be split.
/// They are reached from the corners of those, the nearest first.
/// @param known What is known of all check-points so far, by check-point.
/// @param begin_at See ShellOptions.
[[nodiscard]] std::vector<StartGraph::Target> refined_targets(
    const ToolClearance& clearance, const Grid& grid, const std::vector<Cell>& to_split,
    const std::map<CheckPoint, ConfigurationSummary>& known, const Vec3& begin_at);

}  // namespace palpate
