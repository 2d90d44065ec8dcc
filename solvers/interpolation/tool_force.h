// SPDX-License-Identifier: BSD-3-Clause
// The force on a rigid tool, wherever it presses. Where the organ is divided into regions with
// meshes of their own, the energies of the tool spaces around a place are blended,
//
//   Π(x) = Σ W_i Π_i,   h = Σ (W_i h_i + Π_i ∇W_i)
//
// with the weights of region_weights.h. So the force is the gradient of one energy everywhere: it
// has no jump between two regions, and does no work around a closed loop. Π_i ∇W_i comes from the
// difference of two meshes alone. It is counted in the bound of the error of the mesh.
//
// Where a neighbour has no cell, as in a space that is not complete, its part of the band belongs
// to the others: the force has a step there, as at any border of what is known.
//
// A space without regions may have levels (solution_branches.h): the force is that of the branch on
// which the body is, so the caller says which one, and follows it where the tool moves. In the cell
// within which its branch has ended, the support is `marked`: where the body leaves the branch is
// not known better.
//
// On request, in a space without regions, the force where there is no cell comes from single
// configurations around (near_states.h). Within half a cell beside a cell it goes over into that.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "interpolation/interpolator.h"
#include "interpolation/near_states.h"
#include "interpolation/region_weights.h"
#include "interpolation/solution_branches.h"

namespace palpate {

/// Immutable.
class ToolForce {
 public:
  /// @param tool_spaces Those of a rigid tool: one, or one for each region.
  /// @throws InputError as make_interpolator() and RegionWeights do; several tool spaces of which
  ///   one has no region.
  ToolForce(const std::vector<const TouchToolSpace*>& tool_spaces, Method method,
            const InterpolationOptions& options = {});
  /// The force after configurations were added to a tool space, which may be a new one.
  /// @param tool_spaces As above, all of them. @param grown The key of the one that has grown.
  /// @param changed The check-points of these configurations.
  ToolForce(const ToolForce& before, const std::vector<const TouchToolSpace*>& tool_spaces,
            const ToolSpaceKey& grown, const std::vector<CheckPoint>& changed);

  /// @param branch The branch that the body is on, see move().
  /// @note Realtime-safe.
  [[nodiscard]] TouchResult evaluate(const Vec3& x, const OnBranch& branch = {}) const noexcept;

  /// The number of branches, at least one. Where the tool touches nothing, the body is on branch 0.
  [[nodiscard]] int num_branches() const { return branches_ == nullptr ? 1 : branches_->size(); }
  /// The branch that the body is on after the tool was moved straight from one place to another.
  /// @param branch The branch at the start.
  /// @note Realtime-safe.
  [[nodiscard]] OnBranch move(const OnBranch& branch, const Vec3& from,
                              const Vec3& to) const noexcept {
    return branches_ == nullptr ? OnBranch() : branches_->move(branch, from, to);
  }
  /// The branch of a tool that has come from outside along the normal of the surface: that with the
  /// most configurations of level 0 around a place.
  [[nodiscard]] int branch_from_outside(const Vec3& x) const;
  /// nullptr: there is one branch.
  [[nodiscard]] const SolutionBranches* branches() const { return branches_.get(); }

  /// The force by the tool space that has the most weight at a place. That alone tells where the
  /// place lies among the check-points: neighbouring regions reach across their band.
  /// @note Realtime-safe.
  [[nodiscard]] const Interpolator& at(const Vec3& x, int branch = 0) const noexcept {
    if (branches_ != nullptr) return on(branch);
    std::size_t leading = 0;
    double most = 0;
    visit_weights(x, [&](std::size_t part, double weight) {
      if (weight <= most) return;
      most = weight;
      leading = part;
    });
    return *parts_[leading].force;
  }
  /// Whether a place is in a cell of the space.
  /// @note Realtime-safe.
  [[nodiscard]] bool has_cell(const Vec3& x, int branch = 0) const noexcept {
    return at(x, branch).locate(x).place == CheckPointGrid::Place::cell;
  }

  /// Whether a place is in no cell, and its force comes from configurations around.
  /// @note Realtime-safe.
  [[nodiscard]] bool expands(const Vec3& x) const noexcept {
    return near_ != nullptr && near_->serves(parts_.front().force->locate(x), x);
  }
  /// The configurations around; nullptr: they are not used.
  [[nodiscard]] const NearStates* near_states() const { return near_.get(); }

  /// Calls visit(part, weight) for each of the tool spaces that have a weight at a place: its
  /// number in the list that the constructor was given.
  /// @note Realtime-safe.
  template <class Visit>
  void visit_weights(const Vec3& x, Visit&& visit) const noexcept {
    visit_parts(x, [&](const RegionWeights::Weight& w) {
      visit(static_cast<std::size_t>(w.region), w.value);
    });
  }
  /// The force by one of the tool spaces alone.
  [[nodiscard]] const Interpolator& part(std::size_t number) const { return *parts_[number].force; }
  /// The force on one of the branches.
  [[nodiscard]] const Interpolator& on(int branch) const noexcept {
    return branch == 0 ? *parts_.front().force
                       : *on_further_branch_[static_cast<std::size_t>(branch) - 1];
  }
  [[nodiscard]] std::size_t size() const { return parts_.size(); }
  /// Distance of neighbouring check-points, m.
  [[nodiscard]] double spacing() const noexcept { return parts_.front().force->spacing(); }
  void add_memory(MemoryRanges& ranges) const;

 private:
  /// Makes the force of a space that is for the whole organ.
  /// @param before The force before the space has grown; null: there is none.
  void take_only(const TouchToolSpace& tool_space, const ToolForce* before,
                 const std::vector<CheckPoint>& changed);
  /// A configuration of a branch, by its check-point and level.
  using Member = std::pair<CheckPoint, std::int32_t>;
  /// The force on the further branch that has the same configurations; null: there is none, or some
  /// of them have changed.
  [[nodiscard]] std::shared_ptr<const Interpolator> find_on_branch(
      const std::vector<Member>& members, const std::vector<CheckPoint>& changed) const;
  /// The force where there is one tool space.
  [[nodiscard]] TouchResult evaluate_only(const Vec3& x, const OnBranch& branch) const noexcept;

  struct Part {
    ToolSpaceKey key;
    std::shared_ptr<const Interpolator> force;
  };

  /// Whether the space of a part has a cell at a place, or knows that nothing is touched there.
  [[nodiscard]] bool knows(int part, const Vec3& x) const noexcept {
    using Place = CheckPointGrid::Place;
    const Place place = parts_[static_cast<std::size_t>(part)].force->locate(x).place;
    return place == Place::cell || place == Place::free;
  }
  /// Calls visit(weight) for each part that has a weight at a place. If some of them know the
  /// place, the others, which would continue from far away, are left out: the region of a space
  /// that is not complete yet ends there, and its neighbour has all the weight.
  template <class Visit>
  void visit_parts(const Vec3& x, Visit&& visit) const noexcept {
    if (!weights_) {
      RegionWeights::Weight whole;
      whole.value = 1;
      visit(whole);
      return;
    }
    bool is_any = false;
    bool are_all = true;
    weights_->visit(x, [&](const RegionWeights::Weight& w) {
      const bool is_known = knows(w.region, x);
      is_any = is_any || is_known;
      are_all = are_all && is_known;
    });
    if (are_all || !is_any) {
      weights_->visit(x, visit);
    } else {
      weights_->visit(
          x, [&](int part) { return knows(part, x); }, visit);
    }
  }

  Method method_;
  InterpolationOptions options_;
  /// In the order of the tool spaces.
  std::vector<Part> parts_;
  /// Nothing: there is one tool space, for the whole organ.
  std::optional<RegionWeights> weights_;
  std::shared_ptr<const NearStates> near_;
  /// null: there is one branch.
  std::shared_ptr<const SolutionBranches> branches_;
  std::vector<std::shared_ptr<const Interpolator>> on_further_branch_;
  /// Whether a space for the whole organ has configurations of levels above 0.
  bool has_levels_ = false;
  /// Whether it has none, and one branch that ends nowhere.
  bool is_whole_ = true;
  /// Of each branch, if there are levels or several branches, in the order of its configurations.
  std::vector<std::vector<Member>> members_;
};

/// The weights of tool spaces of a rigid tool; nothing where there is one, for the whole organ.
/// @throws InputError as RegionWeights; several tool spaces of which one has no region.
[[nodiscard]] std::optional<RegionWeights> region_weights(
    const std::vector<const TouchToolSpace*>& tool_spaces);

}  // namespace palpate
