// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/exploration_session.h"

#include <algorithm>
#include <optional>
#include <utility>

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

struct ExplorationSession::Impl {
  Impl(std::shared_ptr<const Scene> asked, const PrecomputeOptions& asked_options,
       Communicator& all, const Progress& progress, const MakeSolver& make_solver, TakeChunk take);

  PrecomputeResult result_of(TouchSpace space, SteadyClock::time_point begin);
  /// @note Collective
  void give_chunks();

  std::shared_ptr<const Scene> scene_asked;
  PrecomputeOptions options;
  Communicator& communicator;
  Monitor monitor;
  TakeChunk take_chunk;
  PrecomputeReport report;
  std::unique_ptr<EquilibriumSolver> solver;
  std::optional<Scene> settled;
  /// The scene at rest under its load: the given one, or `settled`.
  const Scene* scene = nullptr;
  std::optional<InteractionFactory> tools;
  std::optional<InteractionSolver> state_solver;
  std::vector<PlannedSpace> spaces;
  std::unique_ptr<Record> record;
  /// The record, if it gives chunks; else null.
  ChunkRecord* chunks = nullptr;
  std::optional<Engine> engine;
  std::optional<ShellRounds> rounds;
  /// Damaged parts of the file, until they are reported.
  std::vector<std::string> damaged;
  bool is_published = false;
  State state = State::paused;
};

ExplorationSession::Impl::Impl(std::shared_ptr<const Scene> asked,
                               const PrecomputeOptions& asked_options, Communicator& all,
                               const Progress& progress, const MakeSolver& make_solver,
                               TakeChunk take)
    : scene_asked(std::move(asked)),
      options(asked_options),
      communicator(all),
      monitor(progress, all.network()),
      take_chunk(std::move(take)) {
  const SteadyClock::time_point begin = SteadyClock::now();
  std::string solver_name;
  // Check everything that can be wrong before a file is touched.
  agree(communicator, [&] {
    with_memory("to prepare the solver of the body", [&] {
      std::unique_ptr<LinearSolver> linear_solver = make_solver();
      solver_name = linear_solver == nullptr ? kConjugateGradients : linear_solver->name();
      solver = std::make_unique<EquilibriumSolver>(*scene_asked, solver_options(options, monitor),
                                                   std::move(linear_solver));
    });
  });
  scene = &settle(*scene_asked, *solver, options.file, communicator, settled);
  tools.emplace(*scene);
  agree(communicator, [&] {
    with_memory("to prepare the solver of the body", [&] {
      state_solver.emplace(*scene, *solver, *tools);
      spaces = plan_spaces(*scene, options, *tools);
      require_few_enough(options, spaces);
      if (communicator.rank() != 0 || !options.expects) return;
      const SolveCost cost = measure_solve_cost(*scene, solver_name, options.equilibrium.threads);
      options.expects(estimate_exploration(options, spaces, cost, communicator.size()));
    });
  });
  std::vector<ToolSpaceSetup> setups;
  for (const PlannedSpace& space : spaces) setups.push_back(space.setup);
  record = options.file.empty()
               ? make_memory_record(*scene, setups, communicator)
               : make_file_record(options.file, *scene, setups, options.equilibrium.tolerance,
                                  options.keep, options.touch_bound, communicator);
  damaged = record->damaged();
  if (take_chunk) {
    auto chunked = std::make_unique<ChunkRecord>(std::move(record), *scene, *tools, setups,
                                                 options.touch_bound, communicator);
    chunks = chunked.get();
    record = std::move(chunked);
  }
  engine.emplace(spaces, *state_solver, *record, communicator.network(), monitor, report);
  if (options.contact && options.tolerance > 0) {
    rounds.emplace(spaces.front(), *tools->clearance(setups.front().interaction),
                   options.contact->shell.begin_at);
  }
  report.exploration_seconds = seconds_since(begin);
}

PrecomputeResult ExplorationSession::Impl::result_of(TouchSpace space,
                                                     SteadyClock::time_point begin) {
  report.finishing_seconds += seconds_since(begin);
  const auto held = tools->make(spaces.front().setup.interaction)->prescribed_points();
  report.num_unknowns = solver->assembly().pattern().size - 3 * static_cast<Index>(held.size());
  report.num_cells = scene->mesh.num_cells();
  report.work = solver->work();
  return {std::move(space), scene->settled, report, std::exchange(damaged, {})};
}

ExplorationSession::ExplorationSession(std::shared_ptr<const Scene> scene,
                                       const PrecomputeOptions& options, Communicator& communicator,
                                       const Progress& progress, const MakeSolver& make_solver,
                                       TakeChunk take_chunk)
    : impl_(std::make_unique<Impl>(std::move(scene), options, communicator, progress, make_solver,
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
    } while (session.rounds &&
             session.rounds->plan(*session.engine, session.communicator, session.report));
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
