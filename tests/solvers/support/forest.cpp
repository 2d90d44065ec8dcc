// SPDX-License-Identifier: BSD-3-Clause
#include "solvers/support/forest.h"

#include <algorithm>
#include <deque>
#include <numeric>
#include <queue>
#include <string>

#include "base/error.h"

namespace palpate::test {
namespace {

double work_of(const TaskTree& tree) {
  return std::accumulate(tree.seconds.begin(), tree.seconds.end(), 0.0);
}

/// The children of each task of a tree, one behind the other.
struct Children {
  explicit Children(const TaskTree& tree)
      : first(tree.parent.size() + 1, 0), task(tree.parent.size() - 1) {
    for (std::size_t i = 1; i < tree.parent.size(); ++i) ++first[tree.parent[i] + 1];
    std::partial_sum(first.begin(), first.end(), first.begin());
    std::vector<int> next(first.begin(), first.end() - 1);
    for (std::size_t i = 1; i < tree.parent.size(); ++i) {
      task[next[tree.parent[i]]++] = static_cast<int>(i);
    }
  }
  /// Of task i: task[first[i]] … task[first[i + 1] − 1].
  std::vector<int> first;
  std::vector<int> task;
};

/// Rank 0 and those that it hands tasks to. A processor and each direction of its connection serve
/// one message after the other.
class Master {
 public:
  Master(const Forest& forest, int num_ranks, const MasterOptions& options)
      : forest_(forest), options_(options), children_(forest.trees.begin(), forest.trees.end()) {
    for (int worker = 1; worker < num_ranks; ++worker) idle_.push_back(worker);
    for (std::size_t site = 0; site < forest.tree_of_site.size(); ++site) {
      open_.push_back({static_cast<int>(site), 0});
    }
  }

  double run() {
    hand_out();
    while (!done_.empty()) {
      const Done done = done_.top();
      done_.pop();
      take_in(done);
    }
    return is_free_;
  }

 private:
  struct Task {
    int site;
    int task;
  };
  /// A message that has reached the master's connection.
  struct Done {
    double time;
    int worker;
    Task task;
    bool operator<(const Done& other) const {
      return time != other.time ? time > other.time : worker > other.worker;
    }
  };

  [[nodiscard]] double transfer(bool with_state) const {
    const std::size_t bytes =
        kMessageBytes + options_.summary_bytes + (with_state ? options_.state_bytes : 0);
    return static_cast<double>(bytes) / options_.machine.bandwidth;
  }

  void take_in(const Done& done) {
    const Children& children = children_[forest_.tree_of_site[done.task.site]];
    const int first = children.first[done.task.task];
    const int last = children.first[done.task.task + 1];
    in_is_free_ = std::max(in_is_free_, done.time) + transfer(last - first > 1);
    is_free_ = std::max(is_free_, in_is_free_) + options_.machine.overhead;
    for (int i = first + 1; i < last; ++i) open_.push_back({done.task.site, children.task[i]});
    if (first < last) {
      hand_out(done.worker, {done.task.site, children.task[first]}, false);
    } else {
      idle_.push_back(done.worker);
    }
    hand_out();
  }

  void hand_out() {
    while (!idle_.empty() && !open_.empty()) {
      hand_out(idle_.front(), open_.front(), open_.front().task > 0);
      idle_.pop_front();
      open_.pop_front();
    }
  }

  void hand_out(int worker, const Task& task, bool with_state) {
    const Machine& machine = options_.machine;
    const TaskTree& tree = forest_.trees[forest_.tree_of_site[task.site]];
    is_free_ += machine.overhead;
    out_is_free_ = std::max(out_is_free_, is_free_) + transfer(with_state);
    // The worker waits for each task anew, and does not see it at once.
    const double done = out_is_free_ + machine.latency + machine.reaction + machine.overhead +
                        (with_state ? options_.start_seconds : 0) + tree.seconds[task.task] +
                        machine.overhead + machine.latency;
    done_.push({done, worker, task});
  }

  const Forest& forest_;
  const MasterOptions& options_;
  std::vector<Children> children_;
  std::deque<Task> open_;
  std::deque<int> idle_;
  std::priority_queue<Done> done_;
  double in_is_free_ = 0;
  double out_is_free_ = 0;
  double is_free_ = 0;
};

}  // namespace

std::int64_t Forest::num_tasks() const {
  std::int64_t number = 0;
  for (const int tree : tree_of_site) {
    number += static_cast<std::int64_t>(trees[tree].seconds.size());
  }
  return number;
}

double Forest::work() const {
  double work = 0;
  for (const int tree : tree_of_site) work += work_of(trees[tree]);
  return work;
}

double Forest::critical_path() const {
  double longest = 0;
  for (const int tree_of_this : tree_of_site) {
    const TaskTree& tree = trees[tree_of_this];
    std::vector<double> until = tree.seconds;
    for (std::size_t i = 1; i < until.size(); ++i) until[i] += until[tree.parent[i]];
    longest = std::max(longest, *std::max_element(until.begin(), until.end()));
  }
  return longest;
}

double Forest::least_makespan(int num_ranks) const {
  return std::max(critical_path(), work() / num_ranks);
}

void validate(const Forest& forest) {
  for (std::size_t t = 0; t < forest.trees.size(); ++t) {
    const TaskTree& tree = forest.trees[t];
    const std::string name = "Tree " + std::to_string(t);
    if (tree.seconds.empty() || tree.seconds.size() != tree.parent.size()) {
      throw InputError(name + " has " + std::to_string(tree.seconds.size()) + " costs and " +
                       std::to_string(tree.parent.size()) +
                       " parents: give one of each a task, and one task at the least.");
    }
    for (std::size_t i = 0; i < tree.seconds.size(); ++i) {
      const int parent = tree.parent[i];
      const bool is_before = i == 0 ? parent == -1 : parent >= 0 && parent < static_cast<int>(i);
      if (!is_before) {
        throw InputError(name + ", task " + std::to_string(i) + ": its parent is task " +
                         std::to_string(parent) + ", which does not come before it.");
      }
      if (!(tree.seconds[i] >= 0)) {
        throw InputError(name + ", task " + std::to_string(i) + " takes " +
                         std::to_string(tree.seconds[i]) + " s: give a time of 0 or more.");
      }
    }
  }
  for (const int tree : forest.tree_of_site) {
    if (tree < 0 || tree >= static_cast<int>(forest.trees.size())) {
      throw InputError("A site has the tree " + std::to_string(tree) + ", of " +
                       std::to_string(forest.trees.size()) + '.');
    }
  }
}

double static_makespan(const Forest& forest, int num_ranks) {
  validate(forest);
  std::vector<double> of_rank(static_cast<std::size_t>(num_ranks), 0);
  for (std::size_t site = 0; site < forest.tree_of_site.size(); ++site) {
    of_rank[site % of_rank.size()] += work_of(forest.trees[forest.tree_of_site[site]]);
  }
  return *std::max_element(of_rank.begin(), of_rank.end());
}

double master_makespan(const Forest& forest, int num_ranks, const MasterOptions& options) {
  validate(forest);
  return num_ranks == 1 ? forest.work() : Master(forest, num_ranks, options).run();
}

}  // namespace palpate::test
