// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/exploration_session.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

#include "base/error.h"
#include "base/memory_error.h"
#include "base/own_seconds.h"
#include "equilibrium/equilibrium.h"
#include "equilibrium/tangent_solver.h"
#include "exploration/chunk_record.h"
#include "exploration/engine.h"
#include "exploration/monitor.h"
#include "exploration/plan_spaces.h"
#include "exploration/record.h"
#include "exploration/settle.h"
#include "exploration/shell_rounds.h"
#include "interaction/interaction_spec.h"
#include "storage/state_space_file.h"

namespace palpate {
namespace {

/// A step that leads to another branch, as at a ridge, is halved this often before the body jumps.
/// Eight halvings jump to the same state in three times the time.
constexpr int kMostHalvingsOfStep = 3;

EquilibriumOptions solver_options(const PrecomputeOptions& options, Monitor& monitor) {
  EquilibriumOptions result = options.equilibrium;
  // The exploration goes depth first: the starts on the current path keep their factors, beside
  // that of a step.
  result.follow_folds = false;
  if (options.contact) result.max_halvings = std::min(result.max_halvings, kMostHalvingsOfStep);
  result.kept_factors =
      num_kept_factors(options.contact ? kShellLayers : (options.resolution - 1) / 2);
  result.abort_requested = [&monitor, asked = options.equilibrium.abort_requested] {
    return !monitor.go_on() || (asked && asked());
  };
  return result;
}

/// Takes the mail from a monitor when it goes out of scope.
struct NoMailAfterwards {
  Monitor& monitor;
  ~NoMailAfterwards() { monitor.set_mail(nullptr); }
};

}  // namespace

/// What solves for the states of one body.
struct BodySolver {
  std::unique_ptr<EquilibriumSolver> equilibria;
  /// The name of its linear solver.
  std::string name;
  std::optional<InteractionFactory> tools;
  std::optional<InteractionSolver> states;
};

struct ExplorationSession::Impl {
  Impl(const std::vector<BodyOfRun>& asked, const PrecomputeOptions& asked_options,
       Communicator& all, const Progress& progress, const MakeSolver& make_solver, TakeChunk take);

  /// Makes the solver of each body, and finds its rest.
  void take_bodies(const std::vector<BodyOfRun>& asked, const MakeSolver& make_solver);
  /// Plans the tool spaces of all bodies.
  void plan(const std::vector<BodyOfRun>& asked);
  /// Opens the record, and begins to note chunks if they are asked for.
  void open_record();
  [[nodiscard]] BodySolver& solver_of(BodyId body) {
    return *solvers[static_cast<std::size_t>(body - kFirstBody)];
  }
  PrecomputeResult result_of(TouchSpace space, SteadyClock::time_point begin);
  /// @note Collective
  void give_chunks();
  /// Plans the next rounds of rigid tools. @returns False: none is needed.
  /// @note Collective
  [[nodiscard]] bool plan_rounds();

  PrecomputeOptions options;
  Communicator& communicator;
  Monitor monitor;
  TakeChunk take_chunk;
  PrecomputeReport report;
  /// The bodies in the order of their numbers, and their solvers.
  std::vector<SpaceBody> bodies;
  std::vector<std::unique_ptr<BodySolver>> solvers;
  SolverOfBodies state_solver;
  std::vector<PlannedSpace> spaces;
  std::unique_ptr<Record> record;
  /// The record, if it gives chunks; else null.
  ChunkRecord* chunks = nullptr;
  std::optional<Engine> engine;
  /// One for each space of a rigid tool that is explored in rounds.
  std::vector<ShellRounds> rounds;
  /// Damaged parts of the file, until they are reported.
  std::vector<std::string> damaged;
  bool is_published = false;
  State state = State::paused;
};

ExplorationSession::Impl::Impl(const std::vector<BodyOfRun>& asked,
                               const PrecomputeOptions& asked_options, Communicator& all,
                               const Progress& progress, const MakeSolver& make_solver,
                               TakeChunk take)
    : options(asked_options),
      communicator(all),
      monitor(progress, all.network()),
      take_chunk(std::move(take)) {
  const SteadyClock::time_point begin = SteadyClock::now();
  take_bodies(asked, make_solver);
  plan(asked);
  open_record();
  engine.emplace(spaces, state_solver, *record, communicator.network(), monitor, report);
  if (options.contact && options.tolerance > 0) {
    for (PlannedSpace& space : spaces) {
      rounds.emplace_back(space,
                          solver_of(space.setup.body).tools->clearance(space.setup.interaction),
                          options.contact->shell.begin_at);
    }
  }
  report.exploration_seconds = seconds_since(begin);
}

void ExplorationSession::Impl::take_bodies(const std::vector<BodyOfRun>& asked,
                                           const MakeSolver& make_solver) {
  for (const BodyOfRun& of_run : asked) {
    SpaceBody& body = bodies.emplace_back();
    body.number = kFirstBody + static_cast<BodyId>(bodies.size()) - 1;
    body.scene = of_run.scene;
    solvers.push_back(std::make_unique<BodySolver>());
  }
  // Check everything that can be wrong before a file is touched.
  agree(communicator, [&] {
    with_memory("to prepare the solver of the body", [&] {
      for (SpaceBody& body : bodies) {
        require_one_organ(*bodies.front().scene, *body.scene);
        BodySolver& solver = solver_of(body.number);
        std::unique_ptr<LinearSolver> linear_solver = make_solver(*body.scene);
        solver.name = linear_solver == nullptr ? kConjugateGradients : linear_solver->name();
        solver.equilibria = std::make_unique<EquilibriumSolver>(
            *body.scene, solver_options(options, monitor), std::move(linear_solver));
        body.hash = hash(*body.scene);
      }
    });
  });
  for (SpaceBody& body : bodies) {
    BodySolver& solver = solver_of(body.number);
    body.at_rest = settle(*body.scene, *solver.equilibria, options.file, communicator);
    solver.tools.emplace(body.scene->body, body.at_rest);
    solver.states.emplace(body, *solver.equilibria, *solver.tools, options.estimate_mesh_error);
    state_solver.add(body.number, *solver.states);
  }
}

void ExplorationSession::Impl::plan(const std::vector<BodyOfRun>& asked) {
  agree(communicator, [&] {
    with_memory("to prepare the solver of the body", [&] {
      if (options.contact) {
        // One tool presses all bodies, with one law of contact.
        options.contact->tool = with_defaults(options.contact->tool, *bodies.front().scene);
      }
      const bool names_nodes = std::any_of(asked.begin(), asked.end(), [](const BodyOfRun& body) {
        return !body.active_nodes.empty();
      });
      std::optional<ExplorationEstimate> estimate;
      for (const SpaceBody& body : bodies) {
        BodySolver& solver = solver_of(body.number);
        PrecomputeOptions of_body = options;
        of_body.active_nodes =
            asked[static_cast<std::size_t>(body.number - kFirstBody)].active_nodes;
        // Where some bodies have active nodes, the others have none.
        if (!options.contact && names_nodes && of_body.active_nodes.empty()) continue;
        std::vector<PlannedSpace> planned = plan_spaces(body, of_body, *solver.tools);
        if (communicator.rank() == 0 && options.expects) {
          const SolveCost cost =
              measure_solve_cost(*body.scene, solver.name, options.equilibrium.threads);
          const ExplorationEstimate of_planned =
              estimate_exploration(of_body, planned, cost, communicator.size());
          estimate = estimate ? *estimate + of_planned : of_planned;
        }
        spaces.insert(spaces.end(), std::make_move_iterator(planned.begin()),
                      std::make_move_iterator(planned.end()));
      }
      require_few_enough(options, spaces);
      if (estimate) options.expects(*estimate);
    });
  });
}

void ExplorationSession::Impl::open_record() {
  std::vector<ToolSpaceSetup> setups;
  for (const PlannedSpace& space : spaces) setups.push_back(space.setup);
  record = options.file.empty()
               ? make_memory_record(bodies, setups, communicator)
               : make_file_record(options.file, bodies, setups, options.equilibrium.tolerance,
                                  options.keep, options.touch_bound, communicator);
  damaged = record->damaged();
  if (!take_chunk) return;
  auto chunked = std::make_unique<ChunkRecord>(
      std::move(record), bodies,
      [this](BodyId body) -> InteractionFactory& { return *solver_of(body).tools; }, setups,
      options.touch_bound, communicator);
  chunks = chunked.get();
  record = std::move(chunked);
}

PrecomputeResult ExplorationSession::Impl::result_of(TouchSpace space,
                                                     SteadyClock::time_point begin) {
  report.finishing_seconds += seconds_since(begin);
  report.num_unknowns = 0;
  report.num_cells = 0;
  report.work = {};
  for (const SpaceBody& body : bodies) {
    const BodySolver& solver = solver_of(body.number);
    report.num_unknowns += solver.equilibria->assembly().pattern().size;
    report.num_cells += body.mesh().num_cells();
    report.work += solver.equilibria->work();
  }
  const ToolSpaceSetup& first = spaces.front().setup;
  const auto held = solver_of(first.body).tools->make(first.interaction)->prescribed_points();
  report.num_unknowns -= 3 * static_cast<Index>(held.size());
  std::vector<SpaceBody> all = bodies;
  if (!space.file.empty() && communicator.rank() == 0) {
    // The file may have more bodies than the run, and the space has what the file has.
    const StateSpaceFile file = StateSpaceFile::open_read_only(space.file);
    if (file.list_bodies().size() > bodies.size()) all = file.read_bodies();
  }
  return {std::move(space), std::move(all), report, std::exchange(damaged, {})};
}

ExplorationSession::ExplorationSession(const std::vector<BodyOfRun>& bodies,
                                       const PrecomputeOptions& options, Communicator& communicator,
                                       const Progress& progress, const MakeSolver& make_solver,
                                       TakeChunk take_chunk)
    : impl_(std::make_unique<Impl>(bodies, options, communicator, progress, make_solver,
                                   std::move(take_chunk))) {}

ExplorationSession::~ExplorationSession() = default;

void ExplorationSession::Impl::give_chunks() {
  if (chunks == nullptr) return;
  while (const std::optional<SpaceChunk> chunk = chunks->take()) {
    agree(communicator, [&] {
      if (communicator.rank() == 0) take_chunk(*chunk);
    });
  }
}

bool ExplorationSession::Impl::plan_rounds() {
  bool goes_on = false;
  for (ShellRounds& of_space : rounds) {
    if (of_space.plan(*engine, communicator, report)) goes_on = true;
  }
  return goes_on;
}

ExplorationSession::State ExplorationSession::run(const Until& until) {
  Impl& session = *impl_;
  if (session.state == State::complete || session.state == State::aborted) return session.state;
  const SteadyClock::time_point begin = SteadyClock::now();
  if (std::exchange(session.is_published, false)) session.record->resume();
  session.give_chunks();
  session.monitor.pause_when(until);
  const auto explore = [&] {
    do {
      ScheduleReport schedule;
      bool is_done = false;
      {
        // The mail is the scheduler's, which is gone after the run, also where that throws.
        const NoMailAfterwards guard{session.monitor};
        is_done = palpate::run(*session.engine, session.communicator, &schedule);
      }
      session.report.schedule += schedule;
      if (session.engine->is_discarded()) return State::aborted;
      // The run may have been paused within its last transition.
      if (!is_done && any(session.communicator, session.engine->has_work())) return State::paused;
      if (any(session.communicator, session.engine->has_withdrawn())) return State::withdrawn;
    } while (session.plan_rounds());
    return State::complete;
  };
  // A session that throws is over: what its chunks have not given is in its record.
  session.state = State::aborted;
  session.state = explore();
  session.give_chunks();
  session.report.complete = session.state == State::complete;
  session.report.exploration_seconds += seconds_since(begin);
  return session.state;
}

ExplorationSession::State ExplorationSession::state() const { return impl_->state; }

void ExplorationSession::steer(Steering steering) { impl_->engine->steer(std::move(steering)); }

PrecomputeResult ExplorationSession::publish() {
  const SteadyClock::time_point begin = SteadyClock::now();
  TouchSpace space = impl_->record->publish(impl_->options.touch_bound);
  impl_->is_published = true;
  if (impl_->record->has_moved()) impl_->engine->move_records_to_first_rank();
  return impl_->result_of(std::move(space), begin);
}

PrecomputeResult ExplorationSession::finish() {
  const SteadyClock::time_point begin = SteadyClock::now();
  if (std::exchange(impl_->is_published, false)) impl_->record->resume();
  TouchSpace space = impl_->record->finish(impl_->report.complete, impl_->options.touch_bound);
  return impl_->result_of(std::move(space), begin);
}

}  // namespace palpate
