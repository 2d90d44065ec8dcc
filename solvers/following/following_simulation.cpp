// SPDX-License-Identifier: BSD-3-Clause
#include "following/following_simulation.h"

#include <algorithm>
#include <utility>

namespace palpate {

namespace {

/// Of the virtual clock, s.
constexpr double kTick = 1e-3;

}  // namespace

FollowingSimulation::FollowingSimulation(FollowTool& strategy, ShellCells& cells,
                                         const FollowingOptions& options, Solve solve)
    : strategy_(strategy),
      cells_(cells),
      options_(options),
      solve_(std::move(solve)),
      solvers_(static_cast<std::size_t>(options.solvers)),
      known_(cells) {}

void FollowingSimulation::run(const Hand& hand, double seconds) {
  const double end = time() + seconds;
  while (time() < end) tick(hand(time()));
}

bool FollowingSimulation::run_to_end(const Hand& hand, double at_most) {
  const double end = time() + at_most;
  do {
    tick(hand(time()));
    const bool is_idle = std::none_of(solvers_.begin(), solvers_.end(),
                                      [](const Solver& solver) { return solver.is_busy; });
    if (is_idle) return true;
  } while (time() < end);
  return false;
}

double FollowingSimulation::seconds_of(const Transition& transition) {
  if (cells_.node(transition.target).is_free) return 0;
  if (options_.seconds) return options_.seconds(transition);
  constexpr double kFromStart = 0.037;
  return transition.needs_no_start() ? 2 * kFromStart : kFromStart;
}

void FollowingSimulation::tick(const HandMotion& hand) {
  const double now = time();
  for (Solver& solver : solvers_) {
    if (!solver.is_busy || solver.until > now) continue;
    solver.is_busy = false;
    ConfigurationSummary found;
    found.check_point = solver.transition.target;
    found.parent = solver.transition.start;
    found.outcome = Outcome::converged;
    solve_(solver.transition, found);
    if (found.usable()) known_.add(found.check_point);
    strategy_.accept(found);
  }
  for (const CheckPoint& p : strategy_.given_up()) known_.add(p);
  if (now >= next_pose_) {
    strategy_.follow(HandPrediction(hand, options_.prediction));
    next_pose_ += options_.between_poses;
  }
  for (Solver& solver : solvers_) {
    if (solver.is_busy) continue;
    const std::optional<Transition> transition = strategy_.next();
    if (!transition) break;
    solver.is_busy = true;
    solver.transition = *transition;
    solver.until = now + seconds_of(*transition);
    result_.begun.push_back(*transition);
    result_.times.push_back(now);
  }
  known_.tick(hand.place, kTick);
  ++ticks_;
}

}  // namespace palpate
