// SPDX-License-Identifier: BSD-3-Clause
// A body as the servo loop touches it: its surface at rest and, as far as the state space has them,
// the forces at each active node and the force on a rigid tool that presses anywhere.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "fields/space_chunk.h"
#include "haptic/touching/cut_sheet.h"
#include "haptic/touching/settings.h"
#include "interpolation/interpolator.h"
#include "interpolation/solution_branches.h"
#include "interpolation/tool_force.h"
#include "interpolation/torn_energy.h"
#include "mesh/surface_tree.h"
#include "state_space/touch_space.h"

namespace palpate {

struct TouchableOptions {
  Method method = Method::energy_hermite;
  InterpolationOptions interpolation;
};

/// A body that does not change once it is made. When its state space has grown, give the loop a new
/// one, which may share with it all that has not changed.
class Touchable {
 public:
  /// @throws InputError the space has no tool space, or a tool space cannot be interpolated with
  /// the method.
  explicit Touchable(const TouchSpace& space, const TouchableOptions& options = {});
  /// The body whose state space has taken a chunk.
  /// @param before The body before that, which need not outlive this one.
  /// @param space It has taken the chunk.
  Touchable(const Touchable& before, const TouchSpace& space, const SpaceChunk& chunk);

  struct Node {
    /// The node's number as a point of the mesh of its body.
    Index mesh_point = 0;
    BodyId body = kFirstBody;
    /// The point of the shown surface that is there; of another body than the first, the nearest
    /// one.
    Index surface_point = 0;
    Vec3 rest_position = Vec3::Zero();
    double tip_radius = 0;
    SolutionBranches branches;
    /// The force on each branch.
    std::vector<std::shared_ptr<const Interpolator>> on_branch;
    /// The force at each stage of the cut, if there is one.
    std::vector<std::shared_ptr<const Interpolator>> at_stage;
  };

  [[nodiscard]] const std::string& scene_hash() const { return scene_hash_; }
  [[nodiscard]] const SurfaceTree& surface() const { return *surface_; }
  [[nodiscard]] const std::vector<Node>& nodes() const { return nodes_; }
  /// How the energy goes on between the stages of the cut, if there is one. Then an active node is
  /// one that all stages have, and counts as one of the last stage.
  [[nodiscard]] const TornEnergy& torn() const { return torn_; }
  /// Where the cut of these stages is.
  [[nodiscard]] const CutSheet& sheet() const { return *sheet_; }
  /// The index in nodes() of a point of the surface; −1: the point is not active.
  [[nodiscard]] std::int32_t node_of_surface_point(Index point) const { return node_of_[point]; }
  /// The index in nodes() of a point of the mesh of a body; −1: the point is not active.
  /// @note Realtime-safe.
  [[nodiscard]] std::int32_t find(Index mesh_point, BodyId body = kFirstBody) const noexcept;
  /// The index in nodes() of the active node that is nearest to a point at rest; −1: there is none
  /// within `reach`, m.
  /// @note Realtime-safe.
  [[nodiscard]] std::int32_t nearest(const Vec3& point, double reach) const noexcept;
  /// The largest eigenvalue of the stiffness of any usable configuration, N/m.
  [[nodiscard]] double largest_stiffness() const { return largest_stiffness_; }
  /// The force on a rigid tool by its place; nullptr: the space is of active nodes alone.
  [[nodiscard]] const ToolForce* force_on_tool() const { return force_on_tool_.get(); }
  /// Half of the rigid tool's width, m; 0: there is no rigid tool.
  [[nodiscard]] double tool_half_width() const { return tool_half_width_; }
  /// The largest radius of the tip of any active node, m.
  [[nodiscard]] double largest_tip_radius() const { return largest_tip_radius_; }
  /// The memory that the body holds, so that it can be locked.
  [[nodiscard]] MemoryRanges memory() const;
  [[nodiscard]] std::size_t bytes() const { return total_bytes(memory()); }

 private:
  /// Makes the force on the rigid tool, from the one that is there if a tool space has grown.
  /// @param grown The key of that tool space. @param changed Where it has grown.
  void take_rigid(const TouchSpace& space, const ToolSpaceKey& grown,
                  const std::vector<CheckPoint>& changed);
  /// Makes the forces at an active node, from those that are there if its tool space has grown.
  /// @param space It has the tool space.
  /// @param changed Where it has grown.
  void take_node(const TouchToolSpace& tool_space, const TouchSpace& space,
                 const std::vector<CheckPoint>& changed);
  /// Gives an active node its forces at the stages of the cut.
  void take_stages(Node& node, const TouchSpace& space) const;
  /// The point of the shown surface that is nearest to a place.
  [[nodiscard]] Index nearest_shown(const Vec3& place) const;
  void take_stiffness(const std::vector<ConfigurationSummary>& configurations);

  TouchableOptions options_;
  std::string scene_hash_;
  TornEnergy torn_;
  /// Bodies that follow each other share these.
  std::shared_ptr<const CutSheet> sheet_;
  std::shared_ptr<const SurfaceTree> surface_;
  /// The nodes in the order of their bodies and mesh points.
  std::vector<Node> nodes_;
  std::vector<std::int32_t> node_of_;
  std::shared_ptr<const ToolForce> force_on_tool_;
  double tool_half_width_ = 0;
  double largest_stiffness_ = 0;
  double largest_tip_radius_ = 0;
};

/// The largest stiffness that a hand may feel of a body, N/m.
[[nodiscard]] double stiffest(const Touchable& body, const TouchSettings& settings);

}  // namespace palpate
