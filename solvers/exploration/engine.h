// SPDX-License-Identifier: BSD-3-Clause
// Makes the transitions that a frontier asks for, on all ranks.
//
// The transitions of Frontier::next() are a batch, shared out among the ranks. Each is a task: the
// transition, and depth first all that follows from what it finds. So on the way down and back a
// start still has its factor, and a rank has no more states in memory than it is layers deep. The
// first batches are single transitions, until there are tasks enough for all ranks; on one rank the
// first batch is everything but what failed transitions hold up.
#pragma once

#include <map>
#include <set>
#include <utility>
#include <vector>

#include "equilibrium/equilibrium.h"
#include "equilibrium/tip.h"
#include "exploration/frontier.h"
#include "exploration/monitor.h"
#include "exploration/record.h"
#include "schedule/communicator.h"

namespace palpate {

class Engine {
 public:
  /// @param tip With the radius of the sites.
  Engine(const std::vector<Site>& sites, const Tip& tip, EquilibriumSolver& solver, Record& record,
         Communicator& communicator, Monitor& monitor);

  /// @returns false when it was aborted.
  /// @note Collective
  bool explore(Frontier& frontier, PrecomputeReport& report);

 private:
  using Key = std::pair<Index, CheckPoint>;
  /// What was found, and the rank whose record has it.
  struct Found {
    ConfigurationSummary summary;
    int rank = 0;
  };

  void recall(Frontier& frontier, PrecomputeReport& report);
  void give_up_settled(const Frontier& frontier, PrecomputeReport& report);
  [[nodiscard]] std::vector<int> share_out(const std::vector<Transition>& batch,
                                           const Frontier& frontier) const;
  void send_starts(const std::vector<Transition>& batch, const std::vector<int>& owners);
  [[nodiscard]] Equilibrium start_of(const Transition& transition) const;
  void walk(const Transition& transition, const Equilibrium& start, const Frontier& frontier,
            Bytes& results);
  [[nodiscard]] Configuration make(const Transition& transition, const Equilibrium& start,
                     const Frontier& frontier);
  void take_in(const Bytes& results, int rank, Frontier& frontier, PrecomputeReport& report);

  EquilibriumSolver& solver_;
  const Tip& tip_;
  Record& record_;
  Communicator& communicator_;
  Monitor& monitor_;
  std::map<Index, Site> site_of_node_;
  Index held_node_ = -1;
  /// Tasks go on with what follows from their transition.
  bool goes_deep_;
  /// On this rank; the others hear of it at the end of the batch.
  bool aborted_ = false;

  /// All that is usable.
  std::map<Key, Found> found_;
  /// Failed transitions that may be tried from another start.
  std::map<Key, Found> failed_;
  /// Starts of this rank's tasks that are in the record of another one.
  std::map<Key, Configuration> sent_;
};

}  // namespace palpate
