// SPDX-License-Identifier: BSD-3-Clause
// The part of a tool space's exploration that is the same on every rank and does not change during
// a run: which targets follow from a configuration, and which rank owns a check-point.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "exploration/exploration_strategy.h"

namespace palpate {

class ExplorationPlan {
 public:
  virtual ~ExplorationPlan() = default;
  ExplorationPlan(const ExplorationPlan&) = delete;
  ExplorationPlan& operator=(const ExplorationPlan&) = delete;

  /// The targets that are reached from a configuration, whatever else is found. Each target follows
  /// from at most one configuration.
  [[nodiscard]] virtual std::vector<CheckPoint> following(
      const ConfigurationSummary& found) const = 0;
  /// Whether each check-point has an owner rank of its own, which knows of that check-point alone.
  /// Otherwise one rank owns the whole tool space.
  [[nodiscard]] virtual bool is_spread() const = 0;
  /// The distance of a check-point from where the exploration begins, m. A rank makes the nearest
  /// target first. The distance decides when a configuration is found, never which one.
  [[nodiscard]] virtual double distance(const CheckPoint& /*p*/) const { return 0; }
  /// The strategy of the check-points that a rank owns.
  [[nodiscard]] virtual std::unique_ptr<ExplorationStrategy> make_strategy(int rank,
                                                                           int num_ranks) const = 0;

  /// The key of the owner of a check-point, see owner.h.
  [[nodiscard]] std::uint64_t owner_key(ToolSpaceKey tool_space, const CheckPoint& p) const;

 protected:
  ExplorationPlan() = default;
};

/// A tool space and how it is explored.
struct PlannedSpace {
  ToolSpaceSetup setup;
  std::shared_ptr<const ExplorationPlan> plan;
};

/// Whether any of the spaces has a key, and the space that has it. The spaces must be ordered by
/// their keys.
[[nodiscard]] bool has_space(const std::vector<PlannedSpace>& spaces, ToolSpaceKey tool_space);
[[nodiscard]] const PlannedSpace& find_space(const std::vector<PlannedSpace>& spaces,
                                             ToolSpaceKey tool_space);

/// The plan of a grid around rest, by the strategy that the policy asks for.
[[nodiscard]] std::shared_ptr<const ExplorationPlan> make_grid_plan(const ToolSpaceSetup& setup);

}  // namespace palpate
