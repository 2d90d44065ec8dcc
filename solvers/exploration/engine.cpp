// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/engine.h"

#include <algorithm>

#include "base/error.h"
#include "exploration/transfer.h"
#include "schedule/batch.h"

namespace palpate {
namespace {

/// So many tasks a rank share out evenly though they differ in length.
constexpr std::size_t kTasksOfRank = 8;

bool needs_no_start(const Transition& transition) { return transition.start == transition.target; }

Equilibrium to_equilibrium(Configuration&& c) {
  Equilibrium e;
  e.t = c.t;
  e.u = std::move(c.u);
  e.v = std::move(c.v);
  e.p = std::move(c.p);
  e.p_v = std::move(c.p_v);
  e.energy = c.energy;
  e.reaction = c.force;
  e.stiffness = c.stiffness;
  e.outcome = c.outcome;
  e.flags = c.flags;
  e.residual = c.residual;
  e.minimum_det_f = c.minimum_det_f;
  e.negative_pivots = c.negative_pivots;
  return e;
}

Configuration to_configuration(Equilibrium&& e, const Site& site, const Transition& transition) {
  Configuration c;
  c.check_point = transition.target;
  c.parent = transition.start;
  c.t = e.t;
  c.energy = e.energy;
  c.force = e.reaction;
  c.stiffness = e.stiffness;
  c.outcome = e.outcome;
  c.flags = e.flags;
  if (site.force_limit > 0 && c.force.norm() > site.force_limit) {
    c.flags |= flags::beyond_force_limit;
  }
  c.residual = e.residual;
  c.minimum_det_f = e.minimum_det_f;
  c.negative_pivots = e.negative_pivots;
  c.iterations = e.iterations;
  c.seconds = e.seconds;
  if (c.usable()) {
    c.u = std::move(e.u);
    c.v = std::move(e.v);
    c.p = std::move(e.p);
    c.p_v = std::move(e.p_v);
  }
  return c;
}

void count(const ConfigurationSummary& found, bool reused, PrecomputeReport& report) {
  ++(reused ? report.num_reused : report.num_solved);
  ++report.num_by_outcome[found.outcome];
  if (!reused) report.iterations += found.iterations;
  for (Flags bit = 1; bit <= flags::inertia_not_computed; bit *= 2) {
    if ((found.flags & bit) != 0) ++report.num_by_flag[bit];
  }
}

}  // namespace

Engine::Engine(const std::vector<Site>& sites, const Tip& tip, EquilibriumSolver& solver,
               Record& record, Communicator& communicator, Monitor& monitor)
    : solver_(solver),
      tip_(tip),
      record_(record),
      communicator_(communicator),
      monitor_(monitor),
      goes_deep_(communicator.size() == 1) {
  for (const Site& site : sites) site_of_node_[site.active_node] = site;
}

bool Engine::explore(Frontier& frontier, PrecomputeReport& report) {
  monitor_.expect(frontier.num_expected());
  recall(frontier, report);
  for (;;) {
    const std::vector<Transition> batch = frontier.next();
    give_up_settled(frontier, report);
    monitor_.set_done(report.num_solved + report.num_reused);
    if (any(communicator_, aborted_ || !monitor_.go_on())) return false;
    if (batch.empty()) return true;

    const auto num_ranks = static_cast<std::size_t>(communicator_.size());
    goes_deep_ = goes_deep_ || batch.size() >= kTasksOfRank * num_ranks;
    const std::vector<int> owners = share_out(batch, frontier);
    send_starts(batch, owners);
    const std::vector<Bytes> results =
        run_batch(communicator_, owners, [&](std::int64_t i) -> Bytes {
          Bytes found;
          walk(batch[i], start_of(batch[i]), frontier, found);
          return found;
        });
    for (std::size_t i = 0; i < results.size(); ++i) {
      take_in(results[i], owners[i], frontier, report);
    }
  }
}

/// Takes in what earlier runs have found, as rank 0 knows it.
void Engine::recall(Frontier& frontier, PrecomputeReport& report) {
  Bytes mine;
  agree(communicator_, [&] {
    for (const auto& [node, summary] : record_.known()) append(mine, node, summary);
  });
  for (const auto& [node, summary] : read_configurations(communicator_.all_gather(mine).front())) {
    frontier.accept(node, summary);
    count(summary, true, report);
    if (summary.usable()) found_[{node, summary.check_point}] = {summary, 0};
  }
}

/// Records the failures that are not to be tried again.
void Engine::give_up_settled(const Frontier& frontier, PrecomputeReport& report) {
  agree(communicator_, [&] {
    for (auto i = failed_.begin(); i != failed_.end();) {
      const auto& [key, found] = *i;
      if (frontier.is_settled(key.first, key.second)) {
        if (found.rank == communicator_.rank()) {
          record_.keep(key.first, {found.summary, {}, {}, {}, {}});
        }
        count(found.summary, false, report);
        i = failed_.erase(i);
      } else {
        ++i;
      }
    }
  });
}

/// Each rank gets a run of neighbours, by the number of configurations that they may lead to.
std::vector<int> Engine::share_out(const std::vector<Transition>& batch,
                                   const Frontier& frontier) const {
  std::vector<std::int64_t> sizes;
  std::int64_t total = 0;
  for (const Transition& transition : batch) {
    const bool whole = goes_deep_ && communicator_.size() > 1;
    total += sizes.emplace_back(whole ? frontier.num_following(transition) : 1);
  }
  std::vector<int> owners;
  std::int64_t before = 0;
  for (const std::int64_t size : sizes) {
    owners.push_back(static_cast<int>((2 * before + size) * communicator_.size() / (2 * total)));
    before += size;
  }
  return owners;
}

/// Gives each rank the starts of its tasks that others have.
void Engine::send_starts(const std::vector<Transition>& batch, const std::vector<int>& owners) {
  sent_.clear();
  std::set<Key> asked;
  std::set<Key> asked_here;
  for (std::size_t i = 0; i < batch.size(); ++i) {
    const Key key{batch[i].active_node, batch[i].start};
    if (needs_no_start(batch[i]) || found_.at(key).rank == owners[i]) continue;
    asked.insert(key);
    if (owners[i] == communicator_.rank()) asked_here.insert(key);
  }
  if (asked.empty()) return;
  const std::vector<Key> keys(asked.begin(), asked.end());
  std::vector<int> holders;
  for (const Key& key : keys) holders.push_back(found_.at(key).rank);
  const std::vector<Bytes> states = run_batch(communicator_, holders, [&](std::int64_t i) {
    Bytes state;
    append(state, keys[i].first, record_.load(keys[i].first, found_.at(keys[i]).summary));
    return state;
  });
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (asked_here.count(keys[i]) == 0) continue;
    sent_.emplace(keys[i], std::move(read_configurations(states[i]).front().configuration));
  }
}

Equilibrium Engine::start_of(const Transition& transition) const {
  if (needs_no_start(transition)) return {};
  const Key key{transition.active_node, transition.start};
  const auto sent = sent_.find(key);
  return to_equilibrium(sent != sent_.end()
                            ? Configuration(sent->second)
                            : record_.load(key.first, found_.at(key).summary));
}

/// Makes a transition and what follows from it.
void Engine::walk(const Transition& transition, const Equilibrium& start, const Frontier& frontier,
                  Bytes& results) {
  aborted_ = aborted_ || !monitor_.go_on();
  if (aborted_) return;
  Configuration found = make(transition, start, frontier);
  aborted_ = found.outcome == Outcome::aborted;
  if (aborted_) return;
  const Index node = transition.active_node;
  if (found.usable()) record_.keep(node, found);
  const ConfigurationSummary summary = found;
  append(results, node, summary);
  monitor_.solved_one();
  if (!goes_deep_ || !found.usable()) return;
  const Equilibrium next_start = to_equilibrium(std::move(found));
  for (const Transition& next : frontier.following(node, summary)) {
    walk(next, next_start, frontier, results);
  }
  solver_.forget(next_start);
}

/// @throws InputError the body is not held.
Configuration Engine::make(const Transition& transition, const Equilibrium& start,
                           const Frontier& frontier) {
  const Site& site = site_of_node_.at(transition.active_node);
  if (held_node_ != site.active_node) {
    solver_.hold(tip_.hold({site.active_node}));
    held_node_ = site.active_node;
  }
  if (needs_no_start(transition)) {
    Equilibrium rest = solver_.rest();
    if (rest.outcome != Outcome::converged) throw InputError(rest.message);
    return to_configuration(std::move(rest), site, transition);
  }
  const auto& [i, j, k] = transition.target;
  const Eigen::VectorXd t = site.spacing() * Vec3(i, j, k);
  const bool leads_on = frontier.num_following(transition) > 1;
  Configuration found = to_configuration(
      solver_.solve(t, start, leads_on ? Tangent::factorised : Tangent::iterated), site,
      transition);
  const auto earlier = failed_.find({site.active_node, transition.target});
  if (earlier != failed_.end()) {
    found.iterations += earlier->second.summary.iterations;
    found.seconds += earlier->second.summary.seconds;
  }
  return found;
}

/// Takes in what a task of another rank or of this one has found.
void Engine::take_in(const Bytes& results, int rank, Frontier& frontier,
                     PrecomputeReport& report) {
  for (const auto& [node, summary] : read_configurations(results)) {
    const Key key{node, summary.check_point};
    frontier.accept(node, summary);
    if (summary.usable()) {
      failed_.erase(key);
      found_[key] = {summary, rank};
      count(summary, false, report);
    } else {
      failed_[key] = {summary, rank};
    }
  }
}

}  // namespace palpate
