// SPDX-License-Identifier: BSD-3-Clause
// Plans the refinements of a rigid tool's space, and knows where halving cells has not helped, as
// between the branches at a ridge.
#pragma once

#include <map>
#include <vector>

#include "interaction/tool_clearance.h"
#include "interpolation/error_estimate.h"

namespace palpate {

class HalvingHistory {
 public:
  /// @param reach That of the grid, see Grid::reach().
  explicit HalvingHistory(std::int32_t reach) : reach_(reach) {}

  /// As plan_refinement(), but a cell is not split for its error if it is half of one that was
  /// estimated before, and hardly better.
  [[nodiscard]] CellRefinement plan(const Grid& grid,
                                    const std::vector<ConfigurationSummary>& configurations,
                                    double tolerance, const ToolClearance& clearance) {
    CellRefinement refinement = plan_refinement(
        grid, configurations, tolerance, 1, [&](const Vec3& q) { return clearance.clearance(q); },
        [&](const CellEstimate& estimate) { return is_in_vain(estimate); });
    for (const CellEstimate& e : refinement.estimates) errors_[e.cell] = e.error;
    return refinement;
  }

 private:
  [[nodiscard]] bool is_in_vain(const CellEstimate& estimate) const {
    const auto before = errors_.find(parent_of(estimate.cell, reach_));
    return before != errors_.end() && !(estimate.error < kHalvingShrinks * before->second);
  }

  /// Halving a cell has helped if the error of the half is below this share of the cell's. Where
  /// the force is smooth, or contact begins, it falls to an eighth or less.
  static constexpr double kHalvingShrinks = 1.0 / 3;

  std::int32_t reach_;
  /// The error of the force in each cell that was estimated, also of cells that were split since,
  /// N.
  std::map<Cell, double> errors_;
};

}  // namespace palpate
