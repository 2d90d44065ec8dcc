// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/engine.h"

#include <algorithm>
#include <cstdint>
#include <iterator>

#include "base/error.h"
#include "base/memory_error.h"
#include "exploration/conversion.h"
#include "exploration/make_configuration.h"
#include "schedule/owner.h"

namespace palpate {
namespace {

enum class Kind : std::uint8_t {
  /// To an owner: configurations and transitions of earlier runs, from rank 0.
  recalled,
  /// To an owner: a configuration that the sender has kept, or a failure.
  found,
  /// To the rank whose record has a candidate: the level that the candidate gets, or that it is
  /// removed.
  settle,
  /// To a rank whose record has starts: batches of transitions from these.
  make,
  /// To an owner: a question.
  ask,
  /// To a rank: the steering that is to be followed.
  steer,
  /// To rank 0: the progress of the tool spaces that the sender owns.
  progress,
};
[[nodiscard]] bool is_sound(Kind kind) { return kind >= Kind::recalled && kind <= Kind::progress; }

/// A file may hold more levels than a run makes, but candidate_level() has to fit its number.
constexpr std::int32_t kLevelLimit = 1 << 20;

/// Of what another rank says, numbers become places in lists: they have to be in their range.
/// @throws BackendError one is not.
void require_possible(const Grid& grid, const CheckPoint& p, std::int32_t level) {
  Unpacker::require(std::all_of(
      p.begin(), p.end(), [&](std::int32_t x) { return x >= -grid.reach() && x <= grid.reach(); }));
  constexpr std::int32_t kLeast = -num_neighbours * kLevelLimit;
  Unpacker::require(level >= kLeast && level < kLevelLimit);
}
void require_reached(std::int32_t level) {
  Unpacker::require(level >= beyond_most_levels && level < kLevelLimit);
}
void require_possible(const Grid& grid, const ConfigurationSummary& summary) {
  require_possible(grid, summary.check_point, summary.level);
  require_possible(grid, summary.parent, summary.parent_level);
  for (const std::int32_t level : summary.reached) require_reached(level);
}

/// The number of transitions and configurations of earlier runs that one task tells the owners.
constexpr std::size_t kRecalledAtOnce = 256;

void count(const ConfigurationSummary& found, bool reused, PrecomputeReport& report) {
  ++(reused ? report.num_reused : report.num_solved);
  ++report.num_by_outcome[found.outcome];
  if (!reused) report.iterations += found.iterations;
  for (Flags bit = 1; bit <= flags::all; bit *= 2) {
    if ((found.flags & bit) != 0) ++report.num_by_flag[bit];
  }
}

}  // namespace

Engine::Engine(const std::vector<PlannedSpace>& spaces, StateSolver& solver, Record& record,
               const Network& network, Monitor& monitor, PrecomputeReport& report)
    : spaces_(spaces),
      rank_(network.rank()),
      num_ranks_(network.size()),
      solver_(solver),
      record_(record),
      monitor_(monitor),
      report_(report),
      queue_(spaces) {
  for (const auto& [setup, plan] : spaces) {
    const bool is_here = owner_of(plan->owner_key(setup.key(), {}), num_ranks_) == rank_;
    if (!plan->is_spread() && !is_here) continue;
    owned_[setup.key()].strategy = plan->make_strategy(rank_, num_ranks_);
  }
}

void Engine::plan_anew(const ToolSpaceKey& tool_space) {
  begin_ = Begin::plan;
  const auto found = owned_.find(tool_space);
  if (found == owned_.end()) return;
  Owned& owned = found->second;
  owned.strategy = space(tool_space).plan->make_strategy(rank_, num_ranks_);
  owned.num_expected = 0;
  for (const ConfigurationSummary& c : owned.known) owned.strategy->recall(c);
}

void Engine::steer(Steering steering) {
  steering_version_ = {steering_version_.first + 1, rank_};
  queue_.steer(steering);
  to_send_ = std::move(steering);
  if (monitor_.mail() != nullptr) send_steering(*monitor_.mail());
}

void Engine::send_steering(Mail& mail) {
  Packer message;
  message.put(Kind::steer);
  message.put(steering_version_);
  message.put(*to_send_);
  const Bytes bytes = message.take();
  for (int rank = 0; rank < num_ranks_; ++rank) {
    if (rank != rank_) mail.send(rank, bytes);
  }
  to_send_.reset();
}

void Engine::hear_steering(Unpacker& content) {
  const auto version = content.take<std::pair<std::int64_t, int>>();
  if (version < steering_version_) return;
  steering_version_ = version;
  queue_.steer(content.take<Steering>());
}

void Engine::move_records_to_first_rank() {
  for (auto& [id, owned] : owned_) {
    for (auto& [key, located] : owned.located) located.rank = 0;
  }
  if (rank_ != 0) moved_ = queue_.take_recorded_here();
}

void Engine::start(Mail& mail) {
  monitor_.set_mail(&mail);
  if (to_send_) send_steering(mail);
  for (Batch& batch : std::exchange(moved_, {})) {
    Packer message;
    message.put(Kind::make);
    pack(batch, false, message);
    mail.send(0, message.take());
  }
  switch (std::exchange(begin_, Begin::resume)) {
    case Begin::recall:
      if (rank_ != 0) return;
      for (const PlannedSpace& space : spaces_) to_recall_.push_back(space.setup.key());
      return;
    case Begin::plan:
      for (auto& [id, owned] : owned_) send_transitions(id, mail);
      return;
    case Begin::resume: return;
  }
}

/// Tells the owners a few configurations and transitions of earlier runs. The last message of a
/// tool space says that the owners can begin with it.
void Engine::recall_some(Mail& mail) {
  const ToolSpaceKey id = to_recall_.front();
  if (known_ == nullptr) known_ = std::make_unique<Known>(record_.known(id));
  std::map<int, Known> parts;
  std::size_t left = kRecalledAtOnce;
  const auto owner = [&](const CheckPoint& p) { return owner_of(owner_key(id, p), mail.size()); };
  for (; left > 0 && !known_->transitions.empty(); --left) {
    const LevelTransition transition = known_->transitions.back();
    parts[owner(transition.target)].transitions.push_back(transition);
    known_->transitions.pop_back();
  }
  for (; left > 0 && !known_->configurations.empty(); --left) {
    const ConfigurationSummary found = known_->configurations.back();
    parts[owner(found.check_point)].configurations.push_back(found);
    known_->configurations.pop_back();
  }
  const bool is_all = known_->transitions.empty() && known_->configurations.empty();
  if (is_all && space(id).plan->is_spread()) {
    for (int rank = 0; rank < mail.size(); ++rank) parts[rank];
  } else if (is_all) {
    parts[owner({})];
  }
  for (const auto& [rank, part] : parts) {
    Packer message;
    message.put(Kind::recalled);
    message.put(id);
    message.put_list(part.transitions);
    message.put_list(part.configurations);
    message.put(is_all);
    mail.send(rank, message.take());
  }
  if (!is_all) return;
  known_.reset();
  to_recall_.pop_front();
}

ToolSpaceKey Engine::take_space(Unpacker& content) const {
  const auto id = content.take<ToolSpaceKey>();
  Unpacker::require(has_space(spaces_, id));
  return id;
}

ToolSpaceKey Engine::take_owned_space(Unpacker& content) const {
  const auto id = content.take<ToolSpaceKey>();
  Unpacker::require(owned_.count(id) > 0);
  return id;
}

ConfigurationSummary Engine::take_summary(Unpacker& content, ToolSpaceKey tool_space) const {
  auto summary = content.take<ConfigurationSummary>();
  require_possible(setup_of(tool_space).grid, summary);
  return summary;
}

/// Takes in, at an owner, what rank 0 tells of earlier runs.
void Engine::recall(Unpacker& content, Mail& mail) {
  const auto id = take_owned_space(content);
  const Grid& grid = setup_of(id).grid;
  Owned& owned = owned_.at(id);
  const bool is_spread = space(id).plan->is_spread();
  for (const auto& transition : content.take_list<std::vector<LevelTransition>>()) {
    require_possible(grid, transition.start, transition.start_level);
    require_possible(grid, transition.target, 0);
    require_reached(transition.reached);
    owned.strategy->recall(transition);
    if (is_spread) owned.recalled.push_back(transition);
    if (transition.reached == beyond_most_levels) ++report_.num_beyond_most_levels;
  }
  for (const auto& summary : content.take_list<std::vector<ConfigurationSummary>>()) {
    require_possible(grid, summary);
    owned.strategy->recall(summary);
    if (summary.usable()) owned.located[key_of(id, summary)] = {summary, 0};
    if (is_spread) owned.known.push_back(summary);
    if (summary.level >= 0) count(summary, true, report_);
  }
  if (!content.take<bool>()) return;
  owned.has_recalled = true;
  for (const ConfigurationSummary& found : owned.known) {
    if (found.level == 0) answer_waiting(id, owned, found, true, mail);
  }
  for (const Question& question : std::exchange(owned.postponed, {})) hear(id, question, mail);
  send_transitions(id, mail);
}

void Engine::receive(int from, const Bytes& message, Mail& mail) {
  Unpacker content(message);
  switch (content.take<Kind>()) {
    case Kind::recalled: recall(content, mail); break;
    case Kind::found: {
      const auto id = take_owned_space(content);
      take_in(id, take_summary(content, id), from, mail);
      break;
    }
    case Kind::settle: {
      const auto id = take_space(content);
      const ConfigurationSummary candidate = take_summary(content, id);
      record_.settle(id, candidate, content.take<std::int32_t>());
      break;
    }
    case Kind::make:
      while (!content.at_end()) queue_.enqueue(unpack(content));
      break;
    case Kind::ask: {
      const auto id = take_owned_space(content);
      const auto question = content.take<Question>();
      require_possible(setup_of(id).grid, question.start, 0);
      require_possible(setup_of(id).grid, question.target.check_point, question.target.level);
      hear(id, question, mail);
      break;
    }
    case Kind::steer: hear_steering(content); break;
    case Kind::progress: monitor_.hear(from, content); break;
  }
}

void Engine::ask(ToolSpaceKey tool_space, const CheckPoint& of, const Question& question,
                 Mail& mail) {
  Packer message;
  message.put(Kind::ask);
  message.put(tool_space);
  message.put(question);
  mail.send_to_owner(owner_key(tool_space, of), message.take());
}

void Engine::hear(ToolSpaceKey tool_space, const Question& question, Mail& mail) {
  Owned& owned = owned_.at(tool_space);
  if (!owned.has_recalled) return owned.postponed.push_back(question);
  const CheckPoint& target = question.target.check_point;
  const CheckPoint& start = question.start;
  switch (question.kind) {
    case Question::Kind::request: {
      const auto ended = owned.ended.find(start);
      const auto located = owned.located.find({tool_space, start, 0});
      if (ended != owned.ended.end()) {
        Question answer = question;
        answer.kind = Question::Kind::refusal;
        answer.beyond_limit = ended->second;
        ask(tool_space, target, answer, mail);
      } else if (located != owned.located.end()) {
        ready_[{tool_space, start}].push_back(question.target);
      } else {
        owned.waiting[start].push_back(question.target);
      }
      return;
    }
    case Question::Kind::refusal:
      owned.strategy->refuse(target, start, question.beyond_limit);
      return send_transitions(tool_space, mail);
    case Question::Kind::offer:
      owned.strategy->offer(target, start);
      return send_transitions(tool_space, mail);
  }
}

void Engine::send_ready(Mail& mail) {
  for (const auto& [of, targets] : std::exchange(ready_, {})) {
    const auto& [tool_space, start] = of;
    send(tool_space, owned_.at(tool_space).located.at({tool_space, start, 0}), targets, mail);
  }
}

void Engine::answer_waiting(ToolSpaceKey tool_space, Owned& owned,
                            const ConfigurationSummary& found, bool is_recalled, Mail& mail) {
  const CheckPoint& start = found.check_point;
  const std::vector<Target> waiting = std::exchange(owned.waiting[start], {});
  owned.waiting.erase(start);
  Question question;
  question.start = start;
  // Finds the targets that would follow if this start were sound.
  ConfigurationSummary leading = found;
  leading.outcome = Outcome::converged;
  leading.flags = 0;
  if (found.leads_on()) {
    if (!waiting.empty())
      send(tool_space, owned.located.at(key_of(tool_space, found)), waiting, mail);
    if (!is_recalled) return;
    question.kind = Question::Kind::offer;
  } else {
    question.kind = Question::Kind::refusal;
    bool& beyond_limit = owned.ended[start];
    beyond_limit = beyond_limit || found.usable();
    question.beyond_limit = beyond_limit;
    for (const Target& target : waiting) {
      question.target = target;
      ask(tool_space, target.check_point, question, mail);
    }
  }
  for (const CheckPoint& target : space(tool_space).plan->following(leading)) {
    question.target = {target};
    ask(tool_space, target, question, mail);
  }
}

void Engine::send(ToolSpaceKey tool_space, const Located& start, const std::vector<Target>& targets,
                  Mail& mail) {
  Batch batch;
  batch.tool_space = tool_space;
  batch.start = start.summary;
  batch.targets.assign(targets.begin(), targets.end());
  if (start.rank == mail.rank()) return queue_.enqueue(std::move(batch));
  Packer message;
  message.put(Kind::make);
  pack(batch, false, message);
  mail.send(start.rank, message.take());
}

void Engine::take_in(ToolSpaceKey tool_space, const ConfigurationSummary& found, int rank,
                     Mail& mail) {
  Owned& owned = owned_.at(tool_space);
  if (found.level < 0) {
    ++report_.num_transitions;
    if (found.usable()) owned.located[key_of(tool_space, found)] = {found, rank};
    if (space(tool_space).plan->is_spread()) owned.known.push_back(found);
  } else if (found.usable()) {
    owned.failed.erase(found.check_point);
    owned.located[key_of(tool_space, found)] = {found, rank};
    count(found, false, report_);
    if (space(tool_space).plan->is_spread()) {
      owned.known.push_back(found);
      answer_waiting(tool_space, owned, found, false, mail);
    }
  } else {
    owned.failed[found.check_point] = found;
  }
  owned.strategy->accept(found);
  send_transitions(tool_space, mail);
}

/// Records first which level a transition has reached, and then has the candidate settled by the
/// rank that keeps it. If the run is killed in between, the next run settles the candidate.
void Engine::settle(ToolSpaceKey tool_space, Owned& owned, const Settlement& settlement,
                    Mail& mail) {
  const LevelTransition& transition = settlement.transition;
  record_.keep(tool_space, transition);
  if (transition.reached == beyond_most_levels) ++report_.num_beyond_most_levels;
  if (!settlement.has_candidate) return;
  const std::int32_t level =
      candidate_level(transition.start, transition.start_level, transition.target);
  const Located candidate = owned.located.extract({tool_space, transition.target, level}).mapped();
  if (settlement.is_new) {
    Located& settled = owned.located[{tool_space, transition.target, transition.reached}];
    settled = candidate;
    settled.summary.level = transition.reached;
    ++report_.num_levels;
    count(settled.summary, false, report_);
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

Engine::Target Engine::target_of(const Owned& owned, const Transition& transition) {
  Target target{transition.target};
  if (transition.finds_candidate) {
    target.level = level_of(transition);
    return target;
  }
  const auto failed = owned.failed.find(target.check_point);
  if (failed == owned.failed.end()) return target;
  target.iterations = failed->second.iterations;
  target.seconds = failed->second.seconds;
  return target;
}

void Engine::send_transitions(ToolSpaceKey tool_space, Mail& mail) {
  Owned& owned = owned_.at(tool_space);
  const std::vector<Transition> asked = owned.strategy->next();
  report_.num_expected += owned.strategy->num_expected() - owned.num_expected;
  owned.num_expected = owned.strategy->num_expected();
  for (const Settlement& settlement : owned.strategy->settled()) {
    settle(tool_space, owned, settlement, mail);
  }
  const bool is_spread = space(tool_space).plan->is_spread();
  for (const CheckPoint& target : owned.strategy->given_up()) {
    ConfigurationSummary found;
    found.check_point = target;
    const auto failed = owned.failed.find(target);
    if (failed == owned.failed.end()) {
      ++num_not_reached_;
    } else {
      found = failed->second;
      record_.keep(tool_space, {found, {}, {}, {}, {}}, {});
      count(found, false, report_);
      owned.failed.erase(failed);
    }
    if (!is_spread) continue;
    owned.known.push_back(found);
    owned.ended[target] = owned.strategy->is_beyond_limit(target);
    answer_waiting(tool_space, owned, found, false, mail);
  }
  std::map<int, Packer> to_holders;
  for (std::size_t i = 0; i < asked.size();) {
    const CheckPoint start = asked[i].start;
    const std::int32_t start_level = asked[i].start_level;
    // A transition between levels is asked for where its start is known.
    if (is_spread && !asked[i].needs_no_start() && !asked[i].finds_candidate) {
      Question question;
      question.start = start;
      question.target = target_of(owned, asked[i]);
      ask(tool_space, start, question, mail);
      ++i;
      continue;
    }
    Batch batch;
    batch.tool_space = tool_space;
    int holder = mail.rank();
    if (!asked[i].needs_no_start()) {
      const Located& at = owned.located.at({tool_space, start, start_level});
      batch.start = at.summary;
      holder = at.rank;
    }
    const auto has_this_start = [&](const Transition& transition) {
      return transition.start == start && transition.start_level == start_level;
    };
    for (; i < asked.size() && has_this_start(asked[i]); ++i) {
      batch.targets.push_back(target_of(owned, asked[i]));
    }
    if (holder == mail.rank()) {
      queue_.enqueue(std::move(batch));
    } else {
      const auto [message, is_new] = to_holders.try_emplace(holder);
      if (is_new) message->second.put(Kind::make);
      pack(batch, false, message->second);
    }
  }
  for (auto& [holder, message] : to_holders) mail.send(holder, message.take());
}

bool Engine::has_work() const { return !to_recall_.empty() || !ready_.empty() || !queue_.empty(); }

void Engine::work(Mail& mail) {
  tell();
  if (!to_recall_.empty()) return recall_some(mail);
  if (!ready_.empty()) return send_ready(mail);
  current_ = queue_.take_next();
  const ToolSpaceKey id = current_->tool_space;
  const Target target = current_->targets.front();
  current_->targets.pop_front();
  load_state(*current_);
  const std::shared_ptr<const Equilibrium> start = current_->state;
  Configuration found =
      with_memory("to solve for a configuration", [&] { return make(*current_, target); });
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
  mail.send_to_owner(owner_key(id, summary.check_point), message.take());

  if (!current_->targets.empty()) {
    queue_.push(std::move(*current_));
  } else if (start != nullptr) {
    solver_.forget(setup_of(id), *start);
  }
  current_.reset();
  if (!summary.usable()) return;  // without a state nothing follows from it
  Batch next;
  next.tool_space = id;
  next.start = summary;
  for (const CheckPoint& p : space(id).plan->following(summary)) next.targets.push_back({p});
  const auto state = std::make_shared<const Equilibrium>(to_equilibrium(std::move(found)));
  if (next.targets.empty()) return solver_.forget(setup_of(id), *state);
  next.state = state;
  queue_.push(std::move(next));
}

/// Reports the progress of the tool spaces that this rank owns.
void Engine::tell() {
  Packer message;
  message.put(Kind::progress);
  monitor_.tell({report_.num_solved + report_.num_reused, report_.num_reused,
                 report_.num_expected - num_not_reached_},
                std::move(message));
}

void Engine::load_state(Batch& batch) {
  if (!batch.has_start() || batch.state != nullptr) return;
  Equilibrium state = to_equilibrium(record_.load(batch.tool_space, batch.start));
  const Keep kept = record_.kept(batch.tool_space, batch.start);
  if (kept < Keep::all) state = solver_.restore(setup_of(batch.tool_space), state, kept);
  batch.state = std::make_shared<const Equilibrium>(std::move(state));
}

/// @throws InputError the body is not held.
Configuration Engine::make(const Batch& batch, const Target& target) {
  const auto& [setup, plan] = space(batch.tool_space);
  ConfigurationSummary sought;
  sought.check_point = target.check_point;
  sought.outcome = Outcome::converged;
  const bool leads_on = target.level < 0 || !plan->following(sought).empty();
  const Tangent tangent = leads_on ? Tangent::factorised : Tangent::iterated;
  const Transition transition{target.check_point,
                              batch.has_start() ? batch.start.check_point : target.check_point,
                              batch.start.level};
  Configuration found =
      make_configuration(solver_, setup, transition, batch.state.get(), target.level, tangent);
  found.iterations += target.iterations;
  found.seconds += target.seconds;
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
    if (between.outcome == Outcome::converged) solver_.forget(setup, between);
    IntermediateState& state = way.emplace_back();
    state.target = found.check_point;
    state.number = number;
    state.t = between.t;
    state.energy = between.energy;
    state.force = between.reaction;
    state.outcome = between.outcome;
    state.flags = between.flags;
    if (setup.policy.is_beyond_limit(state.force)) state.flags |= flags::beyond_force_limit;
    state.seconds = between.summary.seconds;
    if (state.outcome == Outcome::aborted) break;
    ++report_.num_intermediate_states;
    if (!state.usable()) ++report_.num_intermediate_states_failed;
    report_.intermediate_seconds += state.seconds;
  }
  return way;
}

bool Engine::needs_solve(const Batch& batch) const {
  return batch.has_start() && batch.state == nullptr &&
         record_.kept(batch.tool_space, batch.start) < Keep::all;
}

Bytes Engine::give() {
  Packer message;
  // Another rank asks while a transition is being made here: there cannot be a solve within a
  // solve.
  if (current_ && queue_.size() > 0 && needs_solve(queue_.last())) return {};
  // Whole batches are given while there is more than one; of a single batch, half of its targets.
  const std::size_t num_batches = queue_.size();
  if (num_batches > (current_ ? 0 : 1)) {
    // Batches without a start are given together, up to half of all; of others, one.
    std::size_t most = (num_batches + 1) / 2;
    for (bool from_rest = true; from_rest && most > 0; --most) {
      Batch given = queue_.take_last();
      pack(given, true, message);
      from_rest = !given.has_start() && queue_.last_needs_no_start();
    }
    return message.take();
  }
  Batch* rest = current_ ? &*current_ : num_batches == 0 ? nullptr : &queue_.last();
  if (rest == nullptr || rest->targets.size() < (current_ ? 1 : 2)) return {};
  Batch given = split(*rest);
  pack(given, true, message);
  return message.take();
}

Engine::Batch Engine::split(Batch& batch) {
  Batch other{batch.tool_space, batch.start, batch.state, batch.is_recorded_here, {}};
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
  for (Unpacker message(tasks); !message.at_end();) queue_.enqueue(unpack(message));
}

void Engine::discard() {
  to_recall_.clear();
  ready_.clear();
  queue_.clear();
  is_discarded_ = true;
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

Engine::Batch Engine::unpack(Unpacker& message) const {
  Batch batch;
  batch.tool_space = take_space(message);
  batch.start = take_summary(message, batch.tool_space);
  if (message.take<bool>()) {
    batch.is_recorded_here = false;
    batch.state =
        std::make_shared<const Equilibrium>(to_equilibrium(message.take<Configuration>()));
  }
  batch.targets = message.take_list<std::deque<Target>>();
  Unpacker::require(!batch.targets.empty());
  for (const Target& target : batch.targets) {
    require_possible(setup_of(batch.tool_space).grid, target.check_point, target.level);
  }
  return batch;
}

}  // namespace palpate
