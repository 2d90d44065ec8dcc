// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/shell_cells.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace palpate {
namespace {

/// A start is shallower than its target by at least this share of the spacing.
constexpr double kShallower = 0.2;

}  // namespace

double shell_distance(const ToolClearance& clearance, const ToolClearance::Approach& approach,
                      const ShellOptions& options) {
  const double distance = (approach.touched - options.begin_at).norm();
  if (options.turn == 0) return distance;
  const Eigen::AlignedBox3d box = clearance.body_bounds();
  const double largest = (box.center() - options.begin_at).norm() + box.diagonal().norm();
  return options.turn * largest + distance;
}

ShellCells::ShellCells(const ToolClearance& clearance, const Grid& grid,
                       const std::vector<char>& touchable, const ShellOptions& options)
    : clearance_(clearance),
      grid_(grid),
      touchable_(touchable),
      options_(options),
      num_roots_(grid.coarsest_resolution() - 1),
      side_(grid.coarsest * grid.spacing()) {}

Cell ShellCells::root(const CheckPoint& numbers) const {
  Cell cell{{}, grid_.coarsest};
  for (int k = 0; k < 3; ++k) cell.first[k] = numbers[k] * grid_.coarsest - grid_.reach();
  return cell;
}

CheckPoint ShellCells::numbers_of(const Vec3& place) const {
  const Vec3 first = grid_.place(root({}).first);
  CheckPoint numbers{};
  for (int k = 0; k < 3; ++k) {
    // One beyond the grid stands for all of them.
    const double number = std::floor((place[k] - first[k]) / side_);
    numbers[k] =
        static_cast<std::int32_t>(std::clamp(number, -1.0, static_cast<double>(num_roots_)));
  }
  return numbers;
}

bool ShellCells::may_hold(const CheckPoint& first, std::int32_t count) const {
  if (*std::min_element(first.begin(), first.end()) < 0) return false;
  if (*std::max_element(first.begin(), first.end()) >= num_roots_) return false;
  const double side = count * side_;
  const double half_diagonal = 0.5 * std::sqrt(3.0) * side;
  const Vec3 centre = grid_.place(root(first).first) + Vec3::Constant(0.5 * side);
  if (options_.may_hold && !options_.may_hold(centre, 0.5 * side)) return false;
  if (!clearance_.allows(centre)) return count > 1;
  if (clearance_.clearance(centre) > half_diagonal) return false;
  // The depth changes by no more than the way of the tool's points.
  const double change = clearance_.farthest_way(centre, half_diagonal);
  return !is_too_deep(clearance_.approach(centre).depth - change);
}

bool ShellCells::holds(const CheckPoint& numbers) {
  const auto [here, is_new] = holds_.try_emplace(numbers, false);
  if (is_new) here->second = may_hold(numbers, 1) && has_corners(root(numbers));
  return here->second;
}

bool ShellCells::has_corners(const Cell& root) {
  bool is_shallow = false;
  bool is_asked = false;
  for (int corner = 0; corner < 8; ++corner) {
    if (!clearance_.allows(grid_.place(corner_of(root, corner)))) return false;
  }
  for (int corner = 0; corner < 8; ++corner) {
    const ToolClearance::Approach& approach = node(corner_of(root, corner)).approach;
    is_shallow = is_shallow || !is_too_deep(approach.depth);
    is_asked = is_asked || is_asked_for(approach);
  }
  return is_shallow && is_asked;
}

std::vector<CheckPoint> ShellCells::around(const CheckPoint& p) const {
  CheckPoint last{};
  for (int k = 0; k < 3; ++k) {
    const std::int32_t from_first = p[k] + grid_.reach();
    if (from_first % grid_.coarsest != 0) return {};
    last[k] = from_first / grid_.coarsest;
  }
  std::vector<CheckPoint> around;
  for (int octant = 0; octant < 8; ++octant) {
    around.push_back(
        {last[0] - (octant >> 2), last[1] - (octant >> 1 & 1), last[2] - (octant & 1)});
  }
  return around;
}

bool ShellCells::is_corner(const CheckPoint& p) {
  const std::vector<CheckPoint> around = this->around(p);
  return std::any_of(around.begin(), around.end(),
                     [&](const CheckPoint& numbers) { return holds(numbers); });
}

const ShellCells::Node& ShellCells::node(const CheckPoint& p) {
  const auto [here, is_new] = nodes_.try_emplace(p);
  if (is_new) {
    here->second.approach = clearance_.approach(grid_.place(p));
    here->second.is_free = clearance_.clearance(grid_.place(p)) > 0;
  }
  return here->second;
}

double ShellCells::distance(const CheckPoint& p) {
  return shell_distance(clearance_, node(p).approach, options_);
}

bool ShellCells::is_asked_for(const ToolClearance::Approach& approach) const {
  const auto& around = approach.around;
  return std::all_of(around.begin(), around.end(), [&](Index p) { return touchable_[p] != 0; }) &&
         (!options_.region || options_.region(approach.touched));
}

std::vector<CheckPoint> ShellCells::starts(
    const CheckPoint& p, const std::function<bool(const CheckPoint&)>& is_corner) {
  const Node& here = node(p);
  if (here.is_free) return {p};
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
    const Vec3 way(step[0], step[1], step[2]);
    const double along = way.dot(here.approach.out);
    if (!(along > 0) || !is_corner(q)) continue;
    const Node& there = node(q);
    if (there.approach.depth > here.approach.depth - kShallower * side_) continue;
    starts.push_back({way.squaredNorm() / (along * along) - 1, there.is_free ? p : q});
  }
  std::sort(starts.begin(), starts.end());
  std::vector<CheckPoint> best;
  for (const Start& start : starts) {
    const bool is_new = std::find(best.begin(), best.end(), start.check_point) == best.end();
    if (is_new && best.size() < kMostStarts) best.push_back(start.check_point);
  }
  return best;
}

}  // namespace palpate
