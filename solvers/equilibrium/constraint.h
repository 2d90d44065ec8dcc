// SPDX-License-Identifier: BSD-3-Clause
// Which points of a body are held.
#pragma once

#include <vector>

#include "base/types.h"

namespace palpate {

/// The matrix C of C u = t: each site is a point, or several points that move as one.
struct Constraint {
  /// The points that are held.
  std::vector<Index> points;
  /// The site of each of these points, 0 … num_sites − 1.
  std::vector<Index> site_of_point;
  Index num_sites = 0;
};

/// A constraint in which each node is a site of its own.
[[nodiscard]] Constraint hold_nodes(const std::vector<Index>& nodes);

}  // namespace palpate
