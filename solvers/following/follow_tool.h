// SPDX-License-Identifier: BSD-3-Clause
// Explores the space of a rigid tool where a hand is going: the check-points that the hand may need
// first come first. What that is changes with each motion of the hand. What is no longer needed is
// not begun; what was found stays.
//
// A force is interpolated in cells whose eight corners are known, so that cells are what is needed.
// Coarse cells within the horizon of the prediction come first, by the time until the hand may be
// in them. Cells of half the side follow where the error of the force is above the tolerance, as
// error_estimate.h estimates it and shell_rounds.h does for the whole shell. As a hand that moves
// fast keeps the solvers busy with coarse cells, finer ones are made where it slows down. If there
// is nothing to do within the horizon, cells nearest to the hand are made, so that the space grows
// while the hand rests.
//
// Starts are those of the shell (contact_shell.h), but the first of them that is known is taken. If
// none is, the first of them is made before; while that is under way the tool comes from where it
// touches nothing, if nothing else is to be done. So which start is taken depends on when others
// were found; the equilibrium does not, where there is one.
//
// Where the forces do not fit each other, the levels of the space are searched for in the cells
// that the hand may be in (levels_around.h), after the coarse cells and before finer ones, and
// elsewhere when there is nothing else to be done.
//
// The same motions, results and questions, in the same order, give the same transitions.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "exploration/exploration_strategy.h"
#include "exploration/halving_history.h"
#include "exploration/shell_cells.h"
#include "following/hand_prediction.h"
#include "following/levels_around.h"

namespace palpate {

class FollowTool {
 public:
  /// @param setup That of a rigid tool's space.
  /// @param touchable One entry for each point of the mesh; other than 0: the point may be touched.
  FollowTool(const ToolSpaceSetup& setup, std::shared_ptr<const ToolClearance> clearance,
             std::vector<char> touchable, ShellOptions options);
  FollowTool(const FollowTool&) = delete;
  FollowTool& operator=(const FollowTool&) = delete;

  /// Takes in a configuration of an earlier run.
  void recall(const ConfigurationSummary& found);
  void recall(const LevelTransition& transition);
  /// Says where the hand may be from now on.
  void follow(const HandPrediction& hand);
  /// The transition that is needed first. Until its result comes, it is under way.
  /// @returns nothing: all that is left is under way, or there is nothing left.
  [[nodiscard]] std::optional<Transition> next();
  /// Whether further transitions are likely to start from a check-point: it is a corner of coarse
  /// cells, and no deeper than the tool is to press.
  [[nodiscard]] bool leads_on(const CheckPoint& p);
  /// Takes in the result of a transition that is under way.
  void accept(const ConfigurationSummary& found);
  /// Says that a transition that is under way has no result, since its solver is lost. It is made
  /// again.
  void lose(const Transition& transition);
  /// The targets that were given up since the last call: no start is left that may lead there.
  [[nodiscard]] std::vector<CheckPoint> given_up();
  /// The results of transitions between levels since the last call. They come before any transition
  /// that starts from what they have found.
  [[nodiscard]] std::vector<Settlement> settled() { return levels_.settled(); }

  /// How much of what the hand may need is known.
  struct Coverage {
    /// The coarse cells that the hand may be in within the horizon, and how many of them are known.
    int needed = 0;
    int known = 0;
    /// The least time until the hand may be in a coarse cell that is not known, s; infinite: there
    /// is none within the horizon.
    double time_left = 0;
  };
  [[nodiscard]] Coverage coverage() const;

 private:
  /// How a check-point may be reached.
  struct Target {
    /// The starts that have not failed, the best first.
    std::vector<CheckPoint> starts;
    bool was_tried_without = false;
    bool is_under_way = false;
    /// One of its starts is beyond the force limit.
    bool is_beyond_limit = false;
  };
  /// A target that is due, in the order of need.
  struct Due {
    /// The time until it may be needed, s; beyond coarse cells, the distance from the hand, m.
    double need = 0;
    double depth = 0;
    CheckPoint check_point{};
    bool operator<(const Due& other) const;
  };

  /// Where levels are searched for. What is known everywhere is known near the hand.
  enum class LevelsIn { nowhere, near, everywhere };

  /// A root cell of the shell that the hand may be in, and the least time until it is.
  struct Needed {
    CheckPoint numbers{};
    double time = 0;
  };

  [[nodiscard]] bool is_done(const CheckPoint& p) const { return known_.count(p) > 0; }
  [[nodiscard]] bool is_complete(const CheckPoint& numbers) const;
  /// Plan what is due of the coarse cells that the hand may be in, of the halves of cells whose
  /// error is too large, and of the cells around those that are known.
  void plan_coarse();
  void plan_fine();
  void plan_around();
  /// The transition between levels that comes first; nothing: there is none, or its round is not
  /// complete.
  [[nodiscard]] std::optional<Transition> next_between_levels(LevelsIn where);
  /// Adds the corners of a root cell that are not known.
  void add_corners(const CheckPoint& numbers, double need, std::vector<Due>& due);
  /// Adds the cells around a root cell that are not complete to the border.
  void add_to_border(const CheckPoint& middle);
  /// Adds the root cells of the shell that are nearest to one and not complete: the hand is far
  /// away, or where nothing is to be pressed.
  void add_nearest_to_border(const CheckPoint& middle);
  [[nodiscard]] std::optional<Transition> take_first(const std::vector<Due>& due, bool may_wait);
  /// The transition that leads to a target, or to one of its starts that is to be made before.
  /// @param may_wait Whether a start that is under way is waited for.
  /// @returns nothing: the target is given up, or it waits.
  [[nodiscard]] std::optional<Transition> choose(const CheckPoint& p, bool may_wait);
  [[nodiscard]] Target& target(const CheckPoint& p);
  void give_up(const CheckPoint& p);
  void take_in(const ConfigurationSummary& found);

  ToolSpaceSetup setup_;
  std::shared_ptr<const ToolClearance> clearance_;
  std::vector<char> touchable_;
  ShellOptions options_;
  ShellCells cells_;
  std::optional<HandPrediction> hand_;
  /// What was found, or given up: usable or not.
  std::map<CheckPoint, ConfigurationSummary> known_;
  std::map<CheckPoint, Target> targets_;
  std::vector<Needed> needed_;
  /// Root cells of the shell beside complete ones, or nearest to the hand, that are not complete.
  std::set<CheckPoint> border_;
  HalvingHistory halvings_;
  LevelsAround levels_;
  /// Where levels_ was planned for the present hand and for what is known now.
  LevelsIn has_levels_ = LevelsIn::nowhere;
  /// What is near the hand for them, m.
  Eigen::AlignedBox3d searched_;
  /// What is due, in its order.
  std::vector<Due> coarse_;
  std::vector<Due> fine_;
  std::vector<Due> around_;
  /// Whether fine_ and around_ were planned for a hand near the present one, where that was, m, and
  /// whether something was found since.
  bool is_current_ = false;
  Vec3 planned_at_ = Vec3::Zero();
  bool has_found_ = false;
  std::vector<CheckPoint> given_up_;
};

}  // namespace palpate
