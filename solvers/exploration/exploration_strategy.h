// SPDX-License-Identifier: BSD-3-Clause
// An exploration strategy decides which transitions the exploration of a tool space makes next; the
// engine makes them. It knows neither the mechanics nor the ranks.
//
// Which start a target is reached from depends on what was found, never on when, so that another
// number of ranks finds the same space. What follows from a configuration whatever else is found is
// said by the plan of the tool space, which all ranks know (exploration_plan.h): the rank that
// finds the configuration goes on with it depth first, while the start still has its factor, and
// asks nobody. The rest is decided at the rank that owns the target, once it has heard.
#pragma once

#include <cstdint>
#include <vector>

#include "state_space/tool_space.h"

namespace palpate {

/// A step from a configuration that is known to one that is sought.
struct Transition {
  CheckPoint target{};
  /// Where the transition begins. The rest position needs no start: there it is the target itself.
  CheckPoint start{};
  std::int32_t start_level = 0;
  /// What is sought is not the first configuration at the target but the one that is reached from
  /// this start. It may be known already: it is a candidate, see candidate_level().
  bool finds_candidate = false;

  [[nodiscard]] bool needs_no_start() const { return start == target; }
};

/// What became of a transition between levels.
struct Settlement {
  LevelTransition transition;
  /// A configuration that was not known was found, and has the level that was reached.
  bool is_new = false;
  /// There is a candidate to give that level to, or to remove.
  bool has_candidate = false;
};

class ExplorationStrategy {
 public:
  virtual ~ExplorationStrategy() = default;
  ExplorationStrategy(const ExplorationStrategy&) = delete;
  ExplorationStrategy& operator=(const ExplorationStrategy&) = delete;

  /// Takes in a configuration of an earlier run, before the first next().
  virtual void recall(const ConfigurationSummary& found) = 0;
  virtual void recall(const LevelTransition& /*transition*/) {}

  /// Takes in what a transition has found. Where it is usable, whoever found it goes on with what
  /// follows; one that failed may be tried again from another start.
  virtual void accept(const ConfigurationSummary& found) = 0;

  /// The start that was asked for, or that the target follows from, leads nowhere.
  /// @param beyond_limit Since it is beyond the force limit.
  virtual void refuse(const CheckPoint& /*target*/, const CheckPoint& /*start*/,
                      bool /*beyond_limit*/) {}
  /// An earlier run has found a start from which the target follows.
  virtual void offer(const CheckPoint& /*target*/, const CheckPoint& /*start*/) {}

  /// The transitions that are due and were not given out before, nor follow from a configuration
  /// that was accepted. Those of one start follow each other.
  [[nodiscard]] virtual std::vector<Transition> next() = 0;

  /// The targets that were given up since the last call: no transition leads there any more.
  [[nodiscard]] virtual std::vector<CheckPoint> given_up() = 0;

  /// Whether a target was given up since what leads there is beyond the force limit.
  [[nodiscard]] virtual bool is_beyond_limit(const CheckPoint& /*given_up*/) const { return false; }

  /// The transitions between levels that were settled since the last call, before any starts from
  /// what they have found.
  [[nodiscard]] virtual std::vector<Settlement> settled() { return {}; }

  /// Configurations that the exploration will find at most, as far as is known now.
  [[nodiscard]] virtual std::int64_t num_expected() const = 0;

 protected:
  ExplorationStrategy() = default;
};

}  // namespace palpate
