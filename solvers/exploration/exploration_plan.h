// SPDX-License-Identifier: BSD-3-Clause
// What of the exploration of a tool space is the same on every rank and does not change while the
// ranks are at work: what follows from what, and which rank decides about a check-point.
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

  /// The targets to which transitions from a configuration are made whatever else is found. The
  /// same target follows from no other configuration.
  [[nodiscard]] virtual std::vector<CheckPoint> following(
      const ConfigurationSummary& found) const = 0;
  /// Each check-point has an owner of its own, which knows of that one alone. Otherwise one rank
  /// owns the tool space.
  [[nodiscard]] virtual bool is_spread() const = 0;
  /// How far a check-point is from where the exploration begins, m: of what is due, a rank makes
  /// first what is nearest. It decides when a configuration is found, never what is found.
  [[nodiscard]] virtual double distance(const CheckPoint& /*p*/) const { return 0; }
  /// The strategy of the check-points that a rank owns.
  [[nodiscard]] virtual std::unique_ptr<ExplorationStrategy> make_strategy(int rank,
                                                                           int num_ranks) const = 0;

  /// The key of the owner of a check-point, see owner.h.
  [[nodiscard]] std::uint64_t owner_key(ToolSpaceId tool_space, const CheckPoint& p) const;

 protected:
  ExplorationPlan() = default;
};

/// A tool space and how it is explored.
struct PlannedSpace {
  ToolSpaceSetup setup;
  std::shared_ptr<const ExplorationPlan> plan;
};

/// The plan of a grid around rest, by the strategy that the policy asks for.
[[nodiscard]] std::shared_ptr<const ExplorationPlan> make_grid_plan(const ToolSpaceSetup& setup);

}  // namespace palpate
