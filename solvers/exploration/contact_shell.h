// SPDX-License-Identifier: BSD-3-Clause
// The check-points of a rigid tool that presses a body anywhere, the shell: corners of those cells
// of a Cartesian grid in which the tool may touch the body, and is no deeper than asked for.
//
// A check-point is reached along the normal of the surface: from the neighbour farther out that
// lies nearest to this normal, or, if the tool touches nothing at that neighbour, from no start at
// all. So the exploration can begin at all places around the body at once, and a chain of starts is
// no longer than the shell is deep.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <vector>

#include "exploration/start_graph.h"
#include "interaction/tool_clearance.h"
#include "interpolation/cell_tree.h"

namespace palpate {

/// Where a rigid tool is to press.
struct ShellOptions {
  /// The largest depth of the tool, measured at the body's rest, m; 0: the force limit alone bounds
  /// it.
  double depth = 0;
  /// Whether a place of the surface at rest is to be pressed. Empty: every touchable place is.
  std::function<bool(const Vec3&)> region;
  /// Where the exploration begins, m. It spreads from there over the surface, so that this place
  /// can be touched long before the space is complete.
  Vec3 begin_at = Vec3::Zero();
  /// Of an organ of several regions: whether a tool in a cube around a place, with half a side in
  /// m, may be in this one. Empty: it may be anywhere.
  std::function<bool(const Vec3& place, double half)> may_hold;
  /// The turn of this region. The check-points of a region are explored before those of the next
  /// one, so that a rank solves for one body after the other.
  int turn = 0;
};

/// The grid around a body that a rigid tool presses. Its coarsest cells may be halved as often as
/// the numbers of check-points allow, three times at most.
/// @param bounds The places where the tool may touch the body, m, see ToolClearance::bounds().
/// @param spacing Side of the coarsest cells, m.
/// @throws InputError there would be too many of them.
[[nodiscard]] Grid make_shell_grid(const Eigen::AlignedBox3d& bounds, double spacing);

/// The coarsest cells of the shell, by their numbers along the axes, from 0.
/// @param touchable One entry for each point of the mesh; other than 0: the point may be touched.
[[nodiscard]] std::set<CheckPoint> list_shell_cells(const ToolClearance& clearance,
                                                    const Grid& grid,
                                                    const std::vector<char>& touchable,
                                                    const ShellOptions& options);

/// The corners of coarsest cells.
/// @param cells Those of the shell, or more.
[[nodiscard]] std::vector<StartGraph::Target> shell_targets(const ToolClearance& clearance,
                                                            const Grid& grid,
                                                            const std::vector<char>& touchable,
                                                            const ShellOptions& options,
                                                            const std::set<CheckPoint>& cells);

/// The targets of a further round: the points of the halves of the cells that are to be split. They
/// are reached from the corners of these cells, the nearest first.
/// @param known All configurations so far, by check-point.
[[nodiscard]] std::vector<StartGraph::Target> refined_targets(
    const ToolClearance& clearance, const Grid& grid, const std::vector<Cell>& to_split,
    const std::map<CheckPoint, ConfigurationSummary>& known, const ShellOptions& options);

}  // namespace palpate
