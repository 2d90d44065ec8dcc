// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/exploration_strategy.h"

#include "exploration/adaptive_grid.h"
#include "exploration/layered_grid.h"
#include "exploration/levelled_grid.h"

namespace palpate {

std::unique_ptr<ExplorationStrategy> make_strategy(const ToolSpaceSetup& setup) {
  if (setup.policy.tolerance > 0) return std::make_unique<AdaptiveGrid>(setup);
  if (setup.policy.history != History::flat) return std::make_unique<LevelledGrid>(setup);
  return std::make_unique<LayeredGrid>(setup.grid);
}

}  // namespace palpate
