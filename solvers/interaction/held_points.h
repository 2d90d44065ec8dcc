// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "interaction/interaction.h"

namespace palpate {

/// The points that a tool prescribes, without their coordinates.
[[nodiscard]] inline std::vector<Index> held_points(const Interaction& interaction) {
  std::vector<Index> points;
  for (const PrescribedPoint& p : interaction.prescribed_points()) points.push_back(p.point);
  return points;
}

}  // namespace palpate
