// SPDX-License-Identifier: BSD-3-Clause
// A tool space with a bonded tool, without a body.
#pragma once

#include "state_space/tool_space.h"

namespace palpate::test {

inline ToolSpaceSetup bonded_setup(Index node, const Grid& grid,
                                   const ExplorationPolicy& policy = {}) {
  ToolSpaceSetup setup;
  setup.id = node;
  setup.interaction.active_node = node;
  setup.grid = grid;
  setup.policy = policy;
  return setup;
}

}  // namespace palpate::test
