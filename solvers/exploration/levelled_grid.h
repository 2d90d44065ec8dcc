// SPDX-License-Identifier: BSD-3-Clause
// Levels on a uniform grid (level_search.h). The flat space is explored first, as layered_grid.h
// says. Suspected are all edges at a check-point with a sign of several branches: a jump or a loss
// of stability on the way to it, an edge whose energy does not fit its forces (branch_test.h), or a
// target that was not reached. With History::levels, all check-points are suspects.
#pragma once

#include <vector>

#include "exploration/layered_grid.h"
#include "exploration/level_search.h"

namespace palpate {

class LevelledGrid final : public ExplorationStrategy {
 public:
  /// @param setup Its grid must be uniform.
  explicit LevelledGrid(const ToolSpaceSetup& setup);

  void recall(const ConfigurationSummary& found) override;
  void recall(const LevelTransition& transition) override;
  void accept(const ConfigurationSummary& found) override;
  [[nodiscard]] std::vector<Transition> next() override;
  [[nodiscard]] std::vector<CheckPoint> given_up() override { return flat_.given_up(); }
  [[nodiscard]] std::vector<Settlement> settled() override;
  [[nodiscard]] std::int64_t num_expected() const override;

 private:
  [[nodiscard]] std::vector<CheckPoint> neighbours(const CheckPoint& p) const;
  /// Whether the energy along an edge does not fit the forces at its ends.
  [[nodiscard]] bool is_across(const ConfigurationSummary& found, int axis) const;
  [[nodiscard]] bool is_suspect(const ConfigurationSummary& found) const;
  /// Finds the suspects of the flat space, which is complete.
  void find_suspects();
  /// Suspects all edges at a check-point.
  void suspect(const CheckPoint& p);

  ToolSpaceSetup setup_;
  LayeredGrid flat_;
  LevelSearch search_;
  bool has_suspects_ = false;
};

}  // namespace palpate
