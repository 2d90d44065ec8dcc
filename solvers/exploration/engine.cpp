// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/engine.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "base/error.h"
#include "exploration/adaptive_grid.h"
#include "exploration/layered_grid.h"
#include "exploration/levelled_grid.h"
#include "schedule/home.h"

namespace palpate {
namespace {

enum class Kind : std::uint8_t {
  /// To a home: some of what an earlier run has left, which rank 0 has.
  recalled,
  /// To a home: a configuration that the sender has kept, or a failure.
  found,
  /// To the rank that has kept a candidate: the level that it has, if any.
  settle,
  /// To a holder of starts: batches.
  make,
  /// To rank 0: how far the sender's homes are.
  progress,
};

/// Transitions and configurations of an earlier run that a home is told at once.
constexpr std::size_t kRecalledAtOnce = 256;

std::uint64_t key_of(Index active_node) { return static_cast<std::uint64_t>(active_node); }

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

/// See ConfigurationSummary::signature.
Vec3 signature_of(const NodalVector& u) {
  constexpr std::uint64_t kSeed = 2007;
  const Eigen::Index num_points = u.size() / 3;
  Vec3 sum = Vec3::Zero();
  for (Eigen::Index p = 0; p < num_points; ++p) {
    const bool plus = (mix(kSeed + static_cast<std::uint64_t>(p)) & 1) != 0;
    sum += (plus ? 1 : -1) * u.segment<3>(3 * p);
  }
  return sum / std::sqrt(static_cast<double>(std::max<Eigen::Index>(num_points, 1)));
}

Configuration to_configuration(Equilibrium&& e) {
  Configuration c;
  c.t = e.t;
  c.energy = e.energy;
  c.force = e.reaction;
  c.stiffness = e.stiffness;
  if (e.third_derivative.size() > 0) c.third_derivative = e.third_derivative;
  c.outcome = e.outcome;
  c.flags = e.flags;
  c.residual = e.residual;
  c.minimum_det_f = e.minimum_det_f;
  c.negative_pivots = e.negative_pivots;
  c.iterations = e.iterations;
  c.seconds = e.seconds;
  if (c.usable()) {
    c.signature = signature_of(e.u);
    c.u = std::move(e.u);
    c.v = std::move(e.v);
    c.p = std::move(e.p);
    c.p_v = std::move(e.p_v);
  }
  return c;
}

bool is_beyond_limit(const Site& site, const Vec3& force) {
  return site.force_limit > 0 && force.norm() > site.force_limit;
}

void count(const ConfigurationSummary& found, bool reused, PrecomputeReport& report) {
  ++(reused ? report.num_reused : report.num_solved);
  ++report.num_by_outcome[found.outcome];
  if (!reused) report.iterations += found.iterations;
  for (Flags bit = 1; bit <= flags::all; bit *= 2) {
    if ((found.flags & bit) != 0) ++report.num_by_flag[bit];
  }
}

}  // namespace

Engine::Engine(const std::vector<Site>& sites, SiteSolver& solver, Record& record,
               const Network& network, Monitor& monitor, PrecomputeReport& report)
    : sites_(sites), solver_(solver), record_(record), monitor_(monitor), report_(report) {
  for (const Site& site : sites) {
    if (home_of(key_of(site.active_node), network.size()) != network.rank()) continue;
    auto& frontier = homes_[site.active_node].frontier;
    if (site.tolerance > 0) {
      frontier = std::make_unique<AdaptiveGrid>(site);
    } else if (site.history != History::flat) {
      frontier = std::make_unique<LevelledGrid>(site);
    } else {
      frontier = std::make_unique<LayeredGrid>(site);
    }
  }
}

const Site& Engine::site_of(Index active_node) const {
  return *std::lower_bound(sites_.begin(), sites_.end(), active_node,
                           [](const Site& site, Index node) { return site.active_node < node; });
}

void Engine::start(Mail& mail) {
  monitor_.set_mail(&mail);
  if (mail.rank() != 0) return;
  for (const Site& site : sites_) to_recall_.push_back(site.active_node);
}

/// Tells a home some of what is known of an active node, and with the last of it that it can begin.
void Engine::recall_some(Mail& mail) {
  const Index node = to_recall_.front();
  if (known_ == nullptr) known_ = std::make_unique<Known>(record_.known(node));
  Packer message;
  message.put(Kind::recalled);
  message.put(node);
  std::size_t left = kRecalledAtOnce;
  const auto put_some = [&](auto& known) {
    const std::size_t number = std::min(left, known.size());
    message.put(number);
    for (std::size_t i = 0; i < number; ++i) {
      message.put(known.back());
      known.pop_back();
    }
    left -= number;
  };
  put_some(known_->transitions);
  put_some(known_->configurations);
  const bool is_all = known_->transitions.empty() && known_->configurations.empty();
  message.put(is_all);
  mail.send_home(key_of(node), message.take());
  if (!is_all) return;
  known_.reset();
  to_recall_.pop_front();
}

/// At a home: what rank 0 knows.
void Engine::recall(Unpacker& content, Mail& mail) {
  const auto node = content.take<Index>();
  Home& home = homes_.at(node);
  for (auto left = content.take<std::size_t>(); left > 0; --left) {
    const auto transition = content.take<LevelTransition>();
    home.frontier->recall(transition);
    if (transition.reached == beyond_most_levels) ++report_.num_beyond_most_levels;
  }
  for (auto left = content.take<std::size_t>(); left > 0; --left) {
    const ConfigurationSummary summary = content.take<ConfigurationSummary>();
    home.frontier->recall(summary);
    if (summary.usable()) home.held[{summary.check_point, summary.level}] = {summary, 0};
    if (summary.level >= 0) count(summary, true, report_);
  }
  if (content.take<bool>()) hand_out(node, mail);
}

void Engine::receive(int from, const Bytes& message, Mail& mail) {
  Unpacker content(message);
  switch (content.take<Kind>()) {
    case Kind::recalled: recall(content, mail); break;
    case Kind::found: {
      const auto node = content.take<Index>();
      take_in(node, content.take<ConfigurationSummary>(), from, mail);
      break;
    }
    case Kind::settle: {
      const auto node = content.take<Index>();
      const ConfigurationSummary candidate = content.take<ConfigurationSummary>();
      record_.settle(node, candidate, content.take<std::int32_t>());
      break;
    }
    case Kind::make:
      while (!content.at_end()) batches_.push_front(unpack(content));
      break;
    case Kind::progress: monitor_.hear(from, content); break;
  }
}

void Engine::take_in(Index active_node, const ConfigurationSummary& found, int rank, Mail& mail) {
  Home& home = homes_.at(active_node);
  if (found.level < 0) {
    ++report_.num_transitions;
    if (found.usable()) home.held[{found.check_point, found.level}] = {found, rank};
  } else if (found.usable()) {
    home.failed.erase(found.check_point);
    home.held[{found.check_point, 0}] = {found, rank};
    count(found, false, report_);
  } else {
    home.failed[found.check_point] = found;
  }
  home.frontier->accept(found);
  hand_out(active_node, mail);
}

/// Records what a transition between levels has reached, and then has the candidate settled by the
/// rank that has kept it: one of a run that is killed in between is settled by the next.
void Engine::settle(Index active_node, Home& home, const Settlement& settlement, Mail& mail) {
  const LevelTransition& transition = settlement.transition;
  record_.keep(active_node, transition);
  if (transition.reached == beyond_most_levels) ++report_.num_beyond_most_levels;
  if (!settlement.has_candidate) return;
  const std::int32_t level =
      candidate_level(transition.start, transition.start_level, transition.target);
  const Held candidate = home.held.extract({transition.target, level}).mapped();
  if (settlement.is_new) {
    Held& held = home.held[{transition.target, transition.reached}];
    held = candidate;
    held.summary.level = transition.reached;
    ++report_.num_levels;
    count(held.summary, false, report_);
  }
  const std::int32_t given = settlement.is_new ? transition.reached : failed_to_reach;
  if (candidate.rank == mail.rank()) return record_.settle(active_node, candidate.summary, given);
  Packer message;
  message.put(Kind::settle);
  message.put(active_node);
  message.put(candidate.summary);
  message.put(given);
  mail.send(candidate.rank, message.take());
}

/// Sends what the frontier of a home asks for to those that have the starts, and records what it
/// has given up.
void Engine::hand_out(Index active_node, Mail& mail) {
  Home& home = homes_.at(active_node);
  const std::vector<Transition> due = home.frontier->next();
  report_.num_expected += home.frontier->num_expected() - home.num_expected;
  home.num_expected = home.frontier->num_expected();
  for (const Settlement& settlement : home.frontier->settled()) {
    settle(active_node, home, settlement, mail);
  }
  for (const CheckPoint& target : home.frontier->given_up()) {
    const auto failed = home.failed.find(target);
    if (failed == home.failed.end()) {
      ++num_not_reached_;
      continue;
    }
    record_.keep(active_node, {failed->second, {}, {}, {}, {}}, {});
    count(failed->second, false, report_);
    home.failed.erase(failed);
  }
  std::map<int, Packer> to_holders;
  for (std::size_t i = 0; i < due.size();) {
    const CheckPoint start = due[i].start;
    const std::int32_t start_level = due[i].start_level;
    Batch batch;
    batch.active_node = active_node;
    int holder = mail.rank();
    if (!due[i].needs_no_start()) {
      const Held& held = home.held.at({start, start_level});
      batch.start = held.summary;
      holder = held.rank;
    }
    const auto has_this_start = [&](const Transition& transition) {
      return transition.start == start && transition.start_level == start_level;
    };
    for (; i < due.size() && has_this_start(due[i]); ++i) {
      Target& target = batch.targets.emplace_back(Target{due[i].target});
      if (due[i].finds_candidate) {
        target.level = candidate_level(start, start_level, target.check_point);
        continue;
      }
      const auto failed = home.failed.find(target.check_point);
      if (failed == home.failed.end()) continue;
      target.iterations = failed->second.iterations;
      target.seconds = failed->second.seconds;
    }
    if (holder == mail.rank()) {
      batches_.push_front(std::move(batch));
    } else {
      const auto [message, is_new] = to_holders.try_emplace(holder);
      if (is_new) message->second.put(Kind::make);
      pack(batch, false, message->second);
    }
  }
  for (auto& [holder, message] : to_holders) mail.send(holder, message.take());
}

bool Engine::has_work() const { return !to_recall_.empty() || !batches_.empty(); }

void Engine::work(Mail& mail) {
  tell();
  if (!to_recall_.empty()) return recall_some(mail);
  current_ = std::move(batches_.back());
  batches_.pop_back();
  const Index node = current_->active_node;
  const Target target = current_->targets.front();
  current_->targets.pop_front();
  load_state(*current_);
  const std::shared_ptr<const Equilibrium> start = current_->state;
  Configuration found = make(*current_, target);
  if (found.outcome == Outcome::aborted) {
    current_.reset();
    return mail.stop();
  }
  if (found.usable()) {
    const std::vector<IntermediateState> way = make_way(*current_, found);
    if (!way.empty() && way.back().outcome == Outcome::aborted) {
      current_.reset();
      return mail.stop();
    }
    record_.keep(node, found, way);
  }
  const ConfigurationSummary summary = found;
  Packer message;
  message.put(Kind::found);
  message.put(node);
  message.put(summary);
  mail.send_home(key_of(node), message.take());

  if (!current_->targets.empty()) {
    batches_.push_back(std::move(*current_));
  } else if (start != nullptr) {
    solver_.forget(*start);
  }
  current_.reset();
  if (!summary.usable()) return;  // it has no state
  Batch next;
  next.active_node = node;
  next.start = summary;
  for (const CheckPoint& p : following(site_of(node), summary)) next.targets.push_back({p});
  const auto state = std::make_shared<const Equilibrium>(to_equilibrium(std::move(found)));
  if (next.targets.empty()) return solver_.forget(*state);
  next.state = state;
  batches_.push_back(std::move(next));
}

/// How far the homes here are.
void Engine::tell() {
  Packer message;
  message.put(Kind::progress);
  monitor_.tell({report_.num_solved + report_.num_reused, report_.num_reused,
                 report_.num_expected - num_not_reached_},
                std::move(message));
}

void Engine::load_state(Batch& batch) const {
  if (!batch.has_start() || batch.state != nullptr) return;
  batch.state = std::make_shared<const Equilibrium>(
      to_equilibrium(record_.load(batch.active_node, batch.start)));
}

/// @throws InputError the body is not held.
Configuration Engine::make(const Batch& batch, const Target& target) {
  const Site& site = site_of(batch.active_node);
  Configuration found;
  if (!batch.has_start()) {
    Equilibrium rest = solver_.rest(site.active_node);
    if (rest.outcome != Outcome::converged) throw InputError(rest.message);
    found = to_configuration(std::move(rest));
  } else {
    const auto& [i, j, k] = target.check_point;
    const Eigen::VectorXd t = site.spacing() * Vec3(i, j, k);
    ConfigurationSummary sought;
    sought.check_point = target.check_point;
    sought.outcome = Outcome::converged;
    const bool leads_on = target.level < 0 || !following(site, sought).empty();
    found = to_configuration(solver_.solve(site.active_node, t, *batch.state,
                                           leads_on ? Tangent::factorised : Tangent::iterated));
  }
  found.check_point = target.check_point;
  found.level = target.level;
  found.parent = batch.start.check_point;
  found.parent_level = batch.start.level;
  found.iterations += target.iterations;
  found.seconds += target.seconds;
  if (is_beyond_limit(site, found.force)) found.flags |= flags::beyond_force_limit;
  return found;
}

std::vector<IntermediateState> Engine::make_way(const Batch& batch,
                                                const ConfigurationSummary& found) {
  std::vector<IntermediateState> way;
  if (!batch.has_start() || found.level != 0) return way;
  const Site& site = site_of(batch.active_node);
  const Equilibrium& start = *batch.state;
  for (std::int32_t number = 1; number <= site.intermediate_states; ++number) {
    const double share = static_cast<double>(number) / (site.intermediate_states + 1);
    const Eigen::VectorXd t = start.t + share * (found.t - start.t);
    const Equilibrium between = solver_.solve(site.active_node, t, start, Tangent::rough);
    if (between.outcome == Outcome::converged) solver_.forget(between);
    IntermediateState& state = way.emplace_back();
    state.target = found.check_point;
    state.number = number;
    state.t = between.t;
    state.energy = between.energy;
    state.force = between.reaction;
    state.outcome = between.outcome;
    state.flags = between.flags;
    if (is_beyond_limit(site, state.force)) state.flags |= flags::beyond_force_limit;
    state.seconds = between.seconds;
    if (state.outcome == Outcome::aborted) break;
    ++report_.num_intermediate_states;
    if (!state.usable()) ++report_.num_intermediate_states_failed;
    report_.intermediate_seconds += state.seconds;
  }
  return way;
}

Bytes Engine::give() {
  Packer message;
  // Whole batches while there are others; what is left of the one that is made last of all.
  if (batches_.size() > (current_ ? 0 : 1)) {
    const auto from_rest = [](const Batch& batch) { return !batch.has_start(); };
    const std::size_t half = (batches_.size() + 1) / 2;
    std::size_t num = 0;
    while (num < half && from_rest(batches_[num])) ++num;
    num = std::max<std::size_t>(num, 1);
    for (; num > 0; --num) {
      pack(batches_.front(), true, message);
      batches_.pop_front();
    }
    return message.take();
  }
  Batch* last = current_ ? &*current_ : batches_.empty() ? nullptr : &batches_.front();
  if (last == nullptr || last->targets.size() < (current_ ? 1 : 2)) return {};
  Batch given = split(*last);
  pack(given, true, message);
  return message.take();
}

Engine::Batch Engine::split(Batch& batch) {
  Batch other{batch.active_node, batch.start, batch.state, {}};
  std::deque<Target> kept;
  bool keep = false;
  for (Target& target : batch.targets) {
    (keep ? kept : other.targets).push_back(target);
    keep = !keep;
  }
  batch.targets = std::move(kept);
  return other;
}

void Engine::take(const Bytes& tasks, Mail& /*mail*/) {
  for (Unpacker message(tasks); !message.at_end();) batches_.push_front(unpack(message));
}

void Engine::discard() {
  to_recall_.clear();
  batches_.clear();
}

void Engine::pack(Batch& batch, bool with_state, Packer& message) {
  message.put(batch.active_node);
  message.put(batch.start);
  const bool has_state = with_state && batch.has_start();
  message.put(has_state);
  if (has_state) {
    load_state(batch);
    ++report_.num_states_given;
    message.put(to_configuration(Equilibrium(*batch.state)));
  }
  message.put_list(batch.targets);
}

Engine::Batch Engine::unpack(Unpacker& message) {
  Batch batch;
  batch.active_node = message.take<Index>();
  batch.start = message.take<ConfigurationSummary>();
  if (message.take<bool>()) {
    batch.state =
        std::make_shared<const Equilibrium>(to_equilibrium(message.take<Configuration>()));
  }
  batch.targets = message.take_list<std::deque<Target>>();
  return batch;
}

}  // namespace palpate
