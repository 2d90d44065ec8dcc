// SPDX-License-Identifier: BSD-3-Clause
// The fields of what the ranks of a run have found are reduced on all of them: region by region,
// each rank another region, so that the end of a run scales as the run. The other ranks send it
// what they have of its region, a batch at a time, so that no rank has more than a batch of fields
// in memory.
//
// A region is an active node, or where a rigid tool presses a whole organ a cell of an octree of
// check-points. The result is the same on any number of ranks.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <vector>

#include "schedule/communicator.h"
#include "state_space/packed_basis.h"
#include "state_space/tool_space.h"

namespace palpate {

/// Configurations that have a basis together: those in a box of check-points.
struct ReductionRegion {
  ToolSpaceId tool_space = 0;
  /// Of the basis, among those of the tool space.
  std::int64_t number = 0;
  CheckPointBox box;
  /// See Grid::field_step().
  double step = 1;
  /// On rank 0: the basis that is there already, which is extended; null: there is none.
  std::shared_ptr<const FieldBasis> begin;
};

/// The states of all ranks, and the lowest rank that has the fields of each.
using StateHolders = std::map<StateKey, int>;

/// @param own The states whose fields are here.
/// @note Collective
[[nodiscard]] StateHolders find_holders(const std::vector<StateKey>& own,
                                        Communicator& communicator);

/// What is reduced, and how. But for `load` and the bases in the regions it is the same on all
/// ranks.
struct ReductionTask {
  std::vector<ReductionRegion> regions;
  StateHolders holders;
  /// Gives the fields of a state that is here.
  std::function<Configuration(const StateKey&)> load;
  Keep keep = Keep::touch;
  /// As kept_points() gives them for `keep`.
  std::vector<Index> points;
  /// That are kept.
  Eigen::Index num_pressures = 0;
  /// See FieldReducer.
  double bound = kDefaultTouchBound;
};

/// Cuts the check-points of a tool space into regions.
/// @param keys Its states on all ranks that are to be reduced.
/// @param there Boxes that are there already: what is in one of them stays there, and they come
///   first.
[[nodiscard]] std::vector<ReductionRegion> plan_regions(const ToolSpaceSetup& setup,
                                                        const std::vector<StateKey>& keys,
                                                        const std::vector<ReductionRegion>& there);

/// Takes a region that is reduced, with its states in the order of their fields.
using TakeReduction =
    std::function<void(const ReductionRegion&, const std::vector<StateKey>&, PackedReduction)>;

/// Reduces the regions that have states.
/// @param take It is called on rank 0, region by region in their order.
/// @note Collective. What a rank throws is thrown on all.
void reduce_on_ranks(const ReductionTask& task, Communicator& communicator,
                     const TakeReduction& take);

}  // namespace palpate
