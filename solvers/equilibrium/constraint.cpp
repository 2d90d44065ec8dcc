// SPDX-License-Identifier: BSD-3-Clause
#include "equilibrium/constraint.h"

#include <numeric>

namespace palpate {

Constraint hold_nodes(const std::vector<Index>& nodes) {
  Constraint constraint;
  constraint.points = nodes;
  constraint.site_of_point.resize(nodes.size());
  std::iota(constraint.site_of_point.begin(), constraint.site_of_point.end(), 0);
  constraint.num_sites = static_cast<Index>(nodes.size());
  return constraint;
}

}  // namespace palpate
