// SPDX-License-Identifier: BSD-3-Clause
// A grid that is refined until the interpolated force has a tolerance. First the corners of the
// coarsest cells are explored, as layered_grid.h says. Then, round by round, the cells whose error
// is too large by error_estimate.h are halved along each axis, and the new points are explored. A
// round begins when the one before is complete, so that the refinement does not depend on the order
// in which configurations are found. When an exploration is resumed, or its tolerance was changed,
// the rounds are planned anew from the configurations that are known.
//
// A new point is reached from the corners of its cell: the nearest to the point is tried first, and
// of two that are as near the one nearer to rest.
#pragma once

#include <map>
#include <set>
#include <vector>

#include "exploration/layered_grid.h"

namespace palpate {

class AdaptiveGrid final : public ExplorationStrategy {
 public:
  /// @param setup Its policy must have a tolerance.
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
  /// The configurations that the rounds so far have found, usable or not. A point that no start
  /// leads to is here too, as one that failed.
  Summaries found_;
  /// Configurations of earlier runs between the corners of the coarsest cells that no round has
  /// asked for yet.
  Summaries recalled_;
  /// Targets of the transitions that are being made, each with the starts that may be tried next.
  std::map<CheckPoint, std::vector<CheckPoint>> under_way_;
  /// The number of points that rounds have asked for.
  std::int64_t num_refined_ = 0;
  std::vector<Transition> pending_;
  std::vector<CheckPoint> given_up_;
};

}  // namespace palpate
