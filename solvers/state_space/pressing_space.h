// SPDX-License-Identifier: BSD-3-Clause
// The tool space whose tool presses the body anywhere. A space may have several; all that feels and
// shows a tool that presses takes the one that is found here.
#pragma once

#include <algorithm>

#include "state_space/touch_space.h"

namespace palpate {

/// The first of these spaces by number; nullptr: there is none.
[[nodiscard]] inline const TouchToolSpace* find_pressing(const TouchSpace& space) {
  const auto found =
      std::find_if(space.tool_spaces.begin(), space.tool_spaces.end(),
                   [](const TouchToolSpace& tool_space) { return tool_space.setup.presses(); });
  return found != space.tool_spaces.end() ? &*found : nullptr;
}

}  // namespace palpate
