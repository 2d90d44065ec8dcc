// SPDX-License-Identifier: BSD-3-Clause
// The usable check-points around a site and the cells between them, and where in these a
// displacement lies.
#pragma once

#include <cstdint>
#include <vector>

#include "interpolation/cell_tree.h"
#include "state_space/touch_space.h"

namespace palpate {

/// Any of these at a corner marks its leaves.
inline constexpr Flags kMarking = flags::inverted | flags::unstable | flags::near_fold;

class CheckPointGrid {
 public:
  /// Of several levels at a check-point the first usable one is taken; only configurations with
  /// finite energy, force and stiffness are.
  /// @throws InputError as CellTree, a half-width that is not positive, or a configuration that
  ///   does not lie at its check-point.
  CheckPointGrid(const Site& site, const std::vector<ConfigurationSummary>& configurations);
  explicit CheckPointGrid(const TouchSite& site) : CheckPointGrid(site.site, site.configurations) {}

  enum class Place {
    /// No configuration is usable, or t is not finite.
    nowhere,
    /// In a leaf whose corners are all usable.
    cell,
    /// Outside the box: the nearest point of it lies in such a leaf.
    beside_cell,
    /// No such leaf: the nearest usable node.
    check_point,
  };

  struct Location {
    Place place = Place::nowhere;
    /// See is_marked().
    bool marked = false;
    /// Of the tree; in or beside a cell.
    std::int32_t leaf = 0;
    /// At a check-point.
    std::int32_t node = 0;
    /// Local coordinates in the leaf, in [0, 1].
    Vec3 s = Vec3::Zero();
    /// From there to t, m; zero in a cell.
    Vec3 offset = Vec3::Zero();
  };

  /// @note Realtime-safe.
  [[nodiscard]] Location locate(const Vec3& t) const noexcept;

  [[nodiscard]] const CellTree& tree() const { return tree_; }
  [[nodiscard]] const CellTree::Leaf& leaf(std::int32_t leaf) const { return tree_.leaves()[leaf]; }
  [[nodiscard]] std::int32_t num_nodes() const { return tree_.num_nodes(); }
  [[nodiscard]] std::int32_t reach() const { return reach_; }
  /// Distance of neighbouring check-points, m; 1 where rest is the only one.
  [[nodiscard]] double spacing() const { return spacing_; }
  /// Place of a node's configuration in the site's list; −1: none is usable.
  [[nodiscard]] std::int32_t configuration(std::int32_t node) const { return configuration_[node]; }
  [[nodiscard]] bool usable(std::int32_t node) const { return configuration_[node] >= 0; }
  /// All corners of a leaf are usable.
  [[nodiscard]] bool is_complete(std::int32_t leaf) const {
    return states_[leaf] != State::lacks_corner;
  }
  /// A corner of the leaf is inverted, unstable or near a fold, or it lies across branches.
  [[nodiscard]] bool is_marked(std::int32_t leaf) const {
    return states_[leaf] == State::marked || is_across(leaf);
  }
  /// It lies across branches though no corner tells, see branch_test.h.
  [[nodiscard]] bool is_across(std::int32_t leaf) const { return states_[leaf] == State::across; }

  /// A usable node that hangs on a complete leaf, the largest of those around it. What is
  /// interpolated is continuous where such a node takes what that leaf gives at it.
  struct HangingNode {
    std::int32_t node = 0;
    std::int32_t leaf = 0;
    /// Local coordinates in the leaf.
    Vec3 s = Vec3::Zero();
  };
  /// In an order in which those among the corners of a leaf come before what hangs on it.
  [[nodiscard]] const std::vector<HangingNode>& hanging_nodes() const { return hanging_nodes_; }

 private:
  enum class State : char { lacks_corner, complete, marked, across };

  void classify_leaves(const Site& site, const std::vector<ConfigurationSummary>& configurations);
  void find_hanging_nodes();
  void find_nearest();
  /// A complete leaf that meets an incomplete one at a point on the border of it, else that.
  [[nodiscard]] CellTree::Place across_sides(const Vec3& x,
                                             const CellTree::Place& place) const noexcept;

  CellTree tree_;
  std::int32_t reach_;
  double spacing_ = 1;
  double per_spacing_ = 1;
  bool any_usable_ = false;
  /// By node.
  std::vector<std::int32_t> configuration_;
  /// By leaf.
  std::vector<State> states_;
  std::vector<HangingNode> hanging_nodes_;
  /// The usable node nearest to each node.
  std::vector<std::int32_t> nearest_;
};

}  // namespace palpate
