// SPDX-License-Identifier: BSD-3-Clause
#include "interpolation/extrapolated_node.h"

namespace palpate {

NodeData node_data(const CheckPointGrid& grid,
                   const std::vector<ConfigurationSummary>& configurations, std::int32_t node,
                   bool with_third_derivatives) {
  if (grid.is_free(node)) {
    NodeData nothing;
    nothing.third_derivative.setZero();
    return nothing;
  }
  const std::int32_t nearest = grid.nearest(node);
  const ConfigurationSummary& c = configurations[grid.configuration(nearest)];
  NodeData data;
  data.energy = c.energy;
  data.force = c.force;
  data.stiffness = c.stiffness;
  // Where elements invert or a path folds, third derivatives say nothing about a node one spacing
  // away.
  const bool has_third =
      with_third_derivatives && c.has_third_derivative() && !grid.is_marking(nearest);
  if (has_third) data.third_derivative = c.third_derivative;
  if (nearest == node) return data;

  const CheckPoint to = grid.tree().point(node);
  const CheckPoint from = grid.tree().point(nearest);
  const Vec3 offset = grid.spacing() * Vec3(to[0] - from[0], to[1] - from[1], to[2] - from[2]);
  Mat3 change = Mat3::Zero();
  if (has_third) change = times(c.third_derivative, offset);
  data.energy += offset.dot(c.force + (0.5 * c.stiffness + change / 6) * offset);
  data.force += (c.stiffness + 0.5 * change) * offset;
  data.stiffness += change;
  return data;
}

}  // namespace palpate
