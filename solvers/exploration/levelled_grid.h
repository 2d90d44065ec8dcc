// SPDX-License-Identifier: BSD-3-Clause
// Levels on a uniform grid [P07]: a check-point has each equilibrium that was found there, as a
// level, and each level says which level of each neighbour the body reaches when it is moved there.
//
// The flat space is explored first, as layered_grid.h says. Then all transitions between each
// suspect and its neighbours are made in rounds, from and to all their levels. A suspect is a
// check-point with a sign of several branches: a jump or a loss of stability on the way to it, an
// edge whose energy does not fit its forces (branch_test.h), or a target that was not reached. A
// check-point with several levels becomes a suspect too. A body without such signs needs no further
// transition. With History::levels, all check-points are suspects.
//
// A transition has found a known level of its target if force and displacement are the same.
// Neither the rounds nor the order in which a round compares levels depend on the order in which
// configurations are found.
//
// A check-point has at most kMostLevels levels. A transition that finds one more counts as failed,
// and is marked so (beyond_most_levels).
//
// No transition starts from a state that is inverted, unstable or beyond the force limit, and none
// leads to a check-point where the flat space is inverted. A transition that finds an inverted
// state counts as not reached.
//
// [P07] Peterlík & Matyska, An Algorithm of State-Space Precomputation…, World Haptics 2007.
#pragma once

#include <map>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "exploration/layered_grid.h"

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
  using Levels = std::map<std::int32_t, ConfigurationSummary>;
  /// A transition: its start, the level of the start, and its target.
  using Key = std::tuple<CheckPoint, std::int32_t, CheckPoint>;

  [[nodiscard]] bool is_in_box(const CheckPoint& p) const;
  [[nodiscard]] const ConfigurationSummary* flat_at(const CheckPoint& p) const;
  [[nodiscard]] bool is_suspect(const ConfigurationSummary& found) const;
  /// Whether the energy along an edge does not fit the forces at its ends.
  [[nodiscard]] bool is_across(const ConfigurationSummary& found, int axis) const;
  /// Finds the suspects of the flat space, which is complete.
  void find_suspects();
  /// The transitions between suspects and their neighbours that are not settled yet.
  [[nodiscard]] std::set<Key> missing() const;
  void add_transitions(const CheckPoint& from, const CheckPoint& to, std::set<Key>& all) const;
  void settle(const Key& key);
  /// The level of a state at its check-point: a known one, the next free one, or
  /// beyond_most_levels.
  [[nodiscard]] std::int32_t level_of(const ConfigurationSummary& found) const;

  ToolSpaceSetup setup_;
  LayeredGrid flat_;
  bool has_suspects_ = false;
  std::set<CheckPoint> suspects_;
  /// The configurations that the flat space and the rounds so far have found.
  std::map<CheckPoint, Levels> found_;
  /// The levels above 0, those of earlier runs too.
  std::map<CheckPoint, Levels> levels_;
  std::int64_t num_levels_ = 0;
  /// The levels that transitions of earlier runs have reached.
  std::map<Key, std::int32_t> recalled_;
  /// Results of this round's transitions, and of those of earlier runs that were not settled.
  std::map<Key, ConfigurationSummary> candidates_;
  std::map<Key, std::int32_t> reached_;
  std::size_t num_under_way_ = 0;
  std::vector<Settlement> settled_;
};

}  // namespace palpate
