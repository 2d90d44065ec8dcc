// SPDX-License-Identifier: BSD-3-Clause
// A space that refines itself to a tolerance: first the corners of the coarsest cells, as
// layered_grid.h; then, round by round, the points of the halves of those cells that
// error_estimate.h says are not good enough. A round begins when the one before is complete, so
// that what is refined does not depend on the order in which configurations are found; it is
// planned anew from the same configurations when an exploration is resumed or its tolerance
// changed.
//
// The points of a cell are reached from its corners, the nearest first, then the one nearest to
// rest.
#pragma once

#include <map>
#include <set>
#include <vector>

#include "exploration/layered_grid.h"

namespace palpate {

class AdaptiveGrid final : public ExplorationStrategy {
 public:
  /// @param tool space It has a tolerance.
  explicit AdaptiveGrid(const ToolSpaceSetup& setup);

  void recall(const ConfigurationSummary& found) override;
  void accept(const ConfigurationSummary& found) override;
  [[nodiscard]] std::vector<Transition> next() override;
  [[nodiscard]] std::vector<CheckPoint> given_up() override;
  [[nodiscard]] std::int64_t num_expected() const override {
    return coarse_.num_expected() + num_refined_;
  }

 private:
  using Summaries = std::map<CheckPoint, ConfigurationSummary>;

  void plan_round();
  [[nodiscard]] std::vector<CheckPoint> starts(const std::vector<CheckPoint>& corners,
                                               const CheckPoint& target) const;

  ToolSpaceSetup setup_;
  LayeredGrid coarse_;
  /// What the rounds so far have found, usable or not, and the points that nothing leads to.
  Summaries found_;
  /// What earlier runs have found between the corners of the coarsest cells, and no round has
  /// asked for yet.
  Summaries recalled_;
  /// Targets that are under way, and the starts that may be tried next.
  std::map<CheckPoint, std::vector<CheckPoint>> under_way_;
  /// Points that rounds have asked for.
  std::int64_t num_refined_ = 0;
  std::vector<Transition> due_;
  std::vector<CheckPoint> given_up_;
};

}  // namespace palpate
