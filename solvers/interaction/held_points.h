// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <map>
#include <vector>

#include "interaction/interaction.h"

namespace palpate {

/// The points that a tool prescribes, without their coordinates.
[[nodiscard]] inline std::vector<Index> held_points(const Interaction& interaction) {
  std::vector<Index> points;
  for (const PrescribedPoint& p : interaction.prescribed_points()) points.push_back(p.point);
  return points;
}

/// Whether a tool is bonded to one point alone: its force tends to 0 as cells become smaller.
[[nodiscard]] inline bool holds_single_point(const Interaction& interaction) {
  std::map<Index, int> num_points;
  for (const PrescribedPoint& p : interaction.prescribed_points()) ++num_points[p.coordinate];
  return std::any_of(num_points.begin(), num_points.end(),
                     [](const auto& tool) { return tool.second == 1; });
}

}  // namespace palpate
