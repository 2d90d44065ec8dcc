// SPDX-License-Identifier: BSD-3-Clause
// The transitions that a rank makes next, in batches from one start.
//
// With nobody steering they are a depth-first stack and a priority queue. Transitions that follow
// from a configuration that was found here go on the stack, and are made first, while the start
// still has its factor. All others go into the queue, ordered by ExplorationPlan::distance().
//
// While the steering has goals, all batches are in the queue, ordered by the distance of their
// nearest target from a goal. Targets that the steering withdraws are set aside, and come back when
// it no longer does.
//
// A depth-first stack is never deep, but a queue that is steered may have very many starts. If
// their states take more than kMostStateBytes, those that this rank's record has are forgotten, the
// states of what is set aside and of the farthest targets first, and are read again when their turn
// comes. The file of a rigid tool has them in single precision, so that what is found from them is
// the same to the solver's tolerance only.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <vector>

#include "equilibrium/state.h"
#include "exploration/exploration_plan.h"
#include "exploration/steering.h"

namespace palpate {

/// The target of a transition.
struct TransitionTarget {
  CheckPoint check_point{};
  /// The level of the configuration that is sought: 0, or the number of a candidate.
  std::int32_t level = 0;
  /// The iterations and the time that earlier, failed attempts have taken.
  std::int32_t iterations = 0;
  double seconds = 0;
};

template <class Visit>
void for_each_part(TransitionTarget& target, Visit&& visit) {
  visit(target.check_point);
  visit(target.level);
  visit(target.iterations);
  visit(target.seconds);
}

/// Transitions from one start.
struct TransitionBatch {
  ToolSpaceKey tool_space;
  /// The start; not usable: the targets need no start.
  ConfigurationSummary start;
  /// The state of the start; null: it was not read yet, or there is no start.
  std::shared_ptr<const Equilibrium> state;
  /// The record of this rank has the start, so that its state can be read again.
  bool is_recorded_here = true;
  std::deque<TransitionTarget> targets;

  [[nodiscard]] bool has_start() const { return start.usable(); }
};

class TransitionQueue {
 public:
  using Batch = TransitionBatch;
  static constexpr std::size_t kMostStateBytes = std::size_t{256} << 20;

  /// @param spaces They must outlive the queue. Their plans may change.
  explicit TransitionQueue(const std::vector<PlannedSpace>& spaces,
                           std::size_t most_state_bytes = kMostStateBytes)
      : spaces_(spaces), most_state_bytes_(most_state_bytes) {}

  /// Follows another steering from now on.
  void steer(Steering steering);

  /// Puts a batch into the priority queue, behind batches of the same distance.
  void enqueue(Batch&& batch);
  /// Puts a batch on the depth-first stack.
  void push(Batch&& batch);

  [[nodiscard]] bool empty() const { return size() == 0; }
  /// The number of batches to be made.
  [[nodiscard]] std::size_t size() const { return queue_.size() + stack_.size(); }
  /// Takes out the batch that is to be made next.
  [[nodiscard]] Batch take_next();
  /// The batch that would be made last of all.
  [[nodiscard]] Batch& last();
  [[nodiscard]] Batch take_last();
  /// Whether the last batch is in the priority queue and needs no start.
  [[nodiscard]] bool last_needs_no_start();
  /// Takes out the batches whose start the record of this rank has, also those set aside.
  [[nodiscard]] std::vector<Batch> take_recorded_here();

  /// Whether targets are set aside.
  [[nodiscard]] bool has_withdrawn() const { return !withdrawn_.empty(); }
  void clear();

 private:
  /// Sets aside the targets of a batch that are withdrawn.
  /// @returns whether any target is left.
  bool withdraw(Batch& batch);
  /// The key of a batch in the queue. With goals, its nearest target comes first.
  [[nodiscard]] double rank_targets(Batch& batch) const;
  /// Forgets states until the others fit.
  void forget_states();

  const std::vector<PlannedSpace>& spaces_;
  std::size_t most_state_bytes_;
  Steering steering_;
  bool has_goals_ = false;
  std::multimap<double, Batch> queue_;
  std::deque<Batch> stack_;
  std::vector<Batch> withdrawn_;
};

}  // namespace palpate
