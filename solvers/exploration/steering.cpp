// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/steering.h"

#include <algorithm>
#include <limits>

namespace palpate {

bool Steering::has_goals() const {
  return std::any_of(spaces.begin(), spaces.end(),
                     [](const OfSpace& space) { return !space.goals.empty(); });
}

bool Steering::withdraws(ToolSpaceKey tool_space, const CheckPoint& target) const {
  const OfSpace* space = find(tool_space);
  return space != nullptr &&
         std::any_of(space->withdrawn.begin(), space->withdrawn.end(),
                     [&](const CheckPointBox& box) { return box.contains(target); });
}

double Steering::distance(const ToolSpaceSetup& setup, const CheckPoint& target) const {
  double least = std::numeric_limits<double>::infinity();
  const OfSpace* space = find(setup.key());
  if (space == nullptr) return least;
  const Vec3 place = setup.grid.place(target);
  for (const Vec3& goal : space->goals) least = std::min(least, (goal - place).norm());
  return least;
}

const Steering::OfSpace* Steering::find(ToolSpaceKey tool_space) const {
  const auto found = std::find_if(spaces.begin(), spaces.end(), [&](const OfSpace& space) {
    return space.tool_space == tool_space;
  });
  return found != spaces.end() ? &*found : nullptr;
}

std::vector<CheckPointBox> outside_of(const CheckPointBox& box, const Grid& grid) {
  std::vector<CheckPointBox> boxes;
  const std::int32_t reach = grid.reach();
  CheckPointBox left{{-reach, -reach, -reach}, {reach, reach, reach}};
  for (int axis = 0; axis < 3; ++axis) {
    CheckPointBox before = left;
    before.last[axis] = box.first[axis] - 1;
    CheckPointBox after = left;
    after.first[axis] = box.last[axis] + 1;
    for (const CheckPointBox& part : {before, after}) {
      if (part.first[axis] <= part.last[axis]) boxes.push_back(part);
    }
    left.first[axis] = std::max(left.first[axis], box.first[axis]);
    left.last[axis] = std::min(left.last[axis], box.last[axis]);
  }
  return boxes;
}

}  // namespace palpate
