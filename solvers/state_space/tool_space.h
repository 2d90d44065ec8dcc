// SPDX-License-Identifier: BSD-3-Clause
// A tool space: a body is touched by one tool, whose coordinates lie on a grid, and is explored by
// a policy. These three are what it is; its configurations are what was found.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "base/types.h"
#include "interaction/interaction_spec.h"
#include "state_space/configuration.h"
#include "state_space/mesh_region.h"
#include "state_space/tool_space_key.h"

namespace palpate {

/// Whether a check-point may have several levels. The numbers are stored: keep them.
enum class History : std::int32_t {
  /// A check-point has one configuration, however it was reached.
  flat = 0,
  /// Check-points have levels where there are signs of several branches.
  automatic = 1,
  /// All transitions between neighbours are made [P07].
  levels = 2,
};

/// The largest number of intermediate states on the way to a configuration; [P08] has 5.
inline constexpr std::int32_t kMostIntermediateStates = 100;

/// The largest number of check-points along an axis: with more, the number of a node of the grid
/// would overflow.
inline constexpr std::int32_t kLargestResolution = 1001;
/// The largest number of corners of the coarsest cells along an axis. Each of them takes memory,
/// whether there is a configuration or not.
inline constexpr std::int32_t kLargestCoarsestResolution = 129;
/// The largest number of corners of the coarsest cells of all tool spaces, for the same
/// reason.
inline constexpr std::int64_t kMostCoarsestCorners = std::int64_t{1} << 24;

/// The check-points: a cube around (0,0,0).
struct Grid {
  /// Half the side of the box, m.
  double half_width = 0;
  /// Check-points along an axis; odd, so that rest is one of them.
  std::int32_t resolution = 0;
  /// Side of the coarsest cells, in steps of the grid: a power of two that divides reach(); 1: the
  /// grid is uniform. The cells in between are halved where there are configurations, see
  /// interpolation/cell_tree.h.
  std::int32_t coarsest = 1;
  /// Coordinates of the tool at (0,0,0) [3], m.
  Vec3 origin = Vec3::Zero();
  /// There is a coarsest cell only where each of its corners has a configuration. Where there is
  /// none, the tool touches nothing, or nothing is known.
  bool sparse = false;

  /// Distance of neighbouring check-points, m; 0 where rest is the only one.
  [[nodiscard]] double spacing() const {
    return resolution > 1 ? 2 * half_width / (resolution - 1) : 0;
  }
  /// What gives ∂u/∂t the unit of u, m: the spacing, and where there is none any length.
  [[nodiscard]] double field_step() const { return spacing() > 0 ? spacing() : 1; }
  [[nodiscard]] std::int32_t reach() const { return (resolution - 1) / 2; }
  /// Corners of the coarsest cells along an axis.
  [[nodiscard]] std::int32_t coarsest_resolution() const { return 2 * reach() / coarsest + 1; }
  /// Coordinates of the tool at a check-point, m.
  [[nodiscard]] Vec3 place(const CheckPoint& c) const {
    return origin + spacing() * Vec3(c[0], c[1], c[2]);
  }
};

[[nodiscard]] inline bool operator==(const Grid& a, const Grid& b) {
  return a.half_width == b.half_width && a.resolution == b.resolution && a.coarsest == b.coarsest &&
         a.origin == b.origin && a.sparse == b.sparse;
}

/// How far the exploration goes, and what is kept.
struct ExplorationPolicy {
  /// Force limit of the device, N; 0: there is none.
  double force_limit = 0;
  /// The error of the force that was asked for, N; 0: the grid is uniform.
  double tolerance = 0;
  /// Whether the tolerance is a share of the largest force, and not in N.
  bool tolerance_is_relative = false;
  History history = History::flat;
  /// The number of intermediate states on the way to each configuration.
  std::int32_t intermediate_states = 0;
  /// Whether each configuration has its third derivative.
  bool third_derivatives = false;
  /// The largest depth to which a rigid tool presses, m; 0: as deep as the force limit allows.
  double depth = 0;

  [[nodiscard]] bool is_beyond_limit(const Vec3& force) const {
    return force_limit > 0 && force.norm() > force_limit;
  }
  /// The flags of a state with this force: flags::beyond_force_limit is set if the force is beyond
  /// the limit, and cleared otherwise.
  [[nodiscard]] Flags marked(Flags of_state, const Vec3& force) const {
    return is_beyond_limit(force) ? of_state | flags::beyond_force_limit
                                  : of_state & ~flags::beyond_force_limit;
  }

  [[nodiscard]] friend bool operator==(const ExplorationPolicy& a, const ExplorationPolicy& b) {
    const auto all = [](const ExplorationPolicy& p) {
      return std::tie(p.force_limit, p.tolerance, p.tolerance_is_relative, p.history,
                      p.intermediate_states, p.third_derivatives, p.depth);
    };
    return all(a) == all(b);
  }
};

/// The error of the force that is asked for, given what was found, N; 0: none.
[[nodiscard]] inline double force_tolerance(const ExplorationPolicy& policy,
                                            const std::vector<ConfigurationSummary>& found) {
  return policy.tolerance * (policy.tolerance_is_relative ? largest_force(found) : 1);
}

struct ToolSpaceSetup {
  ToolSpaceId id = 0;
  InteractionSpec interaction;
  Grid grid;
  ExplorationPolicy policy;
  /// The body that the tool touches.
  BodyId body = kFirstBody;
  /// Where the tool space serves, of an organ that is divided; nothing: everywhere.
  std::optional<MeshRegion> region;

  [[nodiscard]] ToolSpaceKey key() const { return {id, body}; }
  /// The name for a message: "active node 8", or for another body than the first "active node 8 of
  /// body 2".
  [[nodiscard]] std::string name() const {
    return interaction.name() + (body == kFirstBody ? "" : " of body " + std::to_string(body));
  }
  /// The number by which it is named within its body: the active node, or below 0 one of a rigid
  /// tool's.
  [[nodiscard]] ToolSpaceId number() const { return presses() ? id : interaction.active_node; }
  /// Whether the tool presses the body anywhere, see ToolKind::presses().
  [[nodiscard]] bool presses() const { return interaction.presses(); }
  /// Whether the space is one of those of a tool that is turned, at one of its orientations.
  [[nodiscard]] bool turns() const {
    return presses() && interaction.tool.motion == ToolMotion::turned;
  }
  /// How far the space goes from where the tool touches nothing, m: the half-width of the space of
  /// a tool that holds the body at a point, the depth to which another one presses.
  [[nodiscard]] double depth() const {
    if (!presses()) return grid.half_width;
    return policy.depth > 0 ? policy.depth : interaction.touching_radius();
  }
};

[[nodiscard]] inline bool operator==(const ToolSpaceSetup& a, const ToolSpaceSetup& b) {
  return a.key() == b.key() && a.interaction == b.interaction && a.grid == b.grid &&
         a.policy == b.policy && a.region == b.region;
}

/// The key of a state: the tool space, the check-point, and the level of the equilibrium there.
struct StateKey {
  ToolSpaceKey tool_space;
  CheckPoint check_point{};
  std::int32_t level = 0;
};

[[nodiscard]] inline StateKey key_of(const ToolSpaceKey& tool_space,
                                     const ConfigurationSummary& c) {
  return {tool_space, c.check_point, c.level};
}
[[nodiscard]] inline bool operator<(const StateKey& a, const StateKey& b) {
  return std::tie(a.tool_space, a.check_point, a.level) <
         std::tie(b.tool_space, b.check_point, b.level);
}
[[nodiscard]] inline bool operator==(const StateKey& a, const StateKey& b) {
  return a.tool_space == b.tool_space && a.check_point == b.check_point && a.level == b.level;
}

}  // namespace palpate
