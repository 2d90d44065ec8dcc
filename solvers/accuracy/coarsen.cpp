// SPDX-License-Identifier: BSD-3-Clause
#include "accuracy/coarsen.h"

#include <algorithm>

#include "interpolation/solution_branches.h"

namespace palpate {

std::int32_t smallest_side(const TouchToolSpace& tool_space) {
  const Grid& grid = tool_space.setup.grid;
  if (!grid.sparse) return 1;
  // The corners of cells are multiples of their side, which is a power of two.
  std::int32_t bits = grid.coarsest;
  for (const ConfigurationSummary& c : tool_space.configurations) {
    for (const std::int32_t x : c.check_point) bits |= x + grid.reach();
  }
  return bits & -bits;
}

std::vector<std::int32_t> coarsening_factors(const Grid& grid, std::int32_t smallest) {
  std::vector<std::int32_t> factors{1};
  // The coarsest cells of a sparse grid cannot be joined to larger ones.
  const std::int32_t most = grid.coarsest > 1 || grid.sparse ? grid.coarsest : grid.reach();
  for (std::int32_t factor = 2; factor <= most; ++factor) {
    if (most % factor == 0 && factor > smallest) factors.push_back(factor);
  }
  return factors;
}

TouchToolSpace coarsened(const TouchToolSpace& tool_space, std::int32_t factor) {
  if (factor == 1) return tool_space;
  std::vector<std::int32_t> kept;
  for (std::size_t i = 0; i < tool_space.configurations.size(); ++i) {
    const ConfigurationSummary& c = tool_space.configurations[i];
    const bool on_grid = std::all_of(c.check_point.begin(), c.check_point.end(),
                                     [&](std::int32_t x) { return x % factor == 0; });
    if (c.level == 0 && on_grid) kept.push_back(static_cast<std::int32_t>(i));
  }
  TouchToolSpace coarse = restricted(tool_space, kept);
  for (std::size_t i = 0; i < kept.size(); ++i) {
    // The flag of a jump belongs to the state, whatever the grid.
    coarse.configurations[i].flags =
        tool_space.configurations[static_cast<std::size_t>(kept[i])].flags;
  }
  if (tool_space.setup.grid.sparse) return coarse;
  coarse.intermediate_states.clear();
  coarse.setup.policy.intermediate_states = 0;
  coarse.setup.grid.resolution = 2 * (tool_space.setup.grid.reach() / factor) + 1;
  coarse.setup.grid.coarsest = std::max(tool_space.setup.grid.coarsest / factor, 1);
  for (ConfigurationSummary& c : coarse.configurations) {
    for (std::int32_t& x : c.check_point) x /= factor;
    c.parent = c.check_point;
    c.reached.fill(not_tried);
  }
  return coarse;
}

}  // namespace palpate
