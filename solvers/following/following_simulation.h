// SPDX-License-Identifier: BSD-3-Clause
// Following a scripted hand by a virtual clock: the solvers take the time that they are said to
// take, and find what they are told to find.
#pragma once

#include <functional>
#include <vector>

#include "following/follow_tool.h"
#include "following/known_cells.h"

namespace palpate {

struct FollowingOptions {
  int solvers = 1;
  /// The time of a transition, s; empty: 37 ms from a known start, and twice that from where the
  /// tool touches nothing.
  std::function<double(const Transition&)> seconds;
  /// The time between two poses that the strategy hears of, s.
  double between_poses = 0.01;
  PredictionOptions prediction;
};

struct SimulatedFollowing {
  /// The transitions in the order in which they were begun, and when, s.
  std::vector<Transition> begun;
  std::vector<double> times;
};

class FollowingSimulation {
 public:
  /// The hand at a time, s.
  using Hand = std::function<HandMotion(double)>;
  /// What a transition finds. The check-point and the parent are set already.
  using Solve = std::function<void(const Transition&, ConfigurationSummary&)>;

  /// @param cells The cells of the strategy's space.
  FollowingSimulation(FollowTool& strategy, ShellCells& cells, const FollowingOptions& options,
                      Solve solve);

  /// Goes on for a time, s.
  void run(const Hand& hand, double seconds);
  /// Goes on until nothing is left to be done. @returns false: it took longer than that, s.
  bool run_to_end(const Hand& hand, double at_most);

  [[nodiscard]] const SimulatedFollowing& result() const { return result_; }
  /// Of ticks of 1 ms.
  [[nodiscard]] const KnownCells::Counts& counts() const { return known_.counts(); }
  /// Counts ticks and waits anew.
  void reset_counts() { known_.reset(); }
  [[nodiscard]] double time() const { return 1e-3 * static_cast<double>(ticks_); }

 private:
  struct Solver {
    bool is_busy = false;
    double until = 0;
    Transition transition;
  };
  void tick(const HandMotion& hand);
  [[nodiscard]] double seconds_of(const Transition& transition);

  FollowTool& strategy_;
  ShellCells& cells_;
  FollowingOptions options_;
  Solve solve_;
  std::vector<Solver> solvers_;
  KnownCells known_;
  long ticks_ = 0;
  double next_pose_ = 0;
  SimulatedFollowing result_;
};

}  // namespace palpate
