// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "base/types.h"

namespace palpate {

/// C of C u = t: each site is a point, or several that move as one.
struct Constraint {
  /// Points that are held.
  std::vector<Index> points;
  /// Site of each point, 0 … num_sites − 1.
  std::vector<Index> site_of_point;
  Index num_sites = 0;
};

/// Each node a site of its own.
[[nodiscard]] Constraint hold_nodes(const std::vector<Index>& nodes);

}  // namespace palpate
