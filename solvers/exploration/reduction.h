// SPDX-License-Identifier: BSD-3-Clause
// The fields that the ranks have found are reduced to modes, on all ranks: region by region, each
// rank another region, so that this step scales as the run does. The other ranks send it their
// fields of its region, a batch at a time, so that no rank has more than a batch of fields in
// memory.
//
// A region is the space of an active node. The space of a rigid tool, which may press a whole
// organ, has a region for each cell of an octree of check-points. The result does not depend on the
// number of ranks.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <vector>

#include "fields/packed_basis.h"
#include "schedule/communicator.h"
#include "state_space/tool_space.h"

namespace palpate {

/// Configurations that share a basis: those in a box of check-points.
struct ReductionRegion {
  ToolSpaceKey tool_space;
  /// The number of the basis within the tool space.
  std::int64_t number = 0;
  CheckPointBox box;
  /// See Grid::field_step().
  double step = 1;
  /// On rank 0: an existing basis, which is extended; null: there is none.
  std::shared_ptr<const FieldBasis> begin;
};

/// The states of all ranks, and the lowest rank that has the fields of each.
using StateHolders = std::map<StateKey, int>;

/// @param own The states whose fields are here.
/// @note Collective
[[nodiscard]] StateHolders find_holders(const std::vector<StateKey>& own,
                                        Communicator& communicator);

/// The fields that are reduced, and how. It is the same on all ranks, but for `load` and for the
/// bases in the regions.
struct ReductionTask {
  std::vector<ReductionRegion> regions;
  StateHolders holders;
  /// Reads the fields of a state that this rank has.
  std::function<Configuration(const StateKey&)> load;
  Keep keep = Keep::touch;
  /// The points that kept_points() gives for `keep`.
  std::vector<Index> points;
  /// The number of pressures that are kept.
  Eigen::Index num_pressures = 0;
  /// See FieldReducer.
  double bound = kDefaultTouchBound;
};

/// Divides the check-points of a tool space into regions.
/// @param keys The states on all ranks that are to be reduced.
/// @param there Existing regions. They stay as they are and come first.
[[nodiscard]] std::vector<ReductionRegion> plan_regions(const ToolSpaceSetup& setup,
                                                        const std::vector<StateKey>& keys,
                                                        const std::vector<ReductionRegion>& there);

/// Takes a reduced region, with its states in the order of their fields.
using TakeReduction =
    std::function<void(const ReductionRegion&, const std::vector<StateKey>&, PackedReduction)>;

/// Reduces the regions that have states.
/// @param take Called on rank 0 for each region, in their order.
/// @note Collective. An exception of one rank is thrown on all.
void reduce_on_ranks(const ReductionTask& task, Communicator& communicator,
                     const TakeReduction& take);

}  // namespace palpate
