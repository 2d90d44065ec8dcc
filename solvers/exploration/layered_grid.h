// SPDX-License-Identifier: BSD-3-Clause
// The flat space on a uniform grid, in layers around rest [P07b]: layer l holds the check-points
// whose largest index is l in magnitude, and each is reached from the usable ones of layer l − 1
// that touch it, the nearest to the straight way from rest first: the next is tried where the step
// from one fails. By this rule another number of ranks, or a run that was resumed, finds the same
// branch.
//
// A check-point beyond the force limit, or whose solve failed, is no start: where that leaves none,
// the check-point is given up.
//
// The grid is that of the corners of the coarsest cells, Grid::coarsest.
//
// [P07b] Peterlík, Distributed Precomputation of State-space…, MEMICS 2007.
#pragma once

#include <map>

#include "exploration/exploration_strategy.h"

namespace palpate {

/// The check-points that are reached from one that was found, whatever else is.
[[nodiscard]] std::vector<CheckPoint> following_in_layers(const Grid& grid,
                                                          const ConfigurationSummary& found);

class LayeredGrid final : public ExplorationStrategy {
 public:
  explicit LayeredGrid(const Grid& grid);

  void recall(const ConfigurationSummary& found) override;
  void accept(const ConfigurationSummary& found) override;
  [[nodiscard]] std::vector<Transition> next() override;
  [[nodiscard]] std::vector<CheckPoint> given_up() override;
  [[nodiscard]] std::int64_t num_expected() const override;

  /// Whether a check-point belongs to this grid.
  [[nodiscard]] bool holds(const CheckPoint& p) const;
  /// Nothing is under way, and nothing is due.
  [[nodiscard]] bool is_complete() const;

 private:
  enum class Status : char {
    /// It was not found yet.
    open,
    /// A transition to it was given out, or is made because it follows from its start.
    under_way,
    /// It was found, and others may be reached from it.
    start,
    /// Others may not be reached from it: it failed, is beyond the force limit or is not reached.
    no_start,
  };

  [[nodiscard]] Status& at(const CheckPoint& p);
  void take_in(const ConfigurationSummary& found);
  /// Gives out a transition to a target, gives the target up, or lets it wait.
  void decide(const CheckPoint& target);
  /// Decides the targets of the next layer that touch p.
  void decide_around(const CheckPoint& p);

  std::int32_t step_;
  /// The largest index of a check-point, in steps of this grid.
  std::int32_t reach_;
  /// Of each check-point [(2 reach + 1)³], k fastest.
  std::vector<Status> status_;
  std::int64_t num_under_way_ = 0;
  bool has_begun_ = false;
  /// By target the start of the last step to it, which failed; in steps of this grid. What is due
  /// and given up is in steps of the tool space's.
  std::map<CheckPoint, CheckPoint> failed_from_;
  std::vector<Transition> due_;
  std::vector<CheckPoint> given_up_;
};

}  // namespace palpate
