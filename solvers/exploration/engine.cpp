// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/engine.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "base/error.h"
#include "schedule/owner.h"

namespace palpate {
namespace {

enum class Kind : std::uint8_t {
  /// To an owner: some of what an earlier run has left, which rank 0 has.
  recalled,
  /// To an owner: a configuration that the sender has kept, or a failure.
  found,
  /// To the rank that has kept a candidate: the level that it has, if any.
  settle,
  /// To a holder of starts: batches.
  make,
  /// To rank 0: how far the tool spaces are that the sender owns.
  progress,
};

/// Transitions and configurations of an earlier run that an owner is told at once.
constexpr std::size_t kRecalledAtOnce = 256;

/// A tool space has one owned.
std::uint64_t owner_key(ToolSpaceId tool_space) { return static_cast<std::uint64_t>(tool_space); }

/// Calls visit(of equilibrium, of configuration) for each part that both have.
template <class OfEquilibrium, class OfConfiguration, class Visit>
void for_each_shared_part(OfEquilibrium& e, OfConfiguration& c, Visit&& visit) {
  visit(e.t, c.t);
  visit(e.u, c.u);
  visit(e.v, c.v);
  visit(e.p, c.p);
  visit(e.p_v, c.p_v);
  visit(e.energy, c.energy);
  visit(e.reaction, c.force);
  visit(e.stiffness, c.stiffness);
  visit(e.outcome, c.outcome);
  visit(e.flags, c.flags);
  visit(e.residual, c.residual);
  visit(e.minimum_det_f, c.minimum_det_f);
  visit(e.negative_pivots, c.negative_pivots);
  visit(e.iterations, c.iterations);
  visit(e.seconds, c.seconds);
}

Equilibrium to_equilibrium(Configuration&& c) {
  Equilibrium e;
  for_each_shared_part(e, c, [](auto& to, auto& from) { to = std::move(from); });
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
  for_each_shared_part(e, c, [](auto& from, auto& to) { to = std::move(from); });
  if (e.third_derivative.size() > 0) c.third_derivative = e.third_derivative;
  if (c.usable()) {
    c.signature = signature_of(c.u);
  } else {
    for_each_field(c, [](auto& field) { field = {}; });
  }
  return c;
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

Engine::Engine(const std::vector<ToolSpaceSetup>& setups, StateSolver& solver, Record& record,
               const Network& network, Monitor& monitor, PrecomputeReport& report)
    : setups_(setups), solver_(solver), record_(record), monitor_(monitor), report_(report) {
  for (const ToolSpaceSetup& setup : setups) {
    if (owner_of(owner_key(setup.id), network.size()) != network.rank()) continue;
    owned_[setup.id].strategy = make_strategy(setup);
  }
}

const ToolSpaceSetup& Engine::setup_of(ToolSpaceId tool_space) const {
  return *std::lower_bound(
      setups_.begin(), setups_.end(), tool_space,
      [](const ToolSpaceSetup& setup, ToolSpaceId id) { return setup.id < id; });
}

void Engine::start(Mail& mail) {
  monitor_.set_mail(&mail);
  if (mail.rank() != 0) return;
  for (const ToolSpaceSetup& setup : setups_) to_recall_.push_back(setup.id);
}

/// Tells an owner some of what is known of an active id, and with the last of it that it can begin.
void Engine::recall_some(Mail& mail) {
  const ToolSpaceId id = to_recall_.front();
  if (known_ == nullptr) known_ = std::make_unique<Known>(record_.known(id));
  Packer message;
  message.put(Kind::recalled);
  message.put(id);
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
  mail.send_to_owner(owner_key(id), message.take());
  if (!is_all) return;
  known_.reset();
  to_recall_.pop_front();
}

/// At an owner: what rank 0 knows.
void Engine::recall(Unpacker& content, Mail& mail) {
  const auto id = content.take<ToolSpaceId>();
  Owned& owned = owned_.at(id);
  for (auto left = content.take<std::size_t>(); left > 0; --left) {
    const auto transition = content.take<LevelTransition>();
    owned.strategy->recall(transition);
    if (transition.reached == beyond_most_levels) ++report_.num_beyond_most_levels;
  }
  for (auto left = content.take<std::size_t>(); left > 0; --left) {
    const ConfigurationSummary summary = content.take<ConfigurationSummary>();
    owned.strategy->recall(summary);
    if (summary.usable()) owned.held[key_of(id, summary)] = {summary, 0};
    if (summary.level >= 0) count(summary, true, report_);
  }
  if (content.take<bool>()) hand_out(id, mail);
}

void Engine::receive(int from, const Bytes& message, Mail& mail) {
  Unpacker content(message);
  switch (content.take<Kind>()) {
    case Kind::recalled: recall(content, mail); break;
    case Kind::found: {
      const auto id = content.take<ToolSpaceId>();
      take_in(id, content.take<ConfigurationSummary>(), from, mail);
      break;
    }
    case Kind::settle: {
      const auto id = content.take<ToolSpaceId>();
      const ConfigurationSummary candidate = content.take<ConfigurationSummary>();
      record_.settle(id, candidate, content.take<std::int32_t>());
      break;
    }
    case Kind::make:
      while (!content.at_end()) batches_.push_front(unpack(content));
      break;
    case Kind::progress: monitor_.hear(from, content); break;
  }
}

void Engine::take_in(ToolSpaceId tool_space, const ConfigurationSummary& found, int rank,
                     Mail& mail) {
  Owned& owned = owned_.at(tool_space);
  if (found.level < 0) {
    ++report_.num_transitions;
    if (found.usable()) owned.held[key_of(tool_space, found)] = {found, rank};
  } else if (found.usable()) {
    owned.failed.erase(found.check_point);
    owned.held[key_of(tool_space, found)] = {found, rank};
    count(found, false, report_);
  } else {
    owned.failed[found.check_point] = found;
  }
  owned.strategy->accept(found);
  hand_out(tool_space, mail);
}

/// Records what a transition between levels has reached, and then has the candidate settled by the
/// rank that has kept it: one of a run that is killed in between is settled by the next.
void Engine::settle(ToolSpaceId tool_space, Owned& owned, const Settlement& settlement,
                    Mail& mail) {
  const LevelTransition& transition = settlement.transition;
  record_.keep(tool_space, transition);
  if (transition.reached == beyond_most_levels) ++report_.num_beyond_most_levels;
  if (!settlement.has_candidate) return;
  const std::int32_t level =
      candidate_level(transition.start, transition.start_level, transition.target);
  const Held candidate = owned.held.extract({tool_space, transition.target, level}).mapped();
  if (settlement.is_new) {
    Held& held = owned.held[{tool_space, transition.target, transition.reached}];
    held = candidate;
    held.summary.level = transition.reached;
    ++report_.num_levels;
    count(held.summary, false, report_);
  }
  const std::int32_t given = settlement.is_new ? transition.reached : failed_to_reach;
  if (candidate.rank == mail.rank()) return record_.settle(tool_space, candidate.summary, given);
  Packer message;
  message.put(Kind::settle);
  message.put(tool_space);
  message.put(candidate.summary);
  message.put(given);
  mail.send(candidate.rank, message.take());
}

/// Sends what the strategy of a tool space asks for to those that have the starts, and records what
/// it has given up.
void Engine::hand_out(ToolSpaceId tool_space, Mail& mail) {
  Owned& owned = owned_.at(tool_space);
  const std::vector<Transition> due = owned.strategy->next();
  report_.num_expected += owned.strategy->num_expected() - owned.num_expected;
  owned.num_expected = owned.strategy->num_expected();
  for (const Settlement& settlement : owned.strategy->settled()) {
    settle(tool_space, owned, settlement, mail);
  }
  for (const CheckPoint& target : owned.strategy->given_up()) {
    const auto failed = owned.failed.find(target);
    if (failed == owned.failed.end()) {
      ++num_not_reached_;
      continue;
    }
    record_.keep(tool_space, {failed->second, {}, {}, {}, {}}, {});
    count(failed->second, false, report_);
    owned.failed.erase(failed);
  }
  std::map<int, Packer> to_holders;
  for (std::size_t i = 0; i < due.size();) {
    const CheckPoint start = due[i].start;
    const std::int32_t start_level = due[i].start_level;
    Batch batch;
    batch.tool_space = tool_space;
    int holder = mail.rank();
    if (!due[i].needs_no_start()) {
      const Held& held = owned.held.at({tool_space, start, start_level});
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
      const auto failed = owned.failed.find(target.check_point);
      if (failed == owned.failed.end()) continue;
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
  const ToolSpaceId id = current_->tool_space;
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
    record_.keep(id, found, way);
  }
  const ConfigurationSummary summary = found;
  Packer message;
  message.put(Kind::found);
  message.put(id);
  message.put(summary);
  mail.send_to_owner(owner_key(id), message.take());

  if (!current_->targets.empty()) {
    batches_.push_back(std::move(*current_));
  } else if (start != nullptr) {
    solver_.forget(*start);
  }
  current_.reset();
  if (!summary.usable()) return;  // it has no state
  Batch next;
  next.tool_space = id;
  next.start = summary;
  for (const CheckPoint& p : following(setup_of(id), summary)) next.targets.push_back({p});
  const auto state = std::make_shared<const Equilibrium>(to_equilibrium(std::move(found)));
  if (next.targets.empty()) return solver_.forget(*state);
  next.state = state;
  batches_.push_back(std::move(next));
}

/// Tells how far the tool spaces are that this rank owns.
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
      to_equilibrium(record_.load(batch.tool_space, batch.start)));
}

/// @throws InputError the body is not held.
Configuration Engine::make(const Batch& batch, const Target& target) {
  const ToolSpaceSetup& setup = setup_of(batch.tool_space);
  Configuration found;
  if (!batch.has_start()) {
    Equilibrium rest = solver_.rest(setup);
    if (rest.outcome != Outcome::converged) throw InputError(rest.message);
    found = to_configuration(std::move(rest));
  } else {
    const Eigen::VectorXd t = setup.grid.place(target.check_point);
    ConfigurationSummary sought;
    sought.check_point = target.check_point;
    sought.outcome = Outcome::converged;
    const bool leads_on = target.level < 0 || !following(setup, sought).empty();
    found = to_configuration(
        solver_.solve(setup, t, *batch.state, leads_on ? Tangent::factorised : Tangent::iterated));
  }
  found.check_point = target.check_point;
  found.level = target.level;
  found.parent = batch.start.check_point;
  found.parent_level = batch.start.level;
  found.iterations += target.iterations;
  found.seconds += target.seconds;
  if (setup.policy.is_beyond_limit(found.force)) found.flags |= flags::beyond_force_limit;
  return found;
}

std::vector<IntermediateState> Engine::make_way(const Batch& batch,
                                                const ConfigurationSummary& found) {
  std::vector<IntermediateState> way;
  if (!batch.has_start() || found.level != 0) return way;
  const ToolSpaceSetup& setup = setup_of(batch.tool_space);
  const Equilibrium& start = *batch.state;
  for (std::int32_t number = 1; number <= setup.policy.intermediate_states; ++number) {
    const double share = static_cast<double>(number) / (setup.policy.intermediate_states + 1);
    const Eigen::VectorXd t = start.t + share * (found.t - start.t);
    const Equilibrium between = solver_.solve(setup, t, start, Tangent::rough);
    if (between.outcome == Outcome::converged) solver_.forget(between);
    IntermediateState& state = way.emplace_back();
    state.target = found.check_point;
    state.number = number;
    state.t = between.t;
    state.energy = between.energy;
    state.force = between.reaction;
    state.outcome = between.outcome;
    state.flags = between.flags;
    if (setup.policy.is_beyond_limit(state.force)) state.flags |= flags::beyond_force_limit;
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
  Batch other{batch.tool_space, batch.start, batch.state, {}};
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
  message.put(batch.tool_space);
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
  batch.tool_space = message.take<ToolSpaceId>();
  batch.start = message.take<ConfigurationSummary>();
  if (message.take<bool>()) {
    batch.state =
        std::make_shared<const Equilibrium>(to_equilibrium(message.take<Configuration>()));
  }
  batch.targets = message.take_list<std::deque<Target>>();
  return batch;
}

}  // namespace palpate
