// SPDX-License-Identifier: BSD-3-Clause
#include "interpolation/check_point_grid.h"

#include <algorithm>
#include <string>
#include <utility>

#include "base/error.h"
#include "base/quantity.h"
#include "interpolation/branch_test.h"
#include "interpolation/extrapolated_node.h"

namespace palpate {
namespace {

/// The largest distance of a configuration from its check-point, in spacings: a t that was rounded
/// to single precision is off by 1e-7 of the half-width.
constexpr double kOffCheckPoint = 1e-4;

/// What K and T of a configuration add to the difference of the forces at the ends of an edge, at
/// the most, N.
double largest_change(const ConfigurationSummary& c, const Vec3& d) {
  const double of_stiffness = 0.5 * (c.stiffness * d).norm();
  if (!c.has_third_derivative()) return of_stiffness;
  return std::max(of_stiffness, (times(c.third_derivative, d) * d).norm() / 12);
}

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

  find_configurations(configurations);
  is_empty_ = !any_usable_ && !(grid.sparse && reach_ > 0);
  classify(grid, configurations, clearance, nullptr);
}

struct CheckPointGrid::Known {
  const CheckPointGrid& before;
  const CellTree::Growth& growth;
  /// For each node, its earlier number (−1: it did not exist), and whether its neighbourhood has
  /// changed.
  std::vector<std::int32_t> node_before;
  std::vector<char> is_anew;
  /// The earlier number of each leaf; −1: its root cell was built anew.
  std::vector<std::int32_t> leaf_before;

  Known(const CheckPointGrid& grid, const CheckPointGrid& grid_before,
        const CellTree::Growth& tree_growth)
      : before(grid_before),
        growth(tree_growth),
        node_before(static_cast<std::size_t>(grid.num_nodes()), -1),
        is_anew(node_before.size(), 0),
        leaf_before(grid.tree().leaves().size(), -1) {
    for (std::size_t n = 0; n < growth.nodes.size(); ++n) {
      node_before[growth.nodes[n]] = static_cast<std::int32_t>(n);
    }
    for (const std::int32_t n : growth.nodes_anew) is_anew[n] = 1;
    for (std::size_t l = 0; l < growth.leaves.size(); ++l) {
      if (growth.leaves[l] >= 0) leaf_before[growth.leaves[l]] = static_cast<std::int32_t>(l);
    }
  }
};

CheckPointGrid::CheckPointGrid(const CheckPointGrid& before, const TouchToolSpace& tool_space,
                               const std::vector<CheckPoint>& changed, CellTree::Growth& growth)
    : tree_(before.tree_, tool_space.setup.grid, changed, tool_space.clearance, growth),
      reach_(before.reach_),
      spacing_(before.spacing_),
      per_spacing_(before.per_spacing_),
      origin_(before.origin_),
      is_sparse_(before.is_sparse_),
      outside_is_free_(before.outside_is_free_) {
  find_configurations(tool_space.configurations);
  is_empty_ = !any_usable_ && !(is_sparse_ && reach_ > 0);
  const Known known(*this, before, growth);
  classify(tool_space.setup.grid, tool_space.configurations, tool_space.clearance, &known);
  // Whether a node is singular depends on the forces of all.
  for (std::size_t n = 0; n < growth.nodes.size(); ++n) {
    const std::int32_t now = growth.nodes[n];
    const bool is_same = is_marking(now) == before.is_marking(static_cast<std::int32_t>(n));
    if (!is_same && known.is_anew[now] == 0) growth.nodes_anew.push_back(now);
  }
  std::sort(growth.nodes_anew.begin(), growth.nodes_anew.end());
}

void CheckPointGrid::find_configurations(const std::vector<ConfigurationSummary>& configurations) {
  configuration_.assign(static_cast<std::size_t>(num_nodes()), -1);
  std::int32_t next = 0;
  for (std::size_t i = 0; i < configurations.size(); ++i) {
    const ConfigurationSummary& c = configurations[i];
    // Configurations mostly come in the order of the nodes.
    const bool is_next = next < num_nodes() && tree_.point(next) == c.check_point;
    const std::int32_t node = is_next ? next : tree_.find(c.check_point);
    if (node < 0) continue;
    next = node + 1;
    if (!has_finite_data(c)) continue;
    if (!((c.t - place(node)).norm() <= kOffCheckPoint * spacing_)) {
      throw InputError("A configuration does not lie at its check-point (" +
                       std::to_string(c.check_point[0]) + ", " + std::to_string(c.check_point[1]) +
                       ", " + std::to_string(c.check_point[2]) + "): the grid was changed after " +
                       "it was computed. Compute the state space again.");
    }
    if (configuration_[node] < 0) configuration_[node] = static_cast<std::int32_t>(i);
    any_usable_ = true;
  }
}

void CheckPointGrid::classify(const Grid& grid,
                              const std::vector<ConfigurationSummary>& configurations,
                              const Clearance& clearance, const Known* known) {
  for (std::int32_t n = 0; n < num_nodes(); ++n) {
    const bool is_known = known != nullptr && known->is_anew[n] == 0;
    const bool is_free = is_known ? known->before.is_free(known->node_before[n])
                                  : find_free(n, configurations, clearance);
    free_.push_back(is_free ? 1 : 0);
  }
  find_marking(configurations);
  classify_leaves(configurations, known);
  hanging_nodes_ = find_hanging_nodes(false, known);
  hanging_on_complete_ = find_hanging_nodes(true, known);
  find_free_leaves(grid, clearance, known);
  find_nearest();
}

bool CheckPointGrid::find_free(std::int32_t node,
                               const std::vector<ConfigurationSummary>& configurations,
                               const Clearance& clearance) const {
  const bool touches_nothing =
      usable(node) && (configurations[configuration_[node]].flags & flags::touches_nothing) != 0;
  return touches_nothing || (clearance && clearance(place(node)) > 0);
}

void CheckPointGrid::find_marking(const std::vector<ConfigurationSummary>& configurations) {
  std::vector<double> forces;
  for (std::int32_t n = 0; n < num_nodes(); ++n) {
    if (!usable(n) || is_free(n)) continue;
    forces.push_back(configurations[configuration_[n]].force.norm());
  }
  const double large = large_force(std::move(forces));
  enum Fit : char { not_known, none, some };
  std::vector<Fit> fits(static_cast<std::size_t>(num_nodes()), not_known);
  for (const CellTree::Leaf& leaf : tree_.leaves()) {
    for (int axis = 0; axis < 3; ++axis) {
      const int step = 4 >> axis;
      for (int corner = 0; corner < 8; ++corner) {
        const std::int32_t n = leaf.corners[corner];
        const std::int32_t other = leaf.corners[corner ^ step];
        if (fits[n] == some || !usable(n) || !usable(other)) continue;
        const ConfigurationSummary& c = configurations[configuration_[n]];
        const double at_ends = c.force.norm() + configurations[configuration_[other]].force.norm();
        const Vec3 d = leaf.cell.side * spacing_ * Vec3::Unit(axis);
        fits[n] = largest_change(c, d) > at_ends + large ? none : some;
      }
    }
  }
  for (std::int32_t n = 0; n < num_nodes(); ++n) {
    const bool has_flag = usable(n) && (configurations[configuration_[n]].flags & kMarking) != 0;
    marking_.push_back(has_flag || fits[n] == none ? 1 : 0);
  }
}

void CheckPointGrid::classify_leaves(const std::vector<ConfigurationSummary>& configurations,
                                     const Known* known) {
  for (const CellTree::Leaf& leaf : tree_.leaves()) {
    State state = State::complete;
    for (std::int32_t node : leaf.corners) {
      if (usable(node)) {
        if (is_marking(node) && state == State::complete) state = State::marked;
        continue;
      }
      has_extrapolated_nodes_ = true;
      if (state != State::lacks_corner) {
        state = is_free(node) ? State::lacks_free : State::lacks_corner;
      }
    }
    states_.push_back(any_usable_ ? state : State::unknown);
  }
  const BranchTest test(*this, configurations);
  for (std::size_t l = 0; l < states_.size(); ++l) {
    const std::int32_t before = known != nullptr ? known->leaf_before[l] : -1;
    has_jump_.push_back(before >= 0 ? known->before.has_jump_[before]
                                    : test.has_jump(leaf(static_cast<std::int32_t>(l)).cell));
  }
  const std::vector<char> across = test.leaves_across(has_jump_);
  for (std::size_t l = 0; l < across.size(); ++l) {
    if (across[l] != 0 && states_[l] == State::complete) states_[l] = State::across;
  }
}

void CheckPointGrid::find_free_leaves(const Grid& grid, const Clearance& clearance,
                                      const Known* known) {
  const auto& leaves = tree_.leaves();
  proved_free_.assign(leaves.size(), 0);
  for (std::size_t l = 0; l < leaves.size(); ++l) {
    if (const std::int32_t before = known != nullptr ? known->leaf_before[l] : -1; before >= 0) {
      proved_free_[l] = known->before.proved_free_[before];
      continue;
    }
    const auto& corners = leaves[l].corners;
    const bool may_be =
        std::all_of(corners.begin(), corners.end(), [&](std::int32_t n) { return is_free(n); });
    if (may_be && palpate::is_proved_free(grid, clearance, leaves[l].cell)) proved_free_[l] = 1;
  }
  std::vector<std::int32_t> holder(static_cast<std::size_t>(num_nodes()), -1);
  for (const HangingNode& hanging : hanging_nodes_) holder[hanging.node] = hanging.leaf;
  // A node hangs on a leaf that is larger than those it is a corner of, so the larger leaves go
  // first.
  for (std::int32_t side = tree_.coarsest(); side > 0; side /= 2) {
    for (std::size_t l = 0; l < leaves.size(); ++l) {
      if (leaves[l].cell.side != side || proved_free_[l] == 0) continue;
      const auto& corners = leaves[l].corners;
      const bool zero = std::all_of(corners.begin(), corners.end(), [&](std::int32_t n) {
        return holder[n] < 0 || is_zero(holder[n]);
      });
      if (zero) states_[l] = State::zero;
    }
  }
}

std::int32_t CheckPointGrid::find_holder(std::int32_t node, bool on_complete) const {
  std::int32_t holder = -1;
  tree_.for_each_leaf_around(tree_.point(node), [&](std::int32_t l) {
    const auto& corners = leaf(l).corners;
    const bool larger = holder < 0 || leaf(l).cell.side > leaf(holder).cell.side;
    const bool hangs = std::find(corners.begin(), corners.end(), node) == corners.end();
    if (larger && hangs && (!on_complete || is_complete(l))) holder = l;
  });
  return holder;
}

std::vector<CheckPointGrid::HangingNode> CheckPointGrid::find_hanging_nodes(
    bool on_complete, const Known* known) const {
  std::vector<std::int32_t> holder_before;
  if (known != nullptr) {
    holder_before.assign(static_cast<std::size_t>(known->before.num_nodes()), -1);
    const auto& before =
        on_complete ? known->before.hanging_on_complete_ : known->before.hanging_nodes_;
    for (const HangingNode& hanging : before) holder_before[hanging.node] = hanging.leaf;
  }
  std::vector<HangingNode> nodes;
  for (std::int32_t n = 0; n < num_nodes(); ++n) {
    if (on_complete && !usable(n)) continue;
    std::int32_t holder = -1;
    if (known != nullptr && known->is_anew[n] == 0) {
      const std::int32_t before = holder_before[known->node_before[n]];
      if (before >= 0) holder = known->growth.leaves[before];
    } else {
      holder = find_holder(n, on_complete);
    }
    if (holder < 0) continue;
    const CheckPoint p = tree_.point(n);
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
  for (std::int32_t n = 0; n < num_nodes(); ++n) {
    if (usable(n)) nearest_[n] = n;
  }
  // At first, only corners of leaves that lack a usable corner, and nodes on the sides of leaves,
  // can have something to pass on.
  std::vector<char> passes_on(nearest_.size(), 0);
  for (const CellTree::Leaf& leaf : tree_.leaves()) {
    const auto& corners = leaf.corners;
    if (std::all_of(corners.begin(), corners.end(), [&](std::int32_t n) { return usable(n); })) {
      continue;
    }
    for (const std::int32_t n : corners) passes_on[n] = 1;
  }
  for (const HangingNode& hanging : hanging_nodes_) passes_on[hanging.node] = 1;
  std::vector<std::int32_t> changed;
  bool are_all_usable = true;
  for (std::int32_t n = 0; n < num_nodes(); ++n) {
    are_all_usable = are_all_usable && usable(n);
    if (usable(n) && passes_on[n] != 0) changed.push_back(n);
  }
  if (are_all_usable) return;
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
