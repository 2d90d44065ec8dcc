// SPDX-License-Identifier: BSD-3-Clause
// A frontier decides which transitions an exploration makes next; the engine makes them. A frontier
// knows neither the mechanics nor the ranks, and gives the same answers on every rank.
//
// Which start a target is reached from depends on what was found, never on when. So a rank may
// explore what follows from its own findings depth first, where each start still has its factor,
// and tell the others later.
#pragma once

#include <cstdint>
#include <vector>

#include "state_space/configuration.h"

namespace palpate {

/// A step from a configuration that is known to one that is sought.
struct Transition {
  Index active_node = 0;
  CheckPoint target{};
  /// The target itself for the rest position, which needs no start.
  CheckPoint start{};
};

class Frontier {
 public:
  virtual ~Frontier() = default;
  Frontier(const Frontier&) = delete;
  Frontier& operator=(const Frontier&) = delete;

  /// All transitions that are to be made by what was accepted, independent of each other; empty when
  /// there is nothing left. Those of one active node follow each other, and so do those of one start.
  [[nodiscard]] virtual std::vector<Transition> next() = 0;

  /// The transitions from a configuration that was just found, and need not be accepted yet, that
  /// are to be made whatever else is found. The same transition follows from no other one.
  [[nodiscard]] virtual std::vector<Transition> following(
      Index active_node, const ConfigurationSummary& found) const = 0;

  /// Configurations that a transition of next() may lead to by `following`, its own included.
  [[nodiscard]] virtual std::int64_t num_following(const Transition& transition) const = 0;

  /// Tells what a transition has found, in this run or an earlier one. One that failed may be tried
  /// again from another start.
  virtual void accept(Index active_node, const ConfigurationSummary& found) = 0;

  /// Whether next() gave a target up or it was found: no transition leads there any more.
  [[nodiscard]] virtual bool is_settled(Index active_node, const CheckPoint& target) const = 0;

  /// Configurations that the whole exploration may find at most.
  [[nodiscard]] virtual std::int64_t num_expected() const = 0;

 protected:
  Frontier() = default;
};

}  // namespace palpate
