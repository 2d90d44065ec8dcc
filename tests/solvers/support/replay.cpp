// SPDX-License-Identifier: BSD-3-Clause
#include "solvers/support/replay.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include "base/error.h"
#include "exploration/engine.h"
#include "exploration/start_graph.h"

namespace palpate::test {
namespace {

using Summaries = std::map<CheckPoint, const ConfigurationSummary*>;

/// What all ranks have in common.
struct Plan {
  const std::vector<Recording>& recordings;
  const std::vector<int>& recording_of_tool_space;
  const ReplayOptions& options;
  /// By recording.
  std::vector<Summaries> summaries;
  /// Their numbers count from 0.
  std::vector<PlannedSpace> spaces;

  [[nodiscard]] const Recording& of(ToolSpaceKey tool_space) const {
    return recordings[recording_of_tool_space[static_cast<std::size_t>(tool_space.id)]];
  }
};

/// A rigid tool's space is explored in the order that was recorded.
std::shared_ptr<const ExplorationPlan> plan_of(const ToolSpaceSetup& setup,
                                               const Recording& recording) {
  if (!setup.grid.sparse) return make_grid_plan(setup);
  std::vector<StartGraph::Target> targets;
  for (const ConfigurationSummary& c : recording.configurations) {
    targets.push_back({c.check_point, {c.parent}, (c.flags & flags::touches_nothing) != 0});
  }
  return std::make_shared<StartGraph>(setup.key(), std::move(targets));
}

/// @throws InputError
Plan make_plan(const std::vector<Recording>& recordings,
               const std::vector<int>& recording_of_tool_space, const ReplayOptions& options) {
  Plan plan{recordings, recording_of_tool_space, options, {}, {}};
  for (const Recording& recording : recordings) {
    Summaries& summaries = plan.summaries.emplace_back();
    for (const ConfigurationSummary& c : recording.configurations) {
      if (c.has_history()) {
        throw InputError(
            "A space with levels cannot be replayed: its file does not say how long "
            "the transitions took that found no new level. Record a flat one.");
      }
      summaries[c.check_point] = &c;
    }
  }
  for (std::size_t i = 0; i < recording_of_tool_space.size(); ++i) {
    const Recording& recording = recordings[static_cast<std::size_t>(recording_of_tool_space[i])];
    ToolSpaceSetup setup = recording.setup;
    setup.id = static_cast<ToolSpaceId>(i);
    setup.policy.history = History::flat;
    setup.policy.intermediate_states = 0;
    plan.spaces.push_back({setup, plan_of(setup, recording)});
  }
  return plan;
}

/// Takes the time that was recorded.
class ReplaySolver final : public StateSolver {
 public:
  ReplaySolver(const Plan& plan, Simulation& simulation, int rank, Monitor& monitor)
      : plan_(plan), simulation_(simulation), rank_(rank), monitor_(monitor) {}

  [[nodiscard]] Equilibrium begin(const ToolSpaceSetup& setup, const Eigen::VectorXd& t,
                                  Tangent tangent) override {
    take(setup.key());
    const ConfigurationSummary& c = recorded(check_point(t));
    if (tangent == Tangent::factorised) keep_factor(c.check_point);
    return spend(c.seconds) ? found(c) : aborted();
  }

  [[nodiscard]] Equilibrium solve(const ToolSpaceSetup& setup, const Eigen::VectorXd& t,
                                  const Equilibrium& start, Tangent tangent) override {
    take(setup.key());
    const CheckPoint from = check_point(start.t);
    const ConfigurationSummary& c = recorded(check_point(t));
    if (c.parent != from) {
      // An attempt that failed: what all of them took is the time of the last one.
      Equilibrium failed;
      failed.t = start.t;
      failed.reaction = Vec3::Zero();
      failed.stiffness = Mat3::Zero();
      return failed;
    }
    double seconds = c.seconds;
    if (!keep_factor(from)) {
      ++num_factorised_again;
      seconds += plan_.options.factorisation_seconds;
    }
    if (tangent == Tangent::factorised && c.usable()) keep_factor(c.check_point);
    return spend(seconds) ? found(c) : aborted();
  }

  void forget(const ToolSpaceSetup& /*setup*/, const Equilibrium& state) override {
    const auto kept = std::find(factors_.begin(), factors_.end(), check_point(state.t));
    if (kept != factors_.end()) factors_.erase(kept);
  }

  std::int64_t num_factorised_again = 0;

 private:
  [[nodiscard]] const ToolSpaceSetup& setup() const {
    return plan_.spaces[static_cast<std::size_t>(taken_.id)].setup;
  }

  /// As the solver, which keeps the factors of one tool space.
  void take(ToolSpaceKey tool_space) {
    if (tool_space == taken_) return;
    taken_ = tool_space;
    factors_.clear();
  }

  [[nodiscard]] CheckPoint check_point(const Eigen::VectorXd& t) const {
    CheckPoint p{};
    for (int i = 0; i < 3; ++i)
      p[i] = static_cast<std::int32_t>(
          std::lround((t[i] - setup().grid.origin[i]) / setup().grid.spacing()));
    return p;
  }

  /// @throws InputError
  [[nodiscard]] const ConfigurationSummary& recorded(const CheckPoint& p) const {
    const Summaries& summaries = plan_.summaries[static_cast<std::size_t>(
        plan_.recording_of_tool_space[static_cast<std::size_t>(taken_.id)])];
    const auto found = summaries.find(p);
    if (found == summaries.end()) {
      throw InputError("The recording of " + plan_.of(taken_).setup.name() +
                       " lacks a configuration. Record a whole space.");
    }
    return *found->second;
  }

  /// The least lately used makes room.
  /// @returns whether it was kept already.
  bool keep_factor(const CheckPoint& p) {
    const auto kept = std::find(factors_.begin(), factors_.end(), p);
    const bool is_kept = kept != factors_.end();
    if (is_kept) factors_.erase(kept);
    factors_.push_back(p);
    const int most = setup().grid.sparse
                         ? num_kept_factors(kShellLayers)
                         : num_kept_factors(setup().grid.reach() / setup().grid.coarsest);
    if (factors_.size() > static_cast<std::size_t>(most)) factors_.pop_front();
    return is_kept;
  }

  /// @returns false where the run ends early.
  bool spend(double seconds) {
    while (seconds > 0) {
      const double slice = std::min(seconds, plan_.options.poll_interval);
      simulation_.work_on(rank_, slice);
      seconds -= slice;
      if (!monitor_.go_on()) return false;
    }
    return true;
  }

  [[nodiscard]] static Equilibrium found(const ConfigurationSummary& c) {
    Equilibrium e;
    e.t = c.t;
    e.energy = c.energy;
    e.reaction = c.force;
    e.stiffness = c.stiffness;
    if (c.has_third_derivative()) e.third_derivative = c.third_derivative;
    e.outcome = c.outcome;
    e.flags = c.flags & ~flags::beyond_force_limit;
    e.summary.iterations = c.iterations;
    e.summary.seconds = c.seconds;
    return e;
  }
  [[nodiscard]] static Equilibrium aborted() {
    Equilibrium e;
    e.t = Vec3::Zero();
    e.reaction = Vec3::Zero();
    e.stiffness = Mat3::Zero();
    e.outcome = Outcome::aborted;
    return e;
  }

  const Plan& plan_;
  Simulation& simulation_;
  int rank_;
  Monitor& monitor_;
  ToolSpaceKey taken_{-1};
  /// The last was used last.
  std::deque<CheckPoint> factors_;
};

/// Keeps nothing; rank 0 knows what it is told that it does.
class ReplayRecord final : public Record {
 public:
  ReplayRecord(const Plan& plan, int rank) : plan_(plan), rank_(rank) {}

  [[nodiscard]] Known known(ToolSpaceKey tool_space) const override {
    Known known;
    const auto& all = plan_.of(tool_space).configurations;
    const std::size_t number = rank_ == 0 ? std::min(plan_.options.num_known, all.size()) : 0;
    known.configurations.assign(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(number));
    return known;
  }
  [[nodiscard]] std::vector<std::string> damaged() const override { return {}; }
  void keep(ToolSpaceKey, const Configuration&, const std::vector<IntermediateState>&) override {}
  void keep(ToolSpaceKey, const LevelTransition&) override {}
  void settle(ToolSpaceKey, const ConfigurationSummary&, std::int32_t) override {}
  [[nodiscard]] Configuration load(ToolSpaceKey,
                                   const ConfigurationSummary& summary) const override {
    return {summary, {}, {}, {}, {}};
  }
  [[nodiscard]] TouchSpace publish(double) override { return {}; }
  void resume() override {}
  [[nodiscard]] bool has_moved() const override { return false; }
  [[nodiscard]] TouchSpace finish(bool, double) override { return {}; }

 private:
  const Plan& plan_;
  int rank_;
};

/// A rank.
class SimulatedEngine final : public Worker {
 public:
  SimulatedEngine(const Plan& plan, Simulation& simulation, int rank)
      : plan_(plan),
        simulation_(simulation),
        rank_(rank),
        monitor_(nullptr, simulation.network(rank)),
        solver_(plan, simulation, rank, monitor_),
        record_(plan, rank),
        engine_(plan.spaces, solver_, record_, simulation.network(rank), monitor_, report_) {}

  void start(Mail& mail) override { engine_.start(mail); }
  void receive(int from, const Bytes& message, Mail& mail) override {
    if (!plan_.options.damage) return engine_.receive(from, message, mail);
    Bytes damaged = message;
    plan_.options.damage(damaged);
    engine_.receive(from, damaged, mail);
  }
  [[nodiscard]] bool has_work() const override { return engine_.has_work(); }
  void work(Mail& mail) override {
    if (plan_.options.steer) {
      if (auto steering = plan_.options.steer(rank_, ++num_tasks_)) {
        engine_.steer(*std::move(steering));
      }
    }
    engine_.work(mail);
  }
  /// The states in it have no fields here.
  [[nodiscard]] Bytes give() override {
    const std::int64_t before = report_.num_states_given;
    Bytes share = engine_.give();
    const auto states = static_cast<std::size_t>(report_.num_states_given - before);
    simulation_.burden(rank_, states * plan_.options.state_bytes);
    return share;
  }
  void take(const Bytes& share, Mail& mail) override { engine_.take(share, mail); }
  void discard() override { engine_.discard(); }

  [[nodiscard]] const PrecomputeReport& report() const { return report_; }
  [[nodiscard]] std::int64_t num_factorised_again() const { return solver_.num_factorised_again; }

 private:
  const Plan& plan_;
  Simulation& simulation_;
  int rank_;
  int num_tasks_ = 0;
  PrecomputeReport report_;
  Monitor monitor_;
  ReplaySolver solver_;
  ReplayRecord record_;
  Engine engine_;
};

}  // namespace

Replay replay(const std::vector<Recording>& recordings,
              const std::vector<int>& recording_of_tool_space, int num_ranks,
              const ReplayOptions& options) {
  const Plan plan = make_plan(recordings, recording_of_tool_space, options);
  Simulation simulation(num_ranks, options.machine);
  std::deque<SimulatedEngine> engines;
  std::vector<Worker*> workers;
  for (int r = 0; r < num_ranks; ++r) {
    workers.push_back(&engines.emplace_back(plan, simulation, r));
  }
  Replay result;
  result.report.complete = simulation.run(workers, options.schedule);
  result.makespan = simulation.makespan();
  result.most_under_way = simulation.most_under_way();
  for (int r = 0; r < num_ranks; ++r) {
    const PrecomputeReport& report = engines[r].report();
    result.report.num_solved += report.num_solved;
    result.report.num_reused += report.num_reused;
    result.report.num_states_given += report.num_states_given;
    result.report.schedule += simulation.report(r);
    result.num_factorised_again += engines[r].num_factorised_again();
  }
  return result;
}

}  // namespace palpate::test
