// SPDX-License-Identifier: BSD-3-Clause
// The usable check-points of a tool space, the cells between them, and the location of a
// displacement in these cells.
//
// A node without a usable configuration is extrapolated (extrapolated_node.h), and a leaf with such
// a corner is not complete.
//
// A node is free if its configuration touches nothing, or if the clearance of the tool says so: the
// energy and all its derivatives are zero there. A leaf that is proved free (absent_cells.h) has
// free corners, so that the interpolation is exactly zero in it, unless one of them hangs on a leaf
// that is not free. Outside the box of a sparse grid the tool touches nothing.
//
// A node is singular if along each edge from it K or T changes the force by more than the forces at
// the ends and a large force together: towards a singular tangent, whose least eigenvalue is λ,
// they grow as 1/λ and 1/λ³, and tell nothing of the cells around.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "interpolation/cell_tree.h"
#include "state_space/touch_space.h"

namespace palpate {

/// How far a result can be trusted. The numbers are stored in data arrays: do not change them.
enum class Support : int {
  /// There is nothing to interpolate, or t is not finite: force, stiffness and energy are zero.
  none = 0,
  inside = 1,
  /// Outside the box, in a cell that lacks a usable corner, or in no cell and not proved free.
  extrapolated = 2,
  /// Inside, but a corner of the cell is inverted, unstable, near a fold or singular.
  marked = 3,
};

/// The less certain one of two supports.
[[nodiscard]] constexpr Support less_certain(Support a, Support b) noexcept {
  constexpr int kCertainty[] = {0, 3, 1, 2};
  return kCertainty[static_cast<int>(b)] < kCertainty[static_cast<int>(a)] ? b : a;
}

/// A corner with any of these flags marks its leaves.
inline constexpr Flags kMarking = flags::inverted | flags::unstable | flags::near_fold;

class CheckPointGrid {
 public:
  /// If a check-point has several levels, the first usable one is taken. Configurations without
  /// finite energy, force and stiffness are not used.
  /// @throws InputError as CellTree, a half-width that is not positive, or a configuration that
  ///   does not lie at its check-point.
  CheckPointGrid(const Grid& grid, const std::vector<ConfigurationSummary>& configurations,
                 const Clearance& clearance = {});
  explicit CheckPointGrid(const TouchToolSpace& tool_space);
  /// Makes the grid of a tool space to which configurations were added. It equals the grid that is
  /// made from all of them, except for the order of the leaves. What depends on the neighbourhood
  /// of a node or a leaf is found anew only in root cells with a change, and at their borders.
  /// @param before The grid before they were added.
  /// @param changed The check-points of these configurations.
  CheckPointGrid(const CheckPointGrid& before, const TouchToolSpace& tool_space,
                 const std::vector<CheckPoint>& changed, CellTree::Growth& growth);

  enum class Place {
    /// No configuration is usable, or t is not finite.
    nowhere,
    /// The tool touches nothing there.
    free,
    /// The place is in a leaf.
    cell,
    /// The place is outside the box, or in no leaf. The nearest point of the box, or of a leaf
    /// nearby, is given.
    beside_cell,
    /// There is no leaf: rest is the only check-point.
    rest,
  };

  struct Location {
    Place place = Place::nowhere;
    Support support = Support::none;
    /// The leaf that the place is in or beside.
    std::int32_t leaf = 0;
    /// Local coordinates in the leaf, in [0, 1].
    Vec3 s = Vec3::Zero();
    /// The point of the leaf, in spacings from rest.
    Vec3 x = Vec3::Zero();
    /// The offset from that point to t, m; zero in a cell.
    Vec3 offset = Vec3::Zero();
  };

  /// @note Realtime-safe.
  [[nodiscard]] Location locate(const Vec3& t) const noexcept;

  [[nodiscard]] const CellTree& tree() const { return tree_; }
  [[nodiscard]] const CellTree::Leaf& leaf(std::int32_t leaf) const { return tree_.leaves()[leaf]; }
  [[nodiscard]] std::int32_t num_nodes() const { return tree_.num_nodes(); }
  [[nodiscard]] std::int32_t reach() const { return reach_; }
  [[nodiscard]] bool is_sparse() const { return is_sparse_; }
  /// Distance of neighbouring check-points, m; 1 if rest is the only one.
  [[nodiscard]] double spacing() const { return spacing_; }
  /// Coordinates of the tool at a node, m.
  [[nodiscard]] Vec3 place(std::int32_t node) const {
    const CheckPoint p = tree_.point(node);
    return origin_ + spacing_ * Vec3(p[0], p[1], p[2]);
  }
  /// Index of a node's configuration in the tool space's list; −1: none is usable.
  [[nodiscard]] std::int32_t configuration(std::int32_t node) const { return configuration_[node]; }
  [[nodiscard]] bool usable(std::int32_t node) const { return configuration_[node] >= 0; }
  /// Whether a node marks its leaves: its configuration has a flag of kMarking, or is singular.
  [[nodiscard]] bool is_marking(std::int32_t node) const { return marking_[node] != 0; }
  /// Whether the tool touches nothing at a node and around it; the node may be usable or not.
  [[nodiscard]] bool is_free(std::int32_t node) const { return free_[node] != 0; }
  /// Whether the tool touches nothing anywhere in a leaf.
  [[nodiscard]] bool is_proved_free(std::int32_t leaf) const { return proved_free_[leaf] != 0; }
  /// Whether a leaf is proved free and the interpolation is exactly zero in it.
  [[nodiscard]] bool is_zero(std::int32_t leaf) const { return states_[leaf] == State::zero; }
  /// Whether all corners of a leaf are usable.
  [[nodiscard]] bool is_complete(std::int32_t leaf) const {
    const auto& corners = tree_.leaves()[leaf].corners;
    return std::all_of(corners.begin(), corners.end(), [&](std::int32_t n) { return usable(n); });
  }
  /// Whether a corner of a leaf is marking, or the leaf lies across branches.
  [[nodiscard]] bool is_marked(std::int32_t leaf) const {
    return states_[leaf] == State::marked || is_across(leaf);
  }
  /// Whether a corner of a leaf is neither usable nor free, so that a force of zero tells nothing
  /// there.
  [[nodiscard]] bool is_unknown(std::int32_t leaf) const noexcept {
    return states_[leaf] == State::unknown || states_[leaf] == State::lacks_corner;
  }
  /// Whether a leaf lies across branches though none of its corners is marked, see branch_test.h.
  [[nodiscard]] bool is_across(std::int32_t leaf) const { return states_[leaf] == State::across; }

  [[nodiscard]] bool any_usable() const { return any_usable_; }
  /// Whether a leaf lacks a usable corner.
  [[nodiscard]] bool has_extrapolated_nodes() const { return has_extrapolated_nodes_; }
  /// The usable node that is nearest to a node, itself if it is usable; −1: no node is usable.
  [[nodiscard]] std::int32_t nearest(std::int32_t node) const { return nearest_[node]; }

  /// A node that hangs on a leaf: on the largest of the leaves around it. The interpolation is
  /// continuous if the node takes the value of this leaf.
  struct HangingNode {
    std::int32_t node = 0;
    std::int32_t leaf = 0;
    /// Local coordinates in the leaf.
    Vec3 s = Vec3::Zero();
  };
  /// The hanging nodes. The corners of a leaf come before the nodes that hang on it.
  [[nodiscard]] const std::vector<HangingNode>& hanging_nodes() const { return hanging_nodes_; }
  /// The hanging nodes among usable nodes, of complete leaves alone.
  [[nodiscard]] const std::vector<HangingNode>& hanging_on_complete() const {
    return hanging_on_complete_;
  }

  /// Memory that locate() needs.
  void add_memory(MemoryRanges& ranges) const {
    tree_.add_memory(ranges);
    palpate::add_memory(states_, ranges);
  }

 private:
  /// unknown: no configuration of the tool space is usable. lacks_free: all corners that lack a
  /// usable configuration are nevertheless free.
  enum class State : char { unknown, zero, lacks_corner, lacks_free, complete, marked, across };
  static constexpr Place kPlaceIn[] = {Place::nowhere, Place::free, Place::cell, Place::cell,
                                       Place::cell,    Place::cell, Place::cell};
  static constexpr Support kSupportIn[] = {
      Support::none,   Support::inside, Support::extrapolated, Support::extrapolated,
      Support::inside, Support::marked, Support::marked};
  /// A displacement that lies outside the box by less than this, in spacings, is on its border:
  /// rounding of t = i·H must not put a check-point of the border outside.
  static constexpr double kOnBorder = 1e-9;

  /// What is known of a grid from before it has grown.
  struct Known;

  /// @throws InputError a configuration does not lie at its check-point.
  void find_configurations(const std::vector<ConfigurationSummary>& configurations);
  [[nodiscard]] bool find_free(std::int32_t node,
                               const std::vector<ConfigurationSummary>& configurations,
                               const Clearance& clearance) const;
  /// @param known What is known from before the grid has grown; null: nothing.
  void classify(const Grid& grid, const std::vector<ConfigurationSummary>& configurations,
                const Clearance& clearance, const Known* known);
  void find_marking(const std::vector<ConfigurationSummary>& configurations);
  void classify_leaves(const std::vector<ConfigurationSummary>& configurations, const Known* known);
  void find_free_leaves(const Grid& grid, const Clearance& clearance, const Known* known);
  [[nodiscard]] std::vector<HangingNode> find_hanging_nodes(bool on_complete,
                                                            const Known* known) const;
  /// The leaf that a node hangs on; −1: none.
  [[nodiscard]] std::int32_t find_holder(std::int32_t node, bool on_complete) const;
  void find_nearest();

  CellTree tree_;
  std::int32_t reach_;
  double spacing_ = 1;
  double per_spacing_ = 1;
  Vec3 origin_;
  bool is_sparse_;
  bool any_usable_ = false;
  /// Whether no configuration is usable, and no place is known to be free.
  bool is_empty_ = false;
  bool outside_is_free_ = false;
  bool has_extrapolated_nodes_ = false;
  /// The index of the configuration of each node; −1: none.
  std::vector<std::int32_t> configuration_;
  /// Whether each node is free.
  std::vector<char> free_;
  /// Whether each node is marking.
  std::vector<char> marking_;
  /// The state of each leaf.
  std::vector<State> states_;
  /// Whether the energy jumps within each leaf, see BranchTest::has_jump().
  std::vector<char> has_jump_;
  /// Whether each leaf is proved free.
  std::vector<char> proved_free_;
  std::vector<HangingNode> hanging_nodes_;
  std::vector<HangingNode> hanging_on_complete_;
  /// The usable node that is nearest to each node.
  std::vector<std::int32_t> nearest_;
};

inline CheckPointGrid::Location CheckPointGrid::locate(const Vec3& t) const noexcept {
  Location at;
  // The sum is not finite if one term is not, or if it overflows: then t is too far out.
  if (is_empty_ || !std::isfinite(t[0] + t[1] + t[2])) return at;
  const Vec3 from_rest = t - origin_;
  const double reach = reach_;
  double most_outside = 0;
  for (int k = 0; k < 3; ++k) {
    const double x = from_rest[k] * per_spacing_;
    at.x[k] = std::min(std::max(x, -reach), reach);
    most_outside = std::max(most_outside, std::abs(x - at.x[k]));
  }
  if (reach_ == 0) {
    at.place = Place::rest;
    at.support = Support::extrapolated;
    at.offset = from_rest;
    return at;
  }
  CellTree::Place place = tree_.locate(at.x + Vec3::Constant(reach));
  const bool is_outside = most_outside > kOnBorder;
  if (place.leaf == CellTree::kFree || (is_outside && outside_is_free_)) {
    at.place = Place::free;
    at.support = Support::inside;
    return at;
  }
  if (place.leaf >= CellTree::kNearestRoot) {
    if (!any_usable_) return at;
    Vec3 x = at.x + Vec3::Constant(reach);
    place = tree_.locate_beside(place.leaf - CellTree::kNearestRoot, x);
    x -= Vec3::Constant(reach);
    most_outside = std::max(most_outside, (x - at.x).lpNorm<Eigen::Infinity>());
    at.x = x;
  }
  at.leaf = place.leaf;
  at.s = place.s;
  const int state = static_cast<int>(states_[place.leaf]);
  at.place = kPlaceIn[state];
  at.support = kSupportIn[state];
  if (most_outside <= kOnBorder || at.place == Place::nowhere) return at;
  at.place = Place::beside_cell;
  at.support = Support::extrapolated;
  at.offset = from_rest - spacing_ * at.x;
  return at;
}

}  // namespace palpate
