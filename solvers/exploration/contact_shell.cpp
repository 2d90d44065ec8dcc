// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/contact_shell.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <tuple>

#include "base/error.h"
#include "base/quantity.h"
#include "exploration/shell_cells.h"
#include "interpolation/error_estimate.h"

namespace palpate {
namespace {

/// The coarsest cells are halved at most this often.
constexpr int kMostHalvings = 3;

/// Calls visit(numbers) for the root cells of the shell that lie in a cube of root cells.
/// @param first The numbers of the cube's first cell. @param count Cells along a side of the cube,
///   a power of two; some may lie beyond the grid.
template <class Visit>
void for_each_cell(ShellCells& cells, const CheckPoint& first, std::int32_t count, Visit&& visit) {
  if (count == 1) {
    if (cells.holds(first)) visit(first);
    return;
  }
  if (!cells.may_hold(first, count)) return;
  const std::int32_t half = count / 2;
  for (int part = 0; part < 8; ++part) {
    for_each_cell(cells,
                  {first[0] + (part >> 2 & 1) * half, first[1] + (part >> 1 & 1) * half,
                   first[2] + (part & 1) * half},
                  half, visit);
  }
}

}  // namespace

Grid make_shell_grid(const Eigen::AlignedBox3d& box, double spacing) {
  const double size = box.sizes().maxCoeff();
  constexpr int kMostCells = kLargestCoarsestResolution - 1;
  // The number of cells is even, so that (0, 0, 0) is a corner. One cell is added, since the box
  // may lie anywhere in the outermost cells.
  const double wanted = 2 * (std::floor(size / (2 * spacing)) + 1);
  if (!(spacing > 0) || !(wanted <= kMostCells)) {
    throw InputError("Cells of " + quantity(spacing, "m") + " around a body and a tool of " +
                     quantity(size, "m") + " are more than " + std::to_string(kMostCells) +
                     " along an axis. Take a spacing of " + quantity(size / (kMostCells - 2), "m") +
                     " or more.");
  }
  Grid grid;
  grid.origin = box.center();
  grid.half_width = 0.5 * wanted * spacing;
  grid.resolution = static_cast<std::int32_t>(wanted) + 1;
  grid.sparse = true;
  for (int i = 0; i < kMostHalvings && 2 * grid.resolution - 1 <= kLargestResolution; ++i) {
    grid.resolution = 2 * grid.resolution - 1;
    grid.coarsest *= 2;
  }
  return grid;
}

std::set<CheckPoint> list_shell_cells(const ToolClearance& clearance, const Grid& grid,
                                      const std::vector<char>& touchable,
                                      const ShellOptions& options) {
  ShellCells cells(clearance, grid, touchable, options);
  std::int32_t all = 1;
  while (all < cells.num_roots()) all *= 2;
  std::set<CheckPoint> list;
  for_each_cell(cells, {0, 0, 0}, all, [&](const CheckPoint& numbers) { list.insert(numbers); });
  return list;
}

std::vector<StartGraph::Target> shell_targets(const ToolClearance& clearance, const Grid& grid,
                                              const std::vector<char>& touchable,
                                              const ShellOptions& options,
                                              const std::set<CheckPoint>& of_shell) {
  ShellCells cells(clearance, grid, touchable, options);
  std::set<CheckPoint> corners;
  for (const CheckPoint& numbers : of_shell) {
    for (int corner = 0; corner < 8; ++corner) {
      corners.insert(corner_of(cells.root(numbers), corner));
    }
  }
  const auto is_corner = [&](const CheckPoint& p) { return corners.count(p) > 0; };
  std::vector<StartGraph::Target> targets;
  for (const CheckPoint& p : corners) {
    targets.push_back({p, cells.starts(p, is_corner), cells.node(p).is_free, cells.distance(p)});
  }
  return targets;
}

std::vector<StartGraph::Target> refined_targets(
    const ToolClearance& clearance, const Grid& grid, const std::vector<Cell>& to_split,
    const std::map<CheckPoint, ConfigurationSummary>& known, const ShellOptions& options) {
  const auto is_known = [&](const CheckPoint& p) { return known.count(p) > 0; };
  std::vector<StartGraph::Target> targets;
  for (const auto& [target, corners] : corners_of_new_points(to_split, is_known)) {
    StartGraph::Target& added = targets.emplace_back();
    added.check_point = target;
    const Vec3 place = grid.place(target);
    added.distance = shell_distance(clearance, clearance.approach(place), options);
    if (clearance.clearance(place) > 0) {
      added.is_free = true;
      added.starts = {target};
      continue;
    }
    for (const CheckPoint& corner : corners) {
      const auto found = known.find(corner);
      if (found == known.end() || !found->second.leads_on()) continue;
      if ((found->second.flags & flags::touches_nothing) != 0) continue;
      added.starts.push_back(corner);
    }
    std::sort(
        added.starts.begin(), added.starts.end(), [&p = target](const auto& a, const auto& b) {
          return std::tuple(squared_distance(a, p), a) < std::tuple(squared_distance(b, p), b);
        });
    if (added.starts.size() > kMostStarts) added.starts.resize(kMostStarts);
  }
  return targets;
}

}  // namespace palpate
