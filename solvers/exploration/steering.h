// SPDX-License-Identifier: BSD-3-Clause
// Steering of an exploration while it runs: which transitions come first, and which are not made
// for now. It changes when a configuration is found, and whether it is, but never what is found.
// Nobody needs to steer.
//
// All ranks follow the latest steering, which any rank may give. As it describes the whole, and
// not a change, messages that overtake each other do no harm.
#pragma once

#include <vector>

#include "state_space/tool_space.h"

namespace palpate {

struct Steering {
  /// The steering of one tool space.
  struct OfSpace {
    ToolSpaceKey tool_space;
    /// Coordinates of the tool [3], m. The target nearest to any of them is made first. While a
    /// tool space has a goal, targets of those without goals come last.
    std::vector<Vec3> goals;
    /// Targets in these boxes are withdrawn: they are not made while the steering says so, and
    /// neither is what follows from them. They are neither found nor failed. A transition that is
    /// being made is completed.
    std::vector<CheckPointBox> withdrawn;
  };
  std::vector<OfSpace> spaces;

  [[nodiscard]] bool has_goals() const;
  [[nodiscard]] bool withdraws(ToolSpaceKey tool_space, const CheckPoint& target) const;
  /// The distance of a target from the nearest goal, m; infinite: its tool space has none.
  [[nodiscard]] double distance(const ToolSpaceSetup& setup, const CheckPoint& target) const;

 private:
  [[nodiscard]] const OfSpace* find(ToolSpaceKey tool_space) const;
};

template <class Visit>
void for_each_part(Steering::OfSpace& space, Visit&& visit) {
  visit(space.tool_space);
  visit(space.goals);
  visit(space.withdrawn);
}
template <class Visit>
void for_each_part(Steering& steering, Visit&& visit) {
  visit(steering.spaces);
}

/// The boxes that cover all check-points of a grid that lie outside a box: withdrawing them
/// restricts an exploration to that box.
[[nodiscard]] std::vector<CheckPointBox> outside_of(const CheckPointBox& box, const Grid& grid);

}  // namespace palpate
