// SPDX-License-Identifier: BSD-3-Clause
#include "interpolation/trilinear.h"

#include "interpolation/extrapolated_node.h"

namespace palpate {

Trilinear::Trilinear(const TouchToolSpace& tool_space, const InterpolationOptions& options)
    : Interpolator(tool_space),
      stiffness_(grid(), tool_space.configurations, options.third_derivatives) {
  if (!grid().any_usable()) return;
  for (std::int32_t n = 0; n < grid().num_nodes(); ++n) {
    const NodeData data =
        node_data(grid(), tool_space.configurations, n, options.third_derivatives);
    nodes_.emplace_back() << data.force, data.energy;
  }
  for (const CheckPointGrid::HangingNode& hanging : grid().hanging_nodes()) {
    TouchResult there;
    in_leaf(grid().leaf(hanging.leaf), hanging.s, there);
    nodes_[hanging.node] << there.force, there.energy;
  }
}

void Trilinear::do_evaluate(const Location& at, TouchResult& result) const noexcept {
  in_leaf(grid().leaf(at.leaf), at.s, result);
}

void Trilinear::do_smooth_stiffness(const Location& at, Mat3& stiffness) const noexcept {
  stiffness = stiffness_.at(grid().leaf(at.leaf), at.s);
}

void Trilinear::in_leaf(const CellTree::Leaf& leaf, const Vec3& s,
                        TouchResult& result) const noexcept {
  // In this form, the value at a corner is exact.
  const auto between = [](const Values& a, const Values& b, double at) -> Values {
    return (1 - at) * a + at * b;
  };
  Values along_yz[2];
  Values slope_y[2];
  Values slope_z[2];
  for (int x = 0; x < 2; ++x) {
    const auto corner = [&](int yz) -> const Values& { return nodes_[leaf.corners[4 * x + yz]]; };
    const Values along_z[2] = {between(corner(0), corner(1), s[2]),
                               between(corner(2), corner(3), s[2])};
    along_yz[x] = between(along_z[0], along_z[1], s[1]);
    slope_y[x] = along_z[1] - along_z[0];
    slope_z[x] = between(corner(1) - corner(0), corner(3) - corner(2), s[1]);
  }
  const Values values = between(along_yz[0], along_yz[1], s[0]);
  const double per_side = 1 / (leaf.cell.side * grid().spacing());
  result.force = values.head<3>();
  result.energy = values[3];
  result.stiffness << per_side * (along_yz[1] - along_yz[0]).head<3>(),
      per_side * between(slope_y[0], slope_y[1], s[0]).head<3>(),
      per_side * between(slope_z[0], slope_z[1], s[0]).head<3>();
}

}  // namespace palpate
