// SPDX-License-Identifier: BSD-3-Clause
#include "accuracy/coarsen.h"

#include <algorithm>

#include "interpolation/solution_branches.h"

namespace palpate {

std::vector<std::int32_t> coarsening_factors(const Site& site) {
  std::vector<std::int32_t> factors{1};
  const std::int32_t most = site.coarsest > 1 ? site.coarsest : site.reach();
  for (std::int32_t factor = 2; factor <= most; ++factor) {
    const bool fits = site.coarsest > 1 ? site.coarsest % factor == 0 : most % factor == 0;
    if (fits) factors.push_back(factor);
  }
  return factors;
}

TouchSite coarsened(const TouchSite& site, std::int32_t factor) {
  if (factor == 1) return site;
  std::vector<std::int32_t> kept;
  for (std::size_t i = 0; i < site.configurations.size(); ++i) {
    const ConfigurationSummary& c = site.configurations[i];
    const bool on_grid = std::all_of(c.check_point.begin(), c.check_point.end(),
                                     [&](std::int32_t x) { return x % factor == 0; });
    if (c.level == 0 && on_grid) kept.push_back(static_cast<std::int32_t>(i));
  }
  TouchSite coarse = restricted(site, kept);
  coarse.intermediate_states.clear();
  coarse.site.intermediate_states = 0;
  coarse.site.resolution = 2 * (site.site.reach() / factor) + 1;
  coarse.site.coarsest = std::max(site.site.coarsest / factor, 1);
  for (std::size_t i = 0; i < kept.size(); ++i) {
    ConfigurationSummary& c = coarse.configurations[i];
    for (std::int32_t& x : c.check_point) x /= factor;
    c.parent = c.check_point;
    c.reached.fill(not_tried);
    // A jump on the way is a matter of the state, not of the grid.
    c.flags = site.configurations[static_cast<std::size_t>(kept[i])].flags;
  }
  return coarse;
}

}  // namespace palpate
