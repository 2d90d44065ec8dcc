// SPDX-License-Identifier: BSD-3-Clause
// The stiffness of the configurations, interpolated trilinearly. It is continuous, which the
// gradient of an interpolated force need not be.
#pragma once

#include <vector>

#include "interpolation/check_point_grid.h"

namespace palpate {

/// Immutable. It copies all that it needs but the grid.
class NodalStiffness {
 public:
  NodalStiffness(const CheckPointGrid& grid,
                 const std::vector<ConfigurationSummary>& configurations,
                 bool with_third_derivatives);

  /// Stiffness at a place in a leaf, N/m.
  /// @note Realtime-safe.
  [[nodiscard]] Mat3 at(const CellTree::Leaf& leaf, const Vec3& s) const noexcept;

  void add_memory(MemoryRanges& ranges) const { palpate::add_memory(nodes_, ranges); }

 private:
  std::vector<Mat3> nodes_;
};

}  // namespace palpate
