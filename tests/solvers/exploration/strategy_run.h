// SPDX-License-Identifier: BSD-3-Clause
// An exploration without mechanics: answers stand in for solves.
#pragma once

#include <functional>
#include <random>
#include <string>
#include <vector>

#include "exploration/exploration_strategy.h"
#include "exploration/layered_grid.h"

namespace palpate::test {

using Solve = std::function<ConfigurationSummary(const Transition&)>;

/// In which order transitions are made, and how late the strategy hears of what they find.
enum class Order { deep, wide, random };

inline std::string to_string(Order order) {
  return order == Order::deep ? "Deep" : order == Order::wide ? "Wide" : "Random";
}

/// Makes all transitions that a strategy asks for, and those that follow.
/// @param until Ends before this many.
/// @returns what they found, in the order in which the strategy heard of it.
inline std::vector<ConfigurationSummary> explore(ExplorationStrategy& strategy,
                                                 const ToolSpaceSetup& setup, Order order,
                                                 const Solve& solve, std::size_t until = SIZE_MAX) {
  std::mt19937 random(7);
  std::vector<Transition> tasks = strategy.next();
  std::vector<ConfigurationSummary> unheard;
  std::vector<ConfigurationSummary> heard;
  const auto pick = [&](std::size_t size) {
    if (order == Order::deep) return size - 1;
    return order == Order::wide ? 0
                                : std::uniform_int_distribution<std::size_t>(0, size - 1)(random);
  };
  while ((!tasks.empty() || !unheard.empty()) && heard.size() < until) {
    const bool listens = tasks.empty() || (!unheard.empty() && order == Order::random &&
                                           std::bernoulli_distribution(0.3)(random));
    if (listens) {
      const auto i = static_cast<std::ptrdiff_t>(pick(unheard.size()));
      heard.push_back(unheard[static_cast<std::size_t>(i)]);
      unheard.erase(unheard.begin() + i);
      strategy.accept(heard.back());
      for (const Transition& t : strategy.next()) tasks.push_back(t);
      continue;
    }
    const auto i = static_cast<std::ptrdiff_t>(pick(tasks.size()));
    const Transition t = tasks[static_cast<std::size_t>(i)];
    tasks.erase(tasks.begin() + i);
    ConfigurationSummary found = solve(t);
    found.check_point = t.target;
    found.parent = t.start;
    if (t.finds_candidate) {
      found.parent_level = t.start_level;
      found.level = candidate_level(t.start, t.start_level, t.target);
    }
    for (const CheckPoint& target : following_in_layers(setup.grid, found))
      tasks.push_back({target, t.target});
    unheard.push_back(found);
  }
  return heard;
}

/// Converged, and nothing else.
inline ConfigurationSummary good(const Transition&) {
  ConfigurationSummary found;
  found.outcome = Outcome::converged;
  return found;
}

}  // namespace palpate::test
