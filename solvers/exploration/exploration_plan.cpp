// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/exploration_plan.h"

#include <algorithm>

#include "exploration/adaptive_grid.h"
#include "exploration/layered_grid.h"
#include "exploration/levelled_grid.h"
#include "schedule/owner.h"

namespace palpate {
namespace {

class GridPlan final : public ExplorationPlan {
 public:
  explicit GridPlan(const ToolSpaceSetup& setup) : setup_(setup) {}

  [[nodiscard]] std::vector<CheckPoint> following(
      const ConfigurationSummary& found) const override {
    return following_in_layers(setup_.grid, found);
  }
  [[nodiscard]] bool is_spread() const override { return false; }
  [[nodiscard]] std::unique_ptr<ExplorationStrategy> make_strategy(
      int /*rank*/, int /*num_ranks*/) const override {
    if (setup_.policy.tolerance > 0) return std::make_unique<AdaptiveGrid>(setup_);
    if (setup_.policy.history != History::flat) return std::make_unique<LevelledGrid>(setup_);
    return std::make_unique<LayeredGrid>(setup_.grid);
  }

 private:
  ToolSpaceSetup setup_;
};

}  // namespace

std::uint64_t ExplorationPlan::owner_key(ToolSpaceKey tool_space, const CheckPoint& p) const {
  auto key = static_cast<std::uint64_t>(tool_space.id);
  if (tool_space.body != kFirstBody) key = mix(key) ^ static_cast<std::uint64_t>(tool_space.body);
  if (!is_spread()) return key;
  for (const std::int32_t x : p) key = mix(key) ^ static_cast<std::uint32_t>(x);
  return key;
}

namespace {

auto place_of(const std::vector<PlannedSpace>& spaces, ToolSpaceKey tool_space) {
  return std::lower_bound(
      spaces.begin(), spaces.end(), tool_space,
      [](const PlannedSpace& space, ToolSpaceKey key) { return space.setup.key() < key; });
}

}  // namespace

bool has_space(const std::vector<PlannedSpace>& spaces, ToolSpaceKey tool_space) {
  const auto place = place_of(spaces, tool_space);
  return place != spaces.end() && place->setup.key() == tool_space;
}

const PlannedSpace& find_space(const std::vector<PlannedSpace>& spaces, ToolSpaceKey tool_space) {
  return *place_of(spaces, tool_space);
}

std::shared_ptr<const ExplorationPlan> make_grid_plan(const ToolSpaceSetup& setup) {
  return std::make_shared<GridPlan>(setup);
}

}  // namespace palpate
