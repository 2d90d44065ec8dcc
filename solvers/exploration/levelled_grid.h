// SPDX-License-Identifier: BSD-3-Clause
// Levels on a uniform grid [P07]: a check-point holds every equilibrium that the body is found in
// there, and each of these says which level of each neighbour the body is on when it is moved
// there.
//
// First comes the flat space, as layered_grid.h. Then, round by round, all transitions between each
// suspect and its neighbours, from and to all their levels. Suspects are check-points where there
// are signs of several branches: a jump or a loss of stability on the way there, an edge whose
// energy does not fit its forces (branch_test.h), a target that was not reached; and then those
// that have several levels. A body without such signs pays nothing. With History::levels all are
// suspects.
//
// What a transition finds is one of the levels of its target if force and displacement are the
// same. The rounds, and the order in which levels are told apart in each, do not depend on the
// order in which configurations are found.
//
// A check-point has kMostLevels levels at most: a transition that finds one more counts as one that
// has failed, and says so (beyond_most_levels).
//
// No transition starts from a state that is inverted, unstable or beyond the force limit, and none
// leads to where the flat space is inverted; what one finds inverted counts as not reached.
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
  /// @param tool space Its grid is uniform.
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
  /// A transition: its start, the level of that, and its target.
  using Key = std::tuple<CheckPoint, std::int32_t, CheckPoint>;

  [[nodiscard]] bool is_in_box(const CheckPoint& p) const;
  [[nodiscard]] const ConfigurationSummary* flat_at(const CheckPoint& p) const;
  [[nodiscard]] bool is_suspect(const ConfigurationSummary& found) const;
  /// Whether the energy along an edge does not fit the forces at its ends.
  [[nodiscard]] bool is_across(const ConfigurationSummary& found, int axis) const;
  /// Finds the suspects of the flat space, once that is complete.
  void find_suspects();
  /// The transitions that suspects ask for and that are not settled yet.
  [[nodiscard]] std::set<Key> missing() const;
  void add_transitions(const CheckPoint& from, const CheckPoint& to, std::set<Key>& all) const;
  void settle(const Key& key);
  /// The level of a state at its check-point, a new one, or beyond_most_levels.
  [[nodiscard]] std::int32_t level_of(const ConfigurationSummary& found) const;

  ToolSpaceSetup setup_;
  LayeredGrid flat_;
  bool has_suspects_ = false;
  std::set<CheckPoint> suspects_;
  /// What the flat space and the rounds so far have found.
  std::map<CheckPoint, Levels> found_;
  /// The levels beyond the flat space, those of earlier runs too.
  std::map<CheckPoint, Levels> levels_;
  std::int64_t num_levels_ = 0;
  /// The levels that transitions of earlier runs have reached.
  std::map<Key, std::int32_t> recalled_;
  /// What transitions of this round, and those of earlier runs that were not settled, have found.
  std::map<Key, ConfigurationSummary> candidates_;
  std::map<Key, std::int32_t> reached_;
  std::size_t num_under_way_ = 0;
  std::vector<Settlement> settled_;
};

}  // namespace palpate
