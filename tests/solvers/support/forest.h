// SPDX-License-Identifier: BSD-3-Clause
// How long a forest of tasks of known cost takes without transposition-driven scheduling: with a
// fixed share of the sites for each rank, and with a master that hands out the tasks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "solvers/support/simulation.h"

namespace palpate::test {

/// Tasks that follow from each other, of one active node say: each starts from the state that its
/// parent has found.
struct TaskTree {
  /// Of each task, s.
  std::vector<double> seconds;
  /// Comes before the task; −1 for task 0 alone.
  std::vector<int> parent;
};

struct Forest {
  std::vector<TaskTree> trees;
  /// Of each site, index into trees.
  std::vector<int> tree_of_site;

  [[nodiscard]] std::int64_t num_tasks() const;
  /// Of all tasks, s.
  [[nodiscard]] double work() const;
  /// Of the longest path from a root to a leaf, s: no number of ranks is faster.
  [[nodiscard]] double critical_path() const;
  /// Of so many ranks, s: none of them is ever idle, or the longest path takes longer.
  [[nodiscard]] double least_makespan(int num_ranks) const;
};

/// @throws InputError a tree without tasks, a parent that does not come before, a cost below 0, a
///   tree that is not there.
void validate(const Forest& forest);

/// Each site is the task of one rank, in turn, and there are no messages.
/// @returns the time that the slowest rank takes, s.
[[nodiscard]] double static_makespan(const Forest& forest, int num_ranks);

struct MasterOptions {
  Machine machine;
  /// The state that a task starts from, and what is told of one that was found.
  std::size_t state_bytes = 200'000;
  std::size_t summary_bytes = 500;
  /// Before a task whose state was sent: its factorisation, which the rank that found it has, s.
  double start_seconds = 25e-3;
};

/// Rank 0 hands out the tasks, one at a time, oldest first, and executes none (unless it is alone).
/// A rank goes on with the first child of what it has done, for which it has the state; where there
/// are more, the state goes to rank 0 and from there out with each of them.
/// @returns the time that it takes, s.
[[nodiscard]] double master_makespan(const Forest& forest, int num_ranks,
                                     const MasterOptions& options);

}  // namespace palpate::test
