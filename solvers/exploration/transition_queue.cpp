// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/transition_queue.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace palpate {
namespace {

std::size_t bytes_of_state(const TransitionBatch& batch) {
  if (batch.state == nullptr) return 0;
  const Equilibrium& state = *batch.state;
  return static_cast<std::size_t>(state.u.size() + state.v.size() + state.p.size() +
                                  state.p_v.size()) *
         sizeof(double);
}

}  // namespace

void TransitionQueue::steer(Steering steering) {
  steering_ = std::move(steering);
  has_goals_ = steering_.has_goals();
  // Among batches of the same distance, those nearer to the top of the stack are made first.
  std::deque<Batch> stack = std::exchange(stack_, {});
  std::multimap<double, Batch> queue = std::exchange(queue_, {});
  std::vector<Batch> withdrawn = std::exchange(withdrawn_, {});
  if (has_goals_) {
    while (!stack.empty()) {
      enqueue(std::move(stack.back()));
      stack.pop_back();
    }
  }
  for (Batch& batch : stack) push(std::move(batch));
  for (auto& [distance, batch] : queue) enqueue(std::move(batch));
  for (Batch& batch : withdrawn) enqueue(std::move(batch));
}

void TransitionQueue::enqueue(Batch&& batch) {
  if (!withdraw(batch)) return;
  const double distance = rank_targets(batch);
  queue_.emplace(distance, std::move(batch));
}

void TransitionQueue::push(Batch&& batch) {
  if (has_goals_) {
    enqueue(std::move(batch));
  } else if (withdraw(batch)) {
    stack_.push_back(std::move(batch));
  }
  if (!steering_.spaces.empty()) forget_states();
}

bool TransitionQueue::withdraw(Batch& batch) {
  const auto is_withdrawn = [&](const TransitionTarget& target) {
    return steering_.withdraws(batch.tool_space, target.check_point);
  };
  const auto first =
      std::stable_partition(batch.targets.begin(), batch.targets.end(),
                            [&](const TransitionTarget& target) { return !is_withdrawn(target); });
  if (first == batch.targets.end()) return !batch.targets.empty();
  Batch aside{batch.tool_space,
              batch.start,
              batch.state,
              batch.is_recorded_here,
              {first, batch.targets.end()}};
  withdrawn_.push_back(std::move(aside));
  batch.targets.erase(first, batch.targets.end());
  return !batch.targets.empty();
}

double TransitionQueue::rank_targets(Batch& batch) const {
  const PlannedSpace& space = find_space(spaces_, batch.tool_space);
  if (!has_goals_) return space.plan->distance(batch.targets.front().check_point);
  std::vector<std::pair<double, TransitionTarget>> ranked;
  for (const TransitionTarget& target : batch.targets) {
    ranked.emplace_back(steering_.distance(space.setup, target.check_point), target);
  }
  std::stable_sort(ranked.begin(), ranked.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::transform(ranked.begin(), ranked.end(), batch.targets.begin(),
                 [](const auto& of_target) { return of_target.second; });
  return ranked.front().first;
}

void TransitionQueue::forget_states() {
  std::size_t bytes = 0;
  for (const Batch& batch : withdrawn_) bytes += bytes_of_state(batch);
  for (const auto& [distance, batch] : queue_) bytes += bytes_of_state(batch);
  const auto forget = [&](Batch& batch) {
    if (bytes <= most_state_bytes_ || !batch.is_recorded_here) return;
    bytes -= bytes_of_state(batch);
    batch.state.reset();
  };
  for (Batch& batch : withdrawn_) forget(batch);
  for (auto i = queue_.rbegin(); i != queue_.rend(); ++i) forget(i->second);
}

TransitionQueue::Batch TransitionQueue::take_next() {
  if (stack_.empty()) return std::move(queue_.extract(queue_.begin()).mapped());
  Batch next = std::move(stack_.back());
  stack_.pop_back();
  return next;
}

TransitionQueue::Batch& TransitionQueue::last() {
  return queue_.empty() ? stack_.front() : std::prev(queue_.end())->second;
}

TransitionQueue::Batch TransitionQueue::take_last() {
  Batch taken = std::move(last());
  if (queue_.empty()) {
    stack_.pop_front();
  } else {
    queue_.erase(std::prev(queue_.end()));
  }
  return taken;
}

bool TransitionQueue::last_needs_no_start() { return !queue_.empty() && !last().has_start(); }

std::vector<TransitionQueue::Batch> TransitionQueue::take_recorded_here() {
  std::vector<Batch> taken;
  const auto sort_out = [&](auto& batches) {
    auto all = std::exchange(batches, {});
    for (Batch& batch : all) {
      if (batch.is_recorded_here) {
        taken.push_back(std::move(batch));
      } else {
        batches.push_back(std::move(batch));
      }
    }
  };
  sort_out(stack_);
  sort_out(withdrawn_);
  for (auto i = queue_.begin(); i != queue_.end();) {
    if (i->second.is_recorded_here) taken.push_back(std::move(i->second));
    i = i->second.is_recorded_here ? queue_.erase(i) : std::next(i);
  }
  return taken;
}

void TransitionQueue::clear() {
  queue_.clear();
  stack_.clear();
  withdrawn_.clear();
}

}  // namespace palpate
