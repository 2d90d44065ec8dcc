// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/simulator.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <exception>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

#include "base/error.h"

namespace palpate {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

}  // namespace

// Simulation

class Simulation::RankNetwork final : public Network {
 public:
  RankNetwork(Simulation& simulation, int rank) : simulation_(simulation), rank_(rank) {}

  [[nodiscard]] int rank() const override { return rank_; }
  [[nodiscard]] int size() const override { return simulation_.size(); }
  void send(int to, int tag, Bytes content) override {
    simulation_.post(rank_, to, tag, std::move(content));
  }
  [[nodiscard]] std::optional<Message> receive() override {
    Rank& me = simulation_.ranks_[rank_];
    if (me.arrived.empty()) return std::nullopt;
    me.clock += simulation_.machine_.overhead;
    std::optional<Message> message = std::move(me.arrived.front());
    me.arrived.pop_front();
    return message;
  }
  void flush() override {}
  [[nodiscard]] double now() const override { return simulation_.now(rank_); }
  void rest(double /*until*/) override {}

 private:
  Simulation& simulation_;
  int rank_;
};

/// The earliest is the largest.
bool Simulation::Event::operator<(const Event& other) const {
  return time != other.time ? time > other.time : number > other.number;
}

Simulation::Simulation(int num_ranks, const Machine& machine)
    : machine_(machine), ranks_(static_cast<std::size_t>(num_ranks)), random_(mix(machine.seed)) {
  for (int r = 0; r < num_ranks; ++r) ranks_[r].network = std::make_unique<RankNetwork>(*this, r);
}

Simulation::~Simulation() = default;

void Simulation::spend(int rank, double seconds) { ranks_[rank].clock += seconds; }

void Simulation::burden(int rank, std::size_t bytes) { ranks_[rank].burden += bytes; }

double Simulation::now(int rank) const { return ranks_[rank].clock; }

std::size_t Simulation::num_under_way() const {
  std::size_t number = messages_.size() - free_.size();
  for (const Rank& rank : ranks_) number += rank.arrived.size();
  return number;
}

bool Simulation::run(const std::vector<Worker*>& workers, const ScheduleOptions& options) {
  std::vector<std::unique_ptr<Scheduler>> schedulers;
  for (int r = 0; r < size(); ++r) {
    schedulers.push_back(std::make_unique<Scheduler>(*workers[r], *ranks_[r].network, options));
    // As after the agreement at the end of a run.
    ranks_[r].clock = makespan_;
    ranks_[r].planned = kNever;
    plan(r, makespan_);
  }
  for (int num_left = size(); num_left > 0;) {
    const Event event = events_.top();
    events_.pop();
    Rank& rank = ranks_[event.rank];
    if (event.message >= 0) {
      rank.arrived.push_back(std::move(messages_[event.message]));
      free_.push_back(event.message);
      // A busy one takes its next step when it is done.
      if (rank.idle) plan(event.rank, std::max(rank.clock, event.time + machine_.reaction));
      continue;
    }
    if (event.time != rank.planned) continue;
    rank.planned = kNever;
    rank.clock = std::max(rank.clock, event.time);
    Scheduler& scheduler = *schedulers[event.rank];
    const Scheduler::Step step = scheduler.step();
    rank.idle = step == Scheduler::Step::idle;
    if (step == Scheduler::Step::over) {
      --num_left;
      makespan_ = std::max(makespan_, rank.clock);
    } else if (rank.idle && rank.arrived.empty()) {
      plan(event.rank, std::max(rank.clock, scheduler.idle_until()));
    } else {
      plan(event.rank, rank.clock);
    }
  }
  reports_.clear();
  for (const auto& scheduler : schedulers) reports_.push_back(scheduler->report());
  for (const auto& scheduler : schedulers) {
    if (scheduler->error()) std::rethrow_exception(scheduler->error());
  }
  return !schedulers.front()->stopped();
}

void Simulation::post(int from, int to, int tag, Bytes content) {
  Rank& sender = ranks_[from];
  sender.clock += machine_.overhead;
  const auto bytes = content.size() + kMessageBytes + std::exchange(sender.burden, 0);
  sender.out_is_free = std::max(sender.out_is_free, sender.clock) +
                       static_cast<double>(bytes) / machine_.bandwidth;
  double arrival = sender.out_is_free + machine_.latency;
  if (machine_.distance) arrival += machine_.distance(from, to);
  if (machine_.jitter > 0) {
    const double uniform = static_cast<double>(mix(++random_) >> 11) * 0x1p-53;
    arrival += machine_.jitter * std::pow(uniform, 16);
    const auto pair = static_cast<std::uint64_t>(from) * ranks_.size() + to;
    double& last = last_arrival_[pair];
    last = arrival = std::max(arrival, last);
  }
  if (free_.empty()) {
    free_.push_back(static_cast<std::int64_t>(messages_.size()));
    messages_.emplace_back();
  }
  const std::int64_t message = free_.back();
  free_.pop_back();
  messages_[message] = {from, tag, std::move(content)};
  add_event(arrival, to, message);
}

/// The next step of a rank comes at the earliest of the times.
void Simulation::plan(int rank, double time) {
  if (time >= ranks_[rank].planned) return;
  ranks_[rank].planned = time;
  add_event(time, rank, -1);
}

void Simulation::add_event(double time, int rank, std::int64_t message) {
  events_.push({time, num_events_++, rank, message});
}

// Forests

namespace {

ForestResult to_result(double makespan, double work, std::int64_t tasks, int num_ranks) {
  ForestResult result;
  result.makespan = makespan;
  result.work = work;
  result.tasks = tasks;
  result.efficiency = makespan > 0 ? work / (num_ranks * makespan) : 1;
  return result;
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

std::vector<Children> children_of(const Forest& forest) {
  std::vector<Children> children;
  for (const TaskTree& tree : forest.trees) children.emplace_back(tree);
  return children;
}

/// What does not change while a forest is simulated.
struct Replay {
  const Forest& forest;
  const ForestOptions& options;
  std::vector<Children> children;
  /// Ordered by the rank that has them at the start.
  std::vector<int> sites;
};

/// Tasks that wait: a range of the children of one task, or of Replay::sites where site < 0.
struct Range {
  int site;
  int first;
  int last;
  /// From another rank, and none of it was begun here.
  bool is_new = false;
};

class ForestWorker final : public Worker {
 public:
  ForestWorker(const Replay& replay, Simulation& simulation, int rank, const Range& own)
      : replay_(replay), simulation_(simulation), rank_(rank) {
    if (own.first < own.last) waiting_.push_back(own);
  }

  [[nodiscard]] double seconds() const { return seconds_; }
  [[nodiscard]] std::int64_t num_tasks() const { return num_tasks_; }

  void receive(int /*from*/, const Bytes& /*message*/, Mail& /*mail*/) override {}
  [[nodiscard]] bool has_work() const override { return site_ >= 0 || !waiting_.empty(); }

  /// Goes on with the task until it would poll: to the others it is the same whether the rank
  /// answers them within a task or between two slices of it.
  void work(Mail& mail) override {
    if (site_ < 0) begin();
    const double slice = std::min(left_, replay_.options.poll_interval);
    simulation_.spend(rank_, slice);
    left_ -= slice;
    if (left_ <= 0) end(mail);
  }

  [[nodiscard]] Bytes give() override {
    if (waiting_.empty()) return {};
    Range& far = waiting_.front();
    const bool is_last = waiting_.size() == 1 && far.last - far.first == 1;
    if (is_last && site_ < 0) return {};
    const Range given{far.site, far.last - (far.last - far.first + 1) / 2, far.last};
    far.last = given.first;
    if (far.first == far.last) waiting_.pop_front();
    if (given.site >= 0) simulation_.burden(rank_, replay_.options.state_bytes);
    Bytes bytes(sizeof given);
    std::memcpy(bytes.data(), &given, sizeof given);
    return bytes;
  }

  void take(const Bytes& share, Mail& /*mail*/) override {
    Range given{};
    std::memcpy(&given, share.data(), sizeof given);
    given.is_new = true;
    waiting_.push_back(given);
  }

  void discard() override { waiting_.clear(); }

 private:
  [[nodiscard]] int tree() const { return replay_.forest.tree_of_site[site_]; }
  [[nodiscard]] double cost() const { return replay_.forest.trees[tree()].seconds[task_]; }

  void begin() {
    Range& near = waiting_.back();
    site_ = near.site >= 0 ? near.site : replay_.sites[near.first];
    task_ = near.site >= 0 ? replay_.children[tree()].task[near.first] : 0;
    left_ = cost();
    if (near.is_new && near.site >= 0) left_ += replay_.options.start_seconds;
    near.is_new = false;
    if (++near.first == near.last) waiting_.pop_back();
  }

  void end(Mail& mail) {
    seconds_ += cost();
    ++num_tasks_;
    const Children& children = replay_.children[tree()];
    const Range next{site_, children.first[task_], children.first[task_ + 1]};
    if (next.first < next.last) waiting_.push_back(next);
    const auto key = (static_cast<std::uint64_t>(site_) << 32) + static_cast<std::uint64_t>(task_);
    mail.send_home(key, Bytes(replay_.options.summary_bytes));
    site_ = -1;
  }

  const Replay& replay_;
  Simulation& simulation_;
  const int rank_;
  /// The near end, at the back, comes next.
  std::deque<Range> waiting_;
  /// The task that is being executed; −1: none. And what is left of it, s.
  int site_ = -1;
  int task_ = 0;
  double left_ = 0;
  double seconds_ = 0;
  std::int64_t num_tasks_ = 0;
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
  std::vector<double> of_tree;
  for (const TaskTree& tree : trees) {
    of_tree.push_back(std::accumulate(tree.seconds.begin(), tree.seconds.end(), 0.0));
  }
  double work = 0;
  for (const int tree : tree_of_site) work += of_tree[tree];
  return work;
}

double Forest::critical_path() const {
  std::vector<double> of_tree;
  for (const TaskTree& tree : trees) {
    std::vector<double> until = tree.seconds;
    for (std::size_t i = 1; i < until.size(); ++i) until[i] += until[tree.parent[i]];
    of_tree.push_back(*std::max_element(until.begin(), until.end()));
  }
  double longest = 0;
  for (const int tree : tree_of_site) longest = std::max(longest, of_tree[tree]);
  return longest;
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

ForestResult simulate_tds(const Forest& forest, int num_ranks, const ForestOptions& options) {
  validate(forest);
  Replay replay{forest, options, children_of(forest), {}};
  std::vector<std::vector<int>> sites_of_rank(static_cast<std::size_t>(num_ranks));
  for (std::size_t site = 0; site < forest.tree_of_site.size(); ++site) {
    sites_of_rank[home_of(site, num_ranks)].push_back(static_cast<int>(site));
  }
  Simulation simulation(num_ranks, options.machine);
  std::vector<std::unique_ptr<ForestWorker>> workers;
  std::vector<Worker*> addresses;
  for (int r = 0; r < num_ranks; ++r) {
    const auto first = static_cast<int>(replay.sites.size());
    replay.sites.insert(replay.sites.end(), sites_of_rank[r].begin(), sites_of_rank[r].end());
    const auto last = static_cast<int>(replay.sites.size());
    workers.push_back(
        std::make_unique<ForestWorker>(replay, simulation, r, Range{-1, first, last}));
    addresses.push_back(workers.back().get());
  }
  simulation.run(addresses, options.schedule);

  double work = 0;
  std::int64_t num_tasks = 0;
  for (const auto& worker : workers) {
    work += worker->seconds();
    num_tasks += worker->num_tasks();
  }
  ForestResult result = to_result(simulation.makespan(), work, num_tasks, num_ranks);
  for (int r = 0; r < num_ranks; ++r) result.report += simulation.report(r);
  return result;
}

ForestResult simulate_static(const Forest& forest, int num_ranks, StaticShare share) {
  validate(forest);
  std::vector<double> of_rank(static_cast<std::size_t>(num_ranks), 0);
  for (std::size_t site = 0; site < forest.tree_of_site.size(); ++site) {
    const auto& seconds = forest.trees[forest.tree_of_site[site]].seconds;
    const std::size_t rank = share == StaticShare::by_hash
                                 ? static_cast<std::size_t>(home_of(site, num_ranks))
                                 : site % static_cast<std::size_t>(num_ranks);
    of_rank[rank] += std::accumulate(seconds.begin(), seconds.end(), 0.0);
  }
  return to_result(*std::max_element(of_rank.begin(), of_rank.end()), forest.work(),
                   forest.num_tasks(), num_ranks);
}

namespace {

/// Rank 0 and those that it hands tasks to. A processor and each direction of its connection serve
/// one message after the other.
class MasterWorker {
 public:
  MasterWorker(const Forest& forest, int num_ranks, const ForestOptions& options)
      : forest_(forest), options_(options), children_(children_of(forest)) {
    for (int worker = 1; worker < num_ranks; ++worker) idle_.push_back(worker);
    for (std::size_t site = 0; site < forest.tree_of_site.size(); ++site) {
      open_.push_back({static_cast<int>(site), 0});
    }
  }

  ForestResult run(int num_ranks) {
    hand_out();
    while (!done_.empty()) {
      const Done done = done_.top();
      done_.pop();
      take_in(done);
    }
    return to_result(is_free_, work_, num_tasks_, num_ranks);
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
    const int tree = forest_.tree_of_site[task.site];
    is_free_ += machine.overhead;
    out_is_free_ = std::max(out_is_free_, is_free_) + transfer(with_state);
    const double seconds = forest_.trees[tree].seconds[task.task];
    work_ += seconds;
    ++num_tasks_;
    // The worker waits for each task anew, and does not see it at once.
    const double done = out_is_free_ + machine.latency + machine.reaction + machine.overhead +
                        (with_state ? options_.start_seconds : 0) + seconds + machine.overhead +
                        machine.latency;
    done_.push({done, worker, task});
  }

  const Forest& forest_;
  const ForestOptions& options_;
  std::vector<Children> children_;
  std::deque<Task> open_;
  std::deque<int> idle_;
  std::priority_queue<Done> done_;
  double in_is_free_ = 0;
  double out_is_free_ = 0;
  double is_free_ = 0;
  double work_ = 0;
  std::int64_t num_tasks_ = 0;
};

}  // namespace

ForestResult simulate_master_worker(const Forest& forest, int num_ranks,
                                    const ForestOptions& options) {
  validate(forest);
  if (num_ranks == 1) return to_result(forest.work(), forest.work(), forest.num_tasks(), 1);
  return MasterWorker(forest, num_ranks, options).run(num_ranks);
}

}  // namespace palpate
