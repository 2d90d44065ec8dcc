// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/touching/touchable.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <utility>

#include "base/error.h"

namespace palpate {
namespace {

bool is_before(const Touchable::Node& node, const std::pair<BodyId, Index>& other) {
  return std::pair(node.body, node.mesh_point) < other;
}

}  // namespace

Touchable::Touchable(const TouchSpace& space, const TouchableOptions& options)
    : options_(options),
      scene_hash_(space.scene_hash),
      surface_(std::make_shared<const SurfaceTree>(space.surface.points,
                                                   space.surface.touched_triangles())),
      node_of_(space.surface.points.size(), -1) {
  if (space.tool_spaces.empty()) {
    throw InputError(
        "The state space has no active node and no rigid tool: there is nothing to touch. "
        "Precompute it for one.");
  }
  if (!space.list_turned().empty()) {
    throw InputError(
        "The state space is that of a tool that is turned freely, which no device feels yet. Touch "
        "it with Touch State Space (ToolOrientation), or precompute a space with the Motion Trocar "
        "or Translated.");
  }
  if (space.stages.empty()) {
    sheet_ = std::make_shared<const CutSheet>();
  } else {
    torn_ = TornEnergy(space.areas_of_stages());
    sheet_ = std::make_shared<const CutSheet>(space.surface, torn_.areas());
  }
  nodes_.reserve(space.tool_spaces.size());
  for (const TouchToolSpace& tool_space : space.tool_spaces) {
    take_stiffness(tool_space.configurations);
    if (!tool_space.setup.presses()) take_node(tool_space, space, {});
  }
  take_rigid(space, {}, {});
}

Touchable::Touchable(const Touchable& before, const TouchSpace& space, const SpaceChunk& chunk)
    : Touchable(before) {
  for (const ToolSpaceChunk& part : chunk.tool_spaces) {
    take_stiffness(part.configurations);
    const std::vector<CheckPoint> changed = part.check_points();
    if (part.setup.presses()) {
      take_rigid(space, part.setup.key(), changed);
    } else {
      take_node(*space.find(part.setup.key()), space, changed);
    }
  }
}

void Touchable::take_stiffness(const std::vector<ConfigurationSummary>& configurations) {
  for (const ConfigurationSummary& configuration : configurations) {
    if (!configuration.usable() || !configuration.stiffness.allFinite()) continue;
    const Eigen::SelfAdjointEigenSolver<Mat3> eigen(configuration.stiffness,
                                                    Eigen::EigenvaluesOnly);
    largest_stiffness_ = std::max(largest_stiffness_, eigen.eigenvalues()[2]);
  }
}

void Touchable::take_rigid(const TouchSpace& space, const ToolSpaceKey& grown,
                           const std::vector<CheckPoint>& changed) {
  const std::vector<const TouchToolSpace*> pressing = space.list_pressing();
  if (pressing.empty()) return;
  force_on_tool_ =
      force_on_tool_ == nullptr
          ? std::make_shared<const ToolForce>(pressing, options_.method, options_.interpolation)
          : std::make_shared<const ToolForce>(*force_on_tool_, pressing, grown, changed);
  tool_half_width_ = pressing.front()->setup.interaction.touching_radius();
}

void Touchable::take_node(const TouchToolSpace& tool_space, const TouchSpace& space,
                          const std::vector<CheckPoint>& changed) {
  const Index mesh_point = tool_space.setup.interaction.active_node;
  const BodyId body = tool_space.setup.body;
  if (torn_.is_cut()) {
    // The last stage stands for all of them, once they are there.
    const std::vector<const TouchToolSpace*> stages = space.find_stages(tool_space.setup.id);
    if (stages.empty()) return;
    if (stages.back()->setup.body != body) return take_node(*stages.back(), space, {});
  }
  const Index surface_point = body == kFirstBody
                                  ? space.surface.find(mesh_point)
                                  : nearest_shown(tool_space.setup.interaction.material_point);
  if (surface_point < 0) {
    throw InputError("Active node " + std::to_string(mesh_point) +
                     " is not on the surface of the body: a tool cannot reach it.");
  }
  const std::int32_t known = find(mesh_point, body);
  SolutionBranches branches(tool_space);
  std::vector<std::shared_ptr<const Interpolator>> on_branch;
  for (int branch = 0; branch < branches.size(); ++branch) {
    if (branches.size() > 1) {
      on_branch.push_back(make_interpolator(options_.method,
                                            palpate::on_branch(tool_space, branches, branch),
                                            options_.interpolation));
      continue;
    }
    const bool grows = known >= 0 && nodes_[known].branches.size() == 1;
    on_branch.push_back(make_interpolator(options_.method, tool_space, options_.interpolation,
                                          grows ? nodes_[known].on_branch[0].get() : nullptr,
                                          changed));
  }
  Node node{mesh_point,
            body,
            surface_point,
            tool_space.setup.interaction.material_point,
            tool_space.setup.interaction.tip_radius,
            std::move(branches),
            std::move(on_branch),
            {}};
  take_stages(node, space);
  largest_tip_radius_ = std::max(largest_tip_radius_, node.tip_radius);
  if (known >= 0) {
    nodes_[known] = std::move(node);
    return;
  }
  const auto place =
      std::lower_bound(nodes_.begin(), nodes_.end(), std::pair(body, mesh_point), is_before);
  nodes_.insert(place, std::move(node));
  // Where nodes of several bodies are at one point, the first body has it.
  for (std::size_t n = nodes_.size(); n-- > 0;) {
    node_of_[nodes_[n].surface_point] = static_cast<std::int32_t>(n);
  }
}

void Touchable::take_stages(Node& node, const TouchSpace& space) const {
  for (const TouchToolSpace* stage : space.find_stages(node.mesh_point)) {
    node.at_stage.push_back(make_interpolator(options_.method, *stage, options_.interpolation));
  }
}

Index Touchable::nearest_shown(const Vec3& place) const {
  const SurfaceTree::Nearest nearest = surface_->nearest(place);
  if (nearest.triangle < 0) {
    throw InputError("An active node of the state space has no place. Compute the space again.");
  }
  Eigen::Index corner = 0;
  nearest.weights.maxCoeff(&corner);
  return surface_->points_of(nearest.triangle)[static_cast<std::size_t>(corner)];
}

std::int32_t Touchable::find(Index mesh_point, BodyId body) const noexcept {
  const auto found =
      std::lower_bound(nodes_.begin(), nodes_.end(), std::pair(body, mesh_point), is_before);
  return found != nodes_.end() && found->mesh_point == mesh_point && found->body == body
             ? static_cast<std::int32_t>(found - nodes_.begin())
             : -1;
}

std::int32_t Touchable::nearest(const Vec3& point, double reach) const noexcept {
  std::int32_t nearest = -1;
  double least = reach * reach;
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    const double squared = (nodes_[n].rest_position - point).squaredNorm();
    if (squared > least) continue;
    least = squared;
    nearest = static_cast<std::int32_t>(n);
  }
  return nearest;
}

double stiffest(const Touchable& body, const TouchSettings& settings) {
  return settings.is_blade ? std::max(body.largest_stiffness(), settings.blade_stiffness)
                           : body.largest_stiffness();
}

MemoryRanges Touchable::memory() const {
  MemoryRanges ranges{{this, sizeof *this}};
  ranges.push_back({surface_.get(), sizeof *surface_});
  surface_->add_memory(ranges);
  add_memory(nodes_, ranges);
  add_memory(node_of_, ranges);
  add_memory(torn_.areas(), ranges);
  ranges.push_back({sheet_.get(), sizeof *sheet_});
  sheet_->add_memory(ranges);
  for (const Node& node : nodes_) {
    node.branches.add_memory(ranges);
    add_memory(node.on_branch, ranges);
    for (const auto& force : node.on_branch) force->add_memory(ranges);
    add_memory(node.at_stage, ranges);
    for (const auto& force : node.at_stage) force->add_memory(ranges);
  }
  if (force_on_tool_) force_on_tool_->add_memory(ranges);
  return ranges;
}

}  // namespace palpate
