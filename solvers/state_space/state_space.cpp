// SPDX-License-Identifier: BSD-3-Clause
#include "state_space/state_space.h"

#include <algorithm>

namespace palpate {

const Configuration* SiteSpace::find(const CheckPoint& check_point, std::int32_t level) const {
  ConfigurationSummary key;
  key.check_point = check_point;
  key.level = level;
  const auto found = std::lower_bound(configurations.begin(), configurations.end(), key);
  return found != configurations.end() && !(key < *found) ? &*found : nullptr;
}

const SiteSpace* StateSpace::find(Index active_node) const {
  const auto found = std::lower_bound(
      sites.begin(), sites.end(), active_node,
      [](const SiteSpace& space, Index node) { return space.site.active_node < node; });
  return found != sites.end() && found->site.active_node == active_node ? &*found : nullptr;
}

void sort(StateSpace& space) {
  std::sort(space.sites.begin(), space.sites.end(), [](const SiteSpace& a, const SiteSpace& b) {
    return a.site.active_node < b.site.active_node;
  });
  for (SiteSpace& site : space.sites) {
    std::sort(site.configurations.begin(), site.configurations.end());
    std::sort(site.intermediate_states.begin(), site.intermediate_states.end());
  }
}

}  // namespace palpate
