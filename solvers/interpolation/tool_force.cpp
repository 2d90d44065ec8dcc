// SPDX-License-Identifier: BSD-3-Clause
#include "interpolation/tool_force.h"

#include <algorithm>
#include <utility>

#include "base/error.h"

namespace palpate {
namespace {

/// How far beside a cell its continuation goes over into what the configurations around say, in
/// sides of the cell.
constexpr double kGoesOver = 0.5;

}  // namespace

std::optional<RegionWeights> region_weights(const std::vector<const TouchToolSpace*>& tool_spaces) {
  std::vector<MeshRegion> regions;
  for (const TouchToolSpace* space : tool_spaces) {
    if (space->setup.region) regions.push_back(*space->setup.region);
  }
  if (tool_spaces.size() == 1 && regions.empty()) return std::nullopt;
  if (regions.size() < tool_spaces.size()) {
    throw InputError(
        "The state space has several tool spaces of a rigid tool, of which not all say which "
        "region of the organ they are for. Compute it again.");
  }
  return RegionWeights(regions);
}

ToolForce::ToolForce(const std::vector<const TouchToolSpace*>& tool_spaces, Method method,
                     const InterpolationOptions& options)
    : method_(method), options_(options), weights_(region_weights(tool_spaces)) {
  for (const TouchToolSpace* space : tool_spaces) {
    parts_.push_back({space->setup.key(), make_interpolator(method, *space, options)});
  }
  make_near_states(*tool_spaces.front());
}

ToolForce::ToolForce(const ToolForce& before, const std::vector<const TouchToolSpace*>& tool_spaces,
                     const ToolSpaceKey& grown, const std::vector<CheckPoint>& changed)
    : method_(before.method_), options_(before.options_), weights_(region_weights(tool_spaces)) {
  for (const TouchToolSpace* space : tool_spaces) {
    const ToolSpaceKey key = space->setup.key();
    const auto known = std::find_if(before.parts_.begin(), before.parts_.end(),
                                    [&](const Part& part) { return part.key == key; });
    const bool is_known = known != before.parts_.end();
    if (is_known && !(key == grown)) {
      parts_.push_back(*known);
      continue;
    }
    parts_.push_back({key, make_interpolator(method_, *space, options_,
                                             is_known ? known->force.get() : nullptr, changed)});
  }
  make_near_states(*tool_spaces.front());
}

void ToolForce::make_near_states(const TouchToolSpace& tool_space) {
  if (weights_ || !(options_.reach_of_states > 0)) return;
  near_ = std::make_shared<const NearStates>(tool_space.configurations, options_.reach_of_states);
}

TouchResult ToolForce::evaluate_only(const Vec3& x) const noexcept {
  const Interpolator& only = *parts_.front().force;
  if (near_ == nullptr) return only.evaluate(x);
  const CheckPointGrid::Location at = only.locate(x);
  if (!near_->serves(at, x)) return only.evaluate(x);
  const TouchResult expanded = near_->evaluate(x);
  if (at.place != CheckPointGrid::Place::beside_cell) return expanded;
  const double share = std::min(1.0, at.offset.norm() / (kGoesOver * only.cell_side(at)));
  if (share >= 1) return expanded;
  TouchResult sum = TouchResult::empty_sum();
  sum.add(share, expanded);
  sum.add(1 - share, only.evaluate(x));
  sum.support = Support::extrapolated;
  return sum;
}

TouchResult ToolForce::evaluate(const Vec3& x) const noexcept {
  if (!weights_) return evaluate_only(x);
  if (!x.allFinite()) return {};
  TouchResult sum = TouchResult::empty_sum();
  Vec3 of_transition = Vec3::Zero();
  visit_parts(x, [&](const RegionWeights::Weight& w) {
    const TouchResult part = parts_[static_cast<std::size_t>(w.region)].force->evaluate(x);
    sum.add(w.value, part);
    const Mat3 turned = part.force * w.gradient.transpose();
    sum.stiffness += turned + turned.transpose() + part.energy * w.curvature;
    of_transition += part.energy * w.gradient;
  });
  sum.force += of_transition;
  if (sum.mesh_error.trust != MeshErrorTrust::none) sum.mesh_error.bound += of_transition.norm();
  return sum;
}

void ToolForce::add_memory(MemoryRanges& ranges) const {
  ranges.push_back({this, sizeof *this});
  palpate::add_memory(parts_, ranges);
  if (weights_) weights_->add_memory(ranges);
  for (const Part& part : parts_) part.force->add_memory(ranges);
  if (near_ != nullptr) {
    ranges.push_back({near_.get(), sizeof *near_});
    near_->add_memory(ranges);
  }
}

}  // namespace palpate
