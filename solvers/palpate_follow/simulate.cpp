// SPDX-License-Identifier: BSD-3-Clause
#include "following/follow_tool.h"
#include "following/following_simulation.h"
#include "palpate_follow/follow.h"
#include "palpate_follow/palpating_hand.h"

namespace palpate {

FollowedRow simulate_following(const RecordedSpace& space, const HandOptions& options, double speed,
                               int cores) {
  ToolSpaceSetup setup = space.setup();
  setup.policy.tolerance = 0;
  // What a transition between levels takes is not recorded.
  setup.policy.history = History::flat;
  const ShellOptions shell = space.options().contact->shell;
  const std::vector<char>& touchable = space.body().scene->body.touchable;
  FollowTool strategy(setup, space.clearance(), touchable, shell);
  ShellCells cells(*space.clearance(), setup.grid, touchable, shell);
  FollowingOptions following;
  following.solvers = cores;
  const auto& recorded = space.configurations();
  following.seconds = [&](const Transition& transition) {
    const auto known = recorded.find(transition.target);
    const double from_start =
        known != recorded.end() ? known->second.seconds : space.mean_seconds();
    return transition.needs_no_start() ? 2 * from_start : from_start;
  };
  FollowingSimulation simulation(strategy, cells, following,
                                 [&](const Transition& t, ConfigurationSummary& found) {
                                   const CheckPoint parent = found.parent;
                                   const auto known = recorded.find(t.target);
                                   if (known != recorded.end()) found = known->second;
                                   found.parent = parent;
                                 });
  PalpatingHand hand(*space.clearance(), space.middle(), options.extent, speed, options.seed);
  const auto move = [&](double) { return hand.next(); };
  simulation.run(move, 1);
  simulation.reset_counts();
  simulation.run(move, options.seconds);
  const KnownCells::Counts& counts = simulation.counts();
  return {{"cores", cores},
          {"hand (mm/s)", 1e3 * speed},
          {"in computed cells (%)", 100 * counts.share()},
          {"median wait (s)", counts.wait(0.5)},
          {"longest wait (s)", counts.wait(1)},
          {"state (ms)", 1e3 * space.mean_seconds()}};
}

}  // namespace palpate
