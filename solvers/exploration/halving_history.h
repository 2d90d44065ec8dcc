// SPDX-License-Identifier: BSD-3-Clause
// Tells where halving cells does not help, as between the branches at a ridge.
#pragma once

#include <map>
#include <vector>

#include "interpolation/error_estimate.h"

namespace palpate {

class HalvingHistory {
 public:
  /// @param reach That of the grid, see Grid::reach().
  explicit HalvingHistory(std::int32_t reach) : reach_(reach) {}

  /// Takes estimates of cells, also of cells that are split later.
  void take(const std::vector<CellEstimate>& estimates) {
    for (const CellEstimate& estimate : estimates) errors_[estimate.cell] = estimate.error;
  }
  /// Whether the cell is half of one that was estimated, and hardly better.
  [[nodiscard]] bool is_in_vain(const CellEstimate& estimate) const {
    const auto before = errors_.find(parent_of(estimate.cell, reach_));
    return before != errors_.end() && !(estimate.error < kHalvingShrinks * before->second);
  }

 private:
  /// Halving a cell has helped if the error of the half is below this share of the cell's. Where
  /// the force is smooth, or contact begins, it falls to an eighth or less.
  static constexpr double kHalvingShrinks = 1.0 / 3;

  std::int32_t reach_;
  /// The error of the force in each cell, N.
  std::map<Cell, double> errors_;
};

}  // namespace palpate
