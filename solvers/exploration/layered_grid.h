// SPDX-License-Identifier: BSD-3-Clause
// The flat space on a uniform grid, explored in layers around rest [P07b]. Layer l holds the
// check-points whose largest index is l in magnitude. Each is reached from a usable check-point of
// layer l − 1 that touches it: first from the one nearest to the straight line from rest, and after
// a failure from the next. By this rule any number of ranks, and a run that was resumed, finds the
// same branch.
//
// A check-point beyond the force limit, or whose solve failed, is no start. A check-point without a
// start is given up.
//
// The points of the grid are the corners of the coarsest cells, see Grid::coarsest.
//
// [P07b] Peterlík, Distributed Precomputation of State-space…, MEMICS 2007.
#pragma once

#include <map>

#include "exploration/exploration_strategy.h"

namespace palpate {

/// The check-points that are reached from a configuration, whatever else is found.
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
  /// Whether no transition is being made or waits to be asked for.
  [[nodiscard]] bool is_complete() const;

 private:
  enum class Status : char {
    /// It was not found yet.
    open,
    /// A transition to it was asked for, or is made because it follows from its start.
    under_way,
    /// It was found, and others may be reached from it.
    start,
    /// It is no start: it failed, is beyond the force limit or was given up.
    no_start,
  };

  [[nodiscard]] Status& at(const CheckPoint& p);
  void take_in(const ConfigurationSummary& found);
  /// Asks for a transition to a target, gives the target up, or lets it wait.
  void decide(const CheckPoint& target);
  /// Decides the targets of the next layer that touch p.
  void decide_around(const CheckPoint& p);

  std::int32_t step_;
  /// The largest index of a check-point, in steps of this grid.
  std::int32_t reach_;
  /// The status of each check-point [(2 reach + 1)³], k fastest.
  std::vector<Status> status_;
  std::int64_t num_under_way_ = 0;
  bool has_started_ = false;
  /// By target, the start of the last step to it, which failed. Both are in steps of this grid;
  /// pending_ and given_up_ are in those of the tool space's grid.
  std::map<CheckPoint, CheckPoint> failed_from_;
  std::vector<Transition> pending_;
  std::vector<CheckPoint> given_up_;
};

}  // namespace palpate
