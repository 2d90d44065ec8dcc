// SPDX-License-Identifier: BSD-3-Clause
#include "interpolation/trilinear.h"

namespace palpate {

Trilinear::Trilinear(const TouchSite& site)
    : Interpolator(site), nodes_(static_cast<std::size_t>(grid().num_nodes())) {
  for (std::int32_t n = 0; n < grid().num_nodes(); ++n) {
    if (!grid().usable(n)) continue;
    const ConfigurationSummary& c = site.configurations[grid().configuration(n)];
    nodes_[n].values << c.force, c.energy;
    nodes_[n].stiffness = c.stiffness;
  }
  for (const CheckPointGrid::HangingNode& hanging : grid().hanging_nodes()) {
    const TouchResult r = do_evaluate_border(grid().leaf(hanging.leaf), hanging.s);
    nodes_[hanging.node].values << r.force, r.energy;
    nodes_[hanging.node].stiffness = r.stiffness;
  }
}

TouchResult Trilinear::do_evaluate(const CellTree::Leaf& leaf, const Vec3& s) const noexcept {
  using Values = Eigen::Vector4d;
  // So written a corner is met exactly.
  const auto between = [](const Values& a, const Values& b, double at) -> Values {
    return (1 - at) * a + at * b;
  };
  Values along_yz[2];
  Values slope_y[2];
  Values slope_z[2];
  for (int x = 0; x < 2; ++x) {
    const auto corner = [&](int yz) -> const Values& {
      return nodes_[leaf.corners[4 * x + yz]].values;
    };
    const Values along_z[2] = {between(corner(0), corner(1), s[2]),
                               between(corner(2), corner(3), s[2])};
    along_yz[x] = between(along_z[0], along_z[1], s[1]);
    slope_y[x] = along_z[1] - along_z[0];
    slope_z[x] = between(corner(1) - corner(0), corner(3) - corner(2), s[1]);
  }
  const Values values = between(along_yz[0], along_yz[1], s[0]);
  const double per_side = 1 / (leaf.cell.side * grid().spacing());
  TouchResult result;
  result.force = values.head<3>();
  result.energy = values[3];
  result.stiffness << per_side * (along_yz[1] - along_yz[0]).head<3>(),
      per_side * between(slope_y[0], slope_y[1], s[0]).head<3>(),
      per_side * between(slope_z[0], slope_z[1], s[0]).head<3>();
  return result;
}

TouchResult Trilinear::do_evaluate_border(const CellTree::Leaf& leaf,
                                          const Vec3& s) const noexcept {
  TouchResult result;
  for (int corner = 0; corner < 8; ++corner) {
    const double weight = corner_weight(corner, s);
    const Node& node = nodes_[leaf.corners[corner]];
    result.force += weight * node.values.head<3>();
    result.energy += weight * node.values[3];
    result.stiffness += weight * node.stiffness;
  }
  return result;
}

TouchResult Trilinear::do_check_point(std::int32_t node) const noexcept {
  TouchResult result;
  result.force = nodes_[node].values.head<3>();
  result.energy = nodes_[node].values[3];
  result.stiffness = nodes_[node].stiffness;
  return result;
}

}  // namespace palpate
