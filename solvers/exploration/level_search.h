// SPDX-License-Identifier: BSD-3-Clause
// The search for levels: a check-point has each equilibrium that was found there, as a level, and
// each level says which level of each neighbour the body reaches when it is moved there [P07].
//
// Level 0 is that of the flat space, which is complete before the search begins. The search makes
// transitions along suspected edges, in both directions, and between each check-point with several
// levels and its neighbours, from and to all their levels. It goes in rounds, until a round finds
// nothing new. A body without suspected edges needs no further transition.
//
// On request it saves transitions. Two configurations at the ends of an edge are connected if the
// energy along it fits their forces, and the transition from one to the other was made, or neither
// fits any other level of the other end. A transition is made only if it may tell more: if its
// start is not connected with exactly one level of the target.
//
// A transition has found a known level of its target if force and displacement are the same.
// Neither the rounds nor the order in which a round compares levels depend on the order in which
// configurations are found.
//
// A run that was killed may have lost some of the levels of a check-point, not always the last
// ones. A level has the first number that is free, so that those that are found again, in the same
// order, have their numbers again.
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

#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "exploration/exploration_strategy.h"

namespace palpate {

class LevelSearch {
 public:
  /// A transition: its start, the level of the start, and its target.
  using Key = std::tuple<CheckPoint, std::int32_t, CheckPoint>;
  /// The configurations of a check-point by their levels.
  using Levels = std::map<std::int32_t, ConfigurationSummary>;

  struct Setting {
    /// The check-points beside one, in directions of their own (neighbour_number()).
    std::function<std::vector<CheckPoint>(const CheckPoint&)> neighbours;
    /// The displacement of the body with which differences of displacements are compared, m.
    std::function<double(const ConfigurationSummary&)> displacement;
    /// The distance with which differences of forces are compared, by the stiffness, m.
    double spacing = 0;
    /// Whether the energy between two neighbouring configurations fits their forces; empty: all
    /// transitions are made.
    std::function<bool(const ConfigurationSummary&, const ConfigurationSummary&)> is_smooth = {};
  };

  explicit LevelSearch(Setting setting) : setting_(std::move(setting)) {}

  /// Takes in what an earlier run has found: a configuration of any level, a candidate among them,
  /// or what a transition has reached.
  void recall(const ConfigurationSummary& found);
  void recall(const LevelTransition& transition);
  /// Takes in a level, or what a transition has reached, as found already. A search that goes on in
  /// other rounds than those of an undisturbed run begins with all that is known.
  void know(const ConfigurationSummary& found);
  void know(const LevelTransition& transition);
  /// Takes in a configuration of the flat space, or the result of a transition of this search.
  void accept(const ConfigurationSummary& found);
  /// Has the transitions between two neighbours made, in both directions.
  void suspect(const CheckPoint& p, const CheckPoint& q) { suspects_.emplace(p, q); }

  /// The transitions of the next round, after all of the last one have been accepted; none: all
  /// levels are known. Transitions with the same start are next to each other.
  [[nodiscard]] std::vector<Transition> next();
  /// What transitions have reached since the last call.
  [[nodiscard]] std::vector<Settlement> settled();
  /// Whether transitions of a round were not accepted yet.
  [[nodiscard]] bool is_under_way() const { return num_under_way_ > 0; }
  /// The number of levels above 0, and of transitions under way.
  [[nodiscard]] std::int64_t num_more() const {
    return num_levels_ + static_cast<std::int64_t>(num_under_way_);
  }
  /// The configurations that the flat space and the rounds so far have found, usable or not.
  [[nodiscard]] const std::map<CheckPoint, Levels>& found() const { return found_; }
  /// The usable configuration of the flat space at a check-point; null: there is none.
  [[nodiscard]] const ConfigurationSummary* flat_at(const CheckPoint& p) const;
  /// Whether transitions between levels may start from a configuration.
  [[nodiscard]] static bool is_start(const ConfigurationSummary& c);

 private:
  /// The transitions that are not settled yet.
  [[nodiscard]] std::set<Key> missing() const;
  /// Adds those from the levels of a check-point that were not made and are wanted.
  /// @param is_wanted Called with the configuration from which a transition starts, and its target.
  template <class Wanted>
  void add_transitions(const CheckPoint& from, const CheckPoint& to, Wanted&& is_wanted,
                       std::set<Key>& all) const;
  /// Of transitions that may tell more, those of this round: one to each target, and none back, as
  /// what it finds may tell enough of the others.
  [[nodiscard]] static std::set<Key> first_to_make(const std::set<Key>& telling);
  /// Whether a transition from a level of a check-point may tell more.
  [[nodiscard]] bool tells(const ConfigurationSummary& from, const CheckPoint& to) const;
  void settle(const Key& key);
  /// The level of a state at its check-point: a known one, the first free one, or
  /// beyond_most_levels.
  [[nodiscard]] std::int32_t level_of(const ConfigurationSummary& found) const;

  Setting setting_;
  std::set<std::pair<CheckPoint, CheckPoint>> suspects_;
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
