// SPDX-License-Identifier: BSD-3-Clause
#include "interpolation/tool_force.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "base/error.h"

namespace palpate {
namespace {

/// How far beside a cell its continuation goes over into what the configurations around say, in
/// sides of the cell.
constexpr double kGoesOver = 0.5;

/// The configurations of level 0.
std::vector<ConfigurationSummary> flat_part(const TouchToolSpace& tool_space) {
  std::vector<ConfigurationSummary> flat;
  std::copy_if(tool_space.configurations.begin(), tool_space.configurations.end(),
               std::back_inserter(flat),
               [](const ConfigurationSummary& c) { return c.level == 0; });
  return flat;
}

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
  if (!weights_) {
    take_only(*tool_spaces.front(), nullptr, {});
    return;
  }
  for (const TouchToolSpace* space : tool_spaces) {
    parts_.push_back({space->setup.key(), make_interpolator(method, *space, options)});
  }
}

ToolForce::ToolForce(const ToolForce& before, const std::vector<const TouchToolSpace*>& tool_spaces,
                     const ToolSpaceKey& grown, const std::vector<CheckPoint>& changed)
    : method_(before.method_), options_(before.options_), weights_(region_weights(tool_spaces)) {
  const auto known = [&](const ToolSpaceKey& key) {
    const auto part = std::find_if(before.parts_.begin(), before.parts_.end(),
                                   [&](const Part& one) { return one.key == key; });
    return part == before.parts_.end() ? nullptr : part->force;
  };
  if (!weights_) {
    const TouchToolSpace& only = *tool_spaces.front();
    take_only(only, only.setup.key() == grown ? &before : nullptr, changed);
    return;
  }
  for (const TouchToolSpace* space : tool_spaces) {
    const ToolSpaceKey key = space->setup.key();
    const std::shared_ptr<const Interpolator> earlier = known(key);
    if (earlier != nullptr && !(key == grown)) {
      parts_.push_back({key, earlier});
      continue;
    }
    parts_.push_back({key, make_interpolator(method_, *space, options_, earlier.get(), changed)});
  }
}

std::shared_ptr<const Interpolator> ToolForce::find_on_branch(
    const std::vector<Member>& members, const std::vector<CheckPoint>& changed) const {
  const auto same = std::find(members_.begin(), members_.end(), members);
  if (same == members_.end()) return nullptr;
  const bool is_changed = std::any_of(members.begin(), members.end(), [&](const Member& member) {
    return std::find(changed.begin(), changed.end(), member.first) != changed.end();
  });
  if (is_changed) return nullptr;
  const auto branch = static_cast<std::size_t>(same - members_.begin());
  return branch == 0 ? parts_.front().force : on_further_branch_[branch - 1];
}

void ToolForce::take_only(const TouchToolSpace& tool_space, const ToolForce* before,
                          const std::vector<CheckPoint>& changed) {
  const ToolSpaceKey key = tool_space.setup.key();
  auto branches = std::make_shared<const SolutionBranches>(tool_space);
  has_levels_ = std::any_of(tool_space.configurations.begin(), tool_space.configurations.end(),
                            [](const ConfigurationSummary& c) { return c.level != 0; });
  is_whole_ = !has_levels_ && branches->is_one_whole();
  // When the first level or end is found, the flags of others change, see restricted().
  const bool grows =
      before != nullptr && before->has_levels_ == has_levels_ && before->is_whole_ == is_whole_;
  const Interpolator* flat = grows ? before->parts_.front().force.get() : nullptr;
  if (is_whole_) {
    parts_.push_back({key, make_interpolator(method_, tool_space, options_, flat, changed)});
  } else {
    for (int branch = 0; branch < branches->size(); ++branch) {
      const TouchToolSpace part = on_branch(tool_space, *branches, branch);
      std::vector<Member>& members = members_.emplace_back();
      for (const ConfigurationSummary& c : part.configurations) {
        members.emplace_back(c.check_point, c.level);
      }
      // The first branch has all configurations of level 0, and loses none.
      if (branch == 0) {
        parts_.push_back({key, make_interpolator(method_, part, options_, flat, changed)});
        continue;
      }
      auto force = grows ? before->find_on_branch(members, changed) : nullptr;
      if (force == nullptr) force = make_interpolator(method_, part, options_);
      on_further_branch_.push_back(std::move(force));
    }
    if (!branches->is_one_whole()) branches_ = std::move(branches);
  }
  if (!(options_.reach_of_states > 0)) return;
  near_ =
      has_levels_
          ? std::make_shared<const NearStates>(flat_part(tool_space), options_.reach_of_states)
          : std::make_shared<const NearStates>(tool_space.configurations, options_.reach_of_states);
}

int ToolForce::branch_from_outside(const Vec3& x) const {
  if (branches_ == nullptr) return 0;
  int most = -1;
  int best = 0;
  for (int branch = 0; branch < num_branches(); ++branch) {
    const CheckPointGrid& grid = on(branch).grid();
    const CheckPointGrid::Location here = grid.locate(x);
    if (here.place != CheckPointGrid::Place::cell || !grid.is_complete(here.leaf)) continue;
    int flat = 0;
    for (const std::int32_t node : grid.leaf(here.leaf).corners) {
      flat += members_[branch][grid.configuration(node)].second == 0 ? 1 : 0;
    }
    if (flat <= most) continue;
    most = flat;
    best = branch;
  }
  return best;
}

TouchResult ToolForce::evaluate_only(const Vec3& x, const OnBranch& branch) const noexcept {
  const Interpolator& only = on(branch.number);
  const bool may_be_on_another =
      branches_ != nullptr && (branch.left >= 0 || branches_->ends_at(branch.number, x));
  if (may_be_on_another) {
    TouchResult result = only.evaluate(x);
    if (result.support == Support::inside) result.support = Support::marked;
    return result;
  }
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

TouchResult ToolForce::evaluate(const Vec3& x, const OnBranch& branch) const noexcept {
  if (!weights_) return evaluate_only(x, branch);
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
  for (const auto& force : on_further_branch_) force->add_memory(ranges);
  palpate::add_memory(on_further_branch_, ranges);
  if (branches_ != nullptr) {
    ranges.push_back({branches_.get(), sizeof *branches_});
    branches_->add_memory(ranges);
  }
  if (near_ != nullptr) {
    ranges.push_back({near_.get(), sizeof *near_});
    near_->add_memory(ranges);
  }
}

}  // namespace palpate
