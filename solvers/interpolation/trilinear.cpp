// SPDX-License-Identifier: BSD-3-Clause
#include "interpolation/trilinear.h"

namespace palpate {

Trilinear::Trilinear(const TouchSite& site)
    : Interpolator(site), nodes_(static_cast<std::size_t>(grid().num_nodes())) {
  for (std::int32_t n = 0; n < grid().num_nodes(); ++n) {
    if (!grid().usable(n)) continue;
    const ConfigurationSummary& c = site.configurations[grid().configuration(n)];
    nodes_[n] = {c.force, c.energy, c.stiffness};
  }
}

TouchResult Trilinear::do_evaluate(std::int32_t first, const Vec3& s) const noexcept {
  TouchResult result;
  for (int corner = 0; corner < 8; ++corner) {
    const int bit[3] = {corner >> 2, (corner >> 1) & 1, corner & 1};
    std::int32_t n = first;
    double w[3];
    double slope[3];
    for (int k = 0; k < 3; ++k) {
      n += bit[k] * grid().stride(k);
      w[k] = bit[k] != 0 ? s[k] : 1 - s[k];
      slope[k] = bit[k] != 0 ? 1 : -1;
    }
    const Node& node = nodes_[n];
    const double weight = w[0] * w[1] * w[2];
    result.energy += weight * node.energy;
    result.force += weight * node.force;
    result.stiffness.col(0) += slope[0] * w[1] * w[2] * node.force;
    result.stiffness.col(1) += w[0] * slope[1] * w[2] * node.force;
    result.stiffness.col(2) += w[0] * w[1] * slope[2] * node.force;
  }
  result.stiffness /= grid().spacing();
  return result;
}

TouchResult Trilinear::do_evaluate_border(std::int32_t first, const Vec3& s) const noexcept {
  TouchResult result;
  for (int corner = 0; corner < 8; ++corner) {
    const int bit[3] = {corner >> 2, (corner >> 1) & 1, corner & 1};
    std::int32_t n = first;
    double weight = 1;
    for (int k = 0; k < 3; ++k) {
      n += bit[k] * grid().stride(k);
      weight *= bit[k] != 0 ? s[k] : 1 - s[k];
    }
    const Node& node = nodes_[n];
    result.energy += weight * node.energy;
    result.force += weight * node.force;
    result.stiffness += weight * node.stiffness;
  }
  return result;
}

TouchResult Trilinear::do_check_point(std::int32_t node) const noexcept {
  TouchResult result;
  result.force = nodes_[node].force;
  result.energy = nodes_[node].energy;
  result.stiffness = nodes_[node].stiffness;
  return result;
}

}  // namespace palpate
