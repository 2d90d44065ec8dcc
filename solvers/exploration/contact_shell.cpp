// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/contact_shell.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <tuple>

#include "base/error.h"
#include "base/quantity.h"
#include "interpolation/error_estimate.h"

namespace palpate {
namespace {

/// The coarsest cells are halved at most this often.
constexpr int kMostHalvings = 3;

/// A start is shallower than its target by at least this share of the spacing.
constexpr double kShallower = 0.2;

/// The distance of a check-point from where the exploration begins, m. It is measured between
/// places on the surface, so that all check-points on one normal have the same distance, also those
/// where the tool touches nothing.
/// Each turn adds more than any such distance.
double distance(const ToolClearance& clearance, const ToolClearance::Approach& approach,
                const ShellOptions& options) {
  const double distance = (approach.touched - options.begin_at).norm();
  if (options.turn == 0) return distance;
  const Eigen::AlignedBox3d box = clearance.body_bounds();
  const double largest = (box.center() - options.begin_at).norm() + box.diagonal().norm();
  return options.turn * largest + distance;
}

class Shell {
 public:
  Shell(const ToolClearance& clearance, const Grid& grid, const std::vector<char>& touchable,
        const ShellOptions& options)
      : clearance_(clearance),
        grid_(grid),
        touchable_(touchable),
        options_(options),
        roots_(grid.coarsest_resolution() - 1),
        side_(grid.coarsest * grid.spacing()) {
    std::int32_t all = 1;
    while (all < roots_) all *= 2;
    add_of({0, 0, 0}, all);
  }

  [[nodiscard]] std::vector<StartGraph::Target> targets() const {
    std::vector<StartGraph::Target> targets;
    for (const auto& [p, node] : nodes_) {
      if (!node.is_corner) continue;
      targets.push_back(
          {p, starts(p, node), node.is_free, distance(clearance_, node.approach, options_)});
    }
    return targets;
  }

 private:
  struct Node {
    ToolClearance::Approach approach;
    bool is_free = false;
    bool is_corner = false;
  };

  /// Adds the cells of the shell that lie in a cube of cells.
  /// @param first The numbers of the cube's first cell along the axes.
  /// @param count Cells along a side of the cube, a power of two; some may lie beyond the grid.
  void add_of(const CheckPoint& first, std::int32_t count) {
    if (*std::max_element(first.begin(), first.end()) >= roots_) return;
    const std::int32_t reach = grid_.reach();
    Cell cell{{}, grid_.coarsest};
    for (int k = 0; k < 3; ++k) cell.first[k] = first[k] * grid_.coarsest - reach;
    const double side = count * side_;
    const double half_diagonal = 0.5 * std::sqrt(3.0) * side;
    const Vec3 centre = grid_.place(cell.first) + Vec3::Constant(0.5 * side);
    if (options_.may_hold && !options_.may_hold(centre, 0.5 * side)) return;
    if (clearance_.clearance(centre) > half_diagonal) return;
    // The depth changes by no more than the distance.
    if (is_too_deep(clearance_.approach(centre).depth - half_diagonal)) return;
    if (count == 1) {
      if (holds(cell)) add(cell);
      return;
    }
    const std::int32_t half = count / 2;
    for (int part = 0; part < 8; ++part) {
      add_of({first[0] + (part >> 2 & 1) * half, first[1] + (part >> 1 & 1) * half,
              first[2] + (part & 1) * half},
             half);
    }
  }

  [[nodiscard]] bool is_too_deep(double depth) const {
    return options_.depth > 0 && depth > options_.depth;
  }

  [[nodiscard]] Node& node(const CheckPoint& p) {
    const auto [here, is_new] = nodes_.try_emplace(p);
    if (is_new) {
      here->second.approach = clearance_.approach(grid_.place(p));
      here->second.is_free = clearance_.clearance(grid_.place(p)) > 0;
    }
    return here->second;
  }

  [[nodiscard]] bool is_asked_for(const ToolClearance::Approach& approach) const {
    const auto& around = approach.around;
    return std::all_of(around.begin(), around.end(), [&](Index p) { return touchable_[p] != 0; }) &&
           (!options_.region || options_.region(approach.touched));
  }

  /// Whether a cell belongs to the shell: at one of its corners the tool is not too deep, and at
  /// one it presses where it is asked for.
  [[nodiscard]] bool holds(const Cell& cell) {
    bool is_shallow = false;
    bool is_asked = false;
    for (int corner = 0; corner < 8; ++corner) {
      const ToolClearance::Approach& approach = node(corner_of(cell, corner)).approach;
      is_shallow = is_shallow || !is_too_deep(approach.depth);
      is_asked = is_asked || is_asked_for(approach);
    }
    return is_shallow && is_asked;
  }

  void add(const Cell& cell) {
    for (int corner = 0; corner < 8; ++corner) node(corner_of(cell, corner)).is_corner = true;
  }

  /// Starts from which a check-point may be reached, the best first. The check-point itself among
  /// them means that it is reached without a start, from where the tool touches nothing.
  [[nodiscard]] std::vector<CheckPoint> starts(const CheckPoint& p, const Node& node) const {
    if (node.is_free) return {p};
    struct Start {
      /// The square of the tangent of the angle between the normal and the line to the start.
      double aside;
      CheckPoint check_point;
      bool operator<(const Start& other) const {
        return std::tie(aside, check_point) < std::tie(other.aside, other.check_point);
      }
    };
    std::vector<Start> starts;
    for (int n = 0; n < num_neighbours; ++n) {
      const CheckPoint step = neighbour({}, n);
      CheckPoint q = p;
      for (int k = 0; k < 3; ++k) q[k] += grid_.coarsest * step[k];
      const auto there = nodes_.find(q);
      if (there == nodes_.end() || !there->second.is_corner) continue;
      if (there->second.approach.depth > node.approach.depth - kShallower * side_) continue;
      const Vec3 way(step[0], step[1], step[2]);
      const double along = way.dot(node.approach.out);
      if (!(along > 0)) continue;
      starts.push_back({way.squaredNorm() / (along * along) - 1, there->second.is_free ? p : q});
    }
    std::sort(starts.begin(), starts.end());
    std::vector<CheckPoint> best;
    for (const Start& start : starts) {
      const bool is_new = std::find(best.begin(), best.end(), start.check_point) == best.end();
      if (is_new && best.size() < kMostStarts) best.push_back(start.check_point);
    }
    return best;
  }

  const ToolClearance& clearance_;
  const Grid& grid_;
  const std::vector<char>& touchable_;
  const ShellOptions& options_;
  std::int32_t roots_;
  double side_;
  std::map<CheckPoint, Node> nodes_;
};

}  // namespace

Grid make_shell_grid(const ToolClearance& clearance, double spacing) {
  const Eigen::AlignedBox3d box = clearance.bounds();
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

std::vector<StartGraph::Target> shell_targets(const ToolClearance& clearance, const Grid& grid,
                                              const std::vector<char>& touchable,
                                              const ShellOptions& options) {
  return Shell(clearance, grid, touchable, options).targets();
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
    added.distance = distance(clearance, clearance.approach(place), options);
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
