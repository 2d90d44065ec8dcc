// SPDX-License-Identifier: BSD-3-Clause
#include "interpolation/nodal_stiffness.h"

#include "interpolation/extrapolated_node.h"

namespace palpate {

NodalStiffness::NodalStiffness(const CheckPointGrid& grid,
                               const std::vector<ConfigurationSummary>& configurations,
                               bool with_third_derivatives) {
  if (!grid.any_usable()) return;
  for (std::int32_t n = 0; n < grid.num_nodes(); ++n) {
    nodes_.push_back(node_data(grid, configurations, n, with_third_derivatives).stiffness);
  }
  for (const CheckPointGrid::HangingNode& hanging : grid.hanging_nodes()) {
    nodes_[hanging.node] = at(grid.leaf(hanging.leaf), hanging.s);
  }
}

Mat3 NodalStiffness::at(const CellTree::Leaf& leaf, const Vec3& s) const noexcept {
  Mat3 stiffness = Mat3::Zero();
  for (int corner = 0; corner < 8; ++corner) {
    stiffness += corner_weight(corner, s) * nodes_[leaf.corners[corner]];
  }
  return stiffness;
}

}  // namespace palpate
