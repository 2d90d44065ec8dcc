// SPDX-License-Identifier: BSD-3-Clause
#include "interpolation/check_point_grid.h"

#include <algorithm>
#include <numeric>
#include <string>

#include "base/error.h"
#include "base/quantity.h"
#include "interpolation/branch_test.h"

namespace palpate {
namespace {

/// The largest distance of a configuration from its check-point, in spacings: a t that was rounded
/// to single precision is off by 1e-7 of the half-width.
constexpr double kOffCheckPoint = 1e-4;

bool has_finite_data(const ConfigurationSummary& c) {
  return c.usable() && std::isfinite(c.energy) && c.force.allFinite() && c.stiffness.allFinite();
}

}  // namespace

CheckPointGrid::CheckPointGrid(const TouchToolSpace& tool_space) try
    : CheckPointGrid(tool_space.setup.grid, tool_space.configurations, tool_space.clearance) {
} catch (const InputError& error) {
  throw InputError("At " + tool_space.setup.name() + ": " + error.what());
}

CheckPointGrid::CheckPointGrid(const Grid& grid,
                               const std::vector<ConfigurationSummary>& configurations,
                               const Clearance& clearance)
    : tree_(grid, configurations, clearance),
      reach_(grid.reach()),
      origin_(grid.origin),
      is_sparse_(grid.sparse),
      outside_is_free_(grid.sparse && clearance) {
  if (grid.resolution > 1 && !(grid.half_width > 0 && std::isfinite(grid.half_width))) {
    throw InputError("The grid has a half-width of " + quantity(grid.half_width, "m") +
                     "; it takes a positive one.");
  }
  if (grid.resolution > 1) spacing_ = grid.spacing();
  per_spacing_ = 1 / spacing_;

  configuration_.assign(static_cast<std::size_t>(num_nodes()), -1);
  for (std::size_t i = 0; i < configurations.size(); ++i) {
    const ConfigurationSummary& c = configurations[i];
    const std::int32_t node = tree_.find(c.check_point);
    if (node < 0 || !has_finite_data(c)) continue;
    if (!((c.t - place(node)).norm() <= kOffCheckPoint * spacing_)) {
      throw InputError("A configuration does not lie at its check-point (" +
                       std::to_string(c.check_point[0]) + ", " + std::to_string(c.check_point[1]) +
                       ", " + std::to_string(c.check_point[2]) + "): the grid was changed after " +
                       "it was computed. Compute the state space again.");
    }
    if (configuration_[node] < 0) configuration_[node] = static_cast<std::int32_t>(i);
    any_usable_ = true;
  }
  is_empty_ = !any_usable_ && !(grid.sparse && reach_ > 0);
  find_free_nodes(configurations, clearance);
  classify_leaves(configurations);
  hanging_nodes_ = find_hanging_nodes(false);
  hanging_on_complete_ = find_hanging_nodes(true);
  find_free_leaves(grid, clearance);
  find_nearest();
}

void CheckPointGrid::find_free_nodes(const std::vector<ConfigurationSummary>& configurations,
                                     const Clearance& clearance) {
  for (std::int32_t n = 0; n < num_nodes(); ++n) {
    const bool touches_nothing =
        usable(n) && (configurations[configuration_[n]].flags & flags::touches_nothing) != 0;
    free_.push_back(touches_nothing || (clearance && clearance(place(n)) > 0) ? 1 : 0);
  }
}

void CheckPointGrid::classify_leaves(const std::vector<ConfigurationSummary>& configurations) {
  for (const CellTree::Leaf& leaf : tree_.leaves()) {
    State state = State::complete;
    for (std::int32_t node : leaf.corners) {
      if (usable(node)) {
        const bool marks = (configurations[configuration_[node]].flags & kMarking) != 0;
        if (marks && state == State::complete) state = State::marked;
        continue;
      }
      has_extrapolated_nodes_ = true;
      if (state != State::lacks_corner) {
        state = is_free(node) ? State::lacks_free : State::lacks_corner;
      }
    }
    states_.push_back(any_usable_ ? state : State::unknown);
  }
  const std::vector<char> across = BranchTest(*this, configurations).leaves_across();
  for (std::size_t l = 0; l < across.size(); ++l) {
    if (across[l] != 0 && states_[l] == State::complete) states_[l] = State::across;
  }
}

void CheckPointGrid::find_free_leaves(const Grid& grid, const Clearance& clearance) {
  const auto& leaves = tree_.leaves();
  proved_free_.assign(leaves.size(), 0);
  for (std::size_t l = 0; l < leaves.size(); ++l) {
    const auto& corners = leaves[l].corners;
    const bool may_be =
        std::all_of(corners.begin(), corners.end(), [&](std::int32_t n) { return is_free(n); });
    if (may_be && palpate::is_proved_free(grid, clearance, leaves[l].cell)) proved_free_[l] = 1;
  }
  std::vector<std::int32_t> holder(static_cast<std::size_t>(num_nodes()), -1);
  for (const HangingNode& hanging : hanging_nodes_) holder[hanging.node] = hanging.leaf;
  // A node hangs on a leaf that is larger than those it is a corner of, so the larger leaves go
  // first.
  std::vector<std::int32_t> by_size(leaves.size());
  std::iota(by_size.begin(), by_size.end(), 0);
  std::stable_sort(by_size.begin(), by_size.end(), [&](std::int32_t a, std::int32_t b) {
    return leaves[a].cell.side > leaves[b].cell.side;
  });
  for (std::int32_t l : by_size) {
    const auto& corners = leaves[l].corners;
    const bool zero = std::all_of(corners.begin(), corners.end(), [&](std::int32_t n) {
      return holder[n] < 0 || is_zero(holder[n]);
    });
    if (zero && is_proved_free(l)) states_[l] = State::zero;
  }
}

std::vector<CheckPointGrid::HangingNode> CheckPointGrid::find_hanging_nodes(
    bool on_complete) const {
  std::vector<HangingNode> nodes;
  for (std::int32_t n = 0; n < num_nodes(); ++n) {
    if (on_complete && !usable(n)) continue;
    const CheckPoint p = tree_.point(n);
    std::int32_t holder = -1;
    tree_.for_each_leaf_around(p, [&](std::int32_t l) {
      const auto& corners = leaf(l).corners;
      const bool larger = holder < 0 || leaf(l).cell.side > leaf(holder).cell.side;
      const bool hangs = std::find(corners.begin(), corners.end(), n) == corners.end();
      if (larger && hangs && (!on_complete || is_complete(l))) holder = l;
    });
    if (holder < 0) continue;
    const Cell& cell = leaf(holder).cell;
    HangingNode& hanging = nodes.emplace_back();
    hanging.node = n;
    hanging.leaf = holder;
    for (int k = 0; k < 3; ++k) {
      hanging.s[k] = static_cast<double>(p[k] - cell.first[k]) / cell.side;
    }
  }
  // A node hangs on a leaf that is larger than those it is a corner of, so the larger leaves go
  // first.
  std::stable_sort(nodes.begin(), nodes.end(), [&](const HangingNode& a, const HangingNode& b) {
    return leaf(a.leaf).cell.side > leaf(b.leaf).cell.side;
  });
  return nodes;
}

// Corners of a leaf pass their nearest usable node on, until no corner gets a nearer one.
void CheckPointGrid::find_nearest() {
  nearest_.assign(configuration_.size(), -1);
  if (!any_usable_) return;
  const auto distance2 = [&](std::int32_t a, std::int32_t b) {
    return squared_distance(tree_.point(a), tree_.point(b));
  };
  std::vector<std::int32_t> changed;
  for (std::int32_t n = 0; n < num_nodes(); ++n) {
    if (!usable(n)) continue;
    nearest_[n] = n;
    changed.push_back(n);
  }
  if (changed.size() == nearest_.size()) return;
  while (!changed.empty()) {
    std::vector<std::int32_t> next;
    for (std::int32_t n : changed) {
      tree_.for_each_leaf_around(tree_.point(n), [&](std::int32_t l) {
        for (std::int32_t m : leaf(l).corners) {
          const std::int32_t offered = nearest_[n];
          std::int32_t& known = nearest_[m];
          if (known < 0 || distance2(m, offered) < distance2(m, known) ||
              (distance2(m, offered) == distance2(m, known) && offered < known)) {
            known = offered;
            next.push_back(m);
          }
        }
      });
    }
    changed = std::move(next);
  }
  // Search all nodes for those that no leaf connects with a usable one.
  for (std::int32_t n = 0; n < num_nodes(); ++n) {
    if (nearest_[n] >= 0) continue;
    std::int32_t nearest = -1;
    for (std::int32_t m = 0; m < num_nodes(); ++m) {
      if (usable(m) && (nearest < 0 || distance2(n, m) < distance2(n, nearest))) nearest = m;
    }
    nearest_[n] = nearest;
  }
}

}  // namespace palpate
