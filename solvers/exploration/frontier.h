// SPDX-License-Identifier: BSD-3-Clause
// A frontier decides which transitions an exploration makes next; the engine makes them. A frontier
// knows neither the mechanics nor the ranks, and gives the same answers on every rank.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "state_space/configuration.h"

namespace palpate {

/// A step from a configuration that is known to one that is sought.
struct Transition {
  Index active_node = 0;
  CheckPoint target{};
  /// Where to start from, the best first; the next is taken when the step fails. Empty for the rest
  /// position, which needs no start.
  std::vector<CheckPoint> starts;
};

class Frontier {
 public:
  virtual ~Frontier() = default;
  Frontier(const Frontier&) = delete;
  Frontier& operator=(const Frontier&) = delete;

  /// The next transitions, independent of each other; empty when there is nothing left. All starts
  /// are targets of the batch before this one. Transitions from one start follow each other, since
  /// they share a factor.
  [[nodiscard]] virtual std::vector<Transition> next() = 0;

  /// Tells what was found for a transition of the last batch.
  virtual void accept(Index active_node, const ConfigurationSummary& found) = 0;

  /// Configurations that the whole exploration may find at most.
  [[nodiscard]] virtual std::int64_t num_expected() const = 0;

 protected:
  Frontier() = default;
};

}  // namespace palpate
