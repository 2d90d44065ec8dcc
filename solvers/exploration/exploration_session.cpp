// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/exploration_session.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <optional>
#include <utility>

#include "base/error.h"
#include "base/memory_error.h"
#include "base/own_seconds.h"
#include "equilibrium/equilibrium.h"
#include "equilibrium/tangent_solver.h"
#include "exploration/body_solvers.h"
#include "exploration/chunk_record.h"
#include "exploration/engine.h"
#include "exploration/monitor.h"
#include "exploration/plan_spaces.h"
#include "exploration/record.h"
#include "exploration/settle.h"
#include "exploration/shell_rounds.h"
#include "interaction/interaction_spec.h"
#include "interpolation/region_weights.h"
#include "storage/state_space_file.h"

namespace palpate {
namespace {

EquilibriumOptions solver_options(const PrecomputeOptions& options, Monitor& monitor) {
  EquilibriumOptions result = exploring(options);
  result.abort_requested = [&monitor, asked = options.equilibrium.abort_requested] {
    return !monitor.go_on() || (asked && asked());
  };
  return result;
}

/// With regions, a rank explores one body after the other. The second solver is for tasks that it
/// takes over from another rank.
constexpr std::size_t kSolversWithRegions = 2;

/// Takes the mail from a monitor when it goes out of scope.
struct NoMailAfterwards {
  Monitor& monitor;
  ~NoMailAfterwards() { monitor.set_mail(nullptr); }
};

}  // namespace

struct ExplorationSession::Impl {
  Impl(const std::vector<BodyOfRun>& asked, const PrecomputeOptions& asked_options,
       Communicator& all, const Progress& progress, const MakeSolver& make_solver, TakeChunk take);

  /// Makes the solvers of the bodies, and finds their rest.
  void take_bodies(const std::vector<BodyOfRun>& asked, const MakeSolver& make_solver);
  /// Plans the tool spaces of all bodies.
  void plan(const std::vector<BodyOfRun>& asked);
  /// Where a rigid tool presses in a region, or on an organ that has none.
  [[nodiscard]] ShellOptions shell_of(const std::optional<MeshRegion>& region) const;
  /// Opens the record, and begins to note chunks if they are asked for.
  void open_record();
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
  /// The bodies in the order of their numbers.
  std::vector<SpaceBody> bodies;
  /// The number of unknowns of each body.
  std::map<BodyId, Index> num_unknowns;
  /// The name of the linear solver of each body.
  std::map<BodyId, std::string> solver_names;
  std::optional<BodySolvers> solvers;
  /// Whether bodies are for regions or nodes of a divided organ.
  bool is_divided = false;
  /// The regions in which a rigid tool presses.
  std::vector<MeshRegion> regions;
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
  engine.emplace(spaces, *solvers, *record, communicator.network(), monitor, report);
  if (options.contact) {
    for (PlannedSpace& space : spaces) {
      const ExplorationPolicy& policy = space.setup.policy;
      if (!(policy.tolerance > 0) && policy.history == History::flat) continue;
      rounds.emplace_back(space,
                          solvers->tools(space.setup.body).clearance(space.setup.interaction),
                          shell_of(space.setup.region));
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
    is_divided = is_divided || of_run.region.has_value();
    if (of_run.region && of_run.region->band > 0) regions.push_back(*of_run.region);
  }
  const std::size_t most_kept = is_divided ? kSolversWithRegions : bodies.size();
  const auto make = [this, make_solver](const SpaceBody& body) {
    std::unique_ptr<LinearSolver> linear_solver = make_solver(*body.scene);
    solver_names[body.number] =
        linear_solver == nullptr ? kConjugateGradients : linear_solver->name();
    auto solver = std::make_unique<EquilibriumSolver>(*body.scene, solver_options(options, monitor),
                                                      std::move(linear_solver));
    num_unknowns[body.number] = solver->assembly().pattern().size;
    return solver;
  };
  solvers.emplace(bodies, make, options.estimate_mesh_error, most_kept);
  // Check everything that can be wrong before a file is touched.
  agree(communicator, [&] {
    with_memory("to prepare the solver of the body", [&] {
      if (!regions.empty()) (void)RegionWeights(regions);
      for (SpaceBody& body : bodies) {
        require_one_organ(*bodies.front().scene, *body.scene);
        const BodyOfRun& of_run = asked[static_cast<std::size_t>(body.number - kFirstBody)];
        const bool is_touched = !is_divided || of_run.region.has_value();
        if (is_touched && solver_names.size() < most_kept) {
          (void)solvers->equilibria(body.number);
        }
        body.hash = hash(*body.scene);
      }
    });
  });
  for (SpaceBody& body : bodies) {
    if (!body.scene->has_load()) continue;
    body.at_rest =
        settle(*body.scene, solvers->equilibria(body.number), options.file, communicator);
  }
}

ShellOptions ExplorationSession::Impl::shell_of(const std::optional<MeshRegion>& region) const {
  ShellOptions shell = options.contact->shell;
  if (!region) return shell;
  const auto own = std::find(regions.begin(), regions.end(), *region) - regions.begin();
  shell.may_hold = [weights = RegionWeights(regions), own = static_cast<int>(own)](
                       const Vec3& place, double half) {
    return weights.may_reach(own, place, half);
  };
  // The regions follow each other in the order of their distances from where the exploration
  // begins.
  const double distance = (region->centre - shell.begin_at).norm();
  for (const MeshRegion& other : regions) {
    if ((other.centre - shell.begin_at).norm() < distance) ++shell.turn;
  }
  return shell;
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
        const BodyOfRun& of_run = asked[static_cast<std::size_t>(body.number - kFirstBody)];
        PrecomputeOptions of_body = options;
        of_body.active_nodes = of_run.active_nodes;
        // Where some bodies have active nodes, the others have none.
        if (!options.contact && names_nodes && of_body.active_nodes.empty()) continue;
        // Where some bodies have regions, nothing presses the others.
        if (options.contact && !regions.empty()) {
          if (!of_run.region || of_run.region->band == 0) continue;
          of_body.contact->shell = shell_of(of_run.region);
        }
        std::vector<PlannedSpace> planned =
            plan_spaces(body, of_body, solvers->tools(body.number), of_run.region);
        if (communicator.rank() == 0 && options.expects && !planned.empty()) {
          const SolveCost cost = measure_solve_cost(*body.scene, solver_names[body.number],
                                                    options.equilibrium.threads);
          const ExplorationEstimate of_planned =
              estimate_exploration(of_body, planned, cost, communicator.size());
          if (!estimate) {
            estimate = of_planned;
          } else {
            estimate = is_divided ? followed_by(*estimate, of_planned) : *estimate + of_planned;
          }
        }
        spaces.insert(spaces.end(), std::make_move_iterator(planned.begin()),
                      std::make_move_iterator(planned.end()));
      }
      if (spaces.empty()) throw_nothing_to_press(options);
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
      [this](BodyId body) -> InteractionFactory& { return solvers->tools(body); }, setups,
      options.touch_bound, communicator);
  chunks = chunked.get();
  record = std::move(chunked);
}

PrecomputeResult ExplorationSession::Impl::result_of(TouchSpace space,
                                                     SteadyClock::time_point begin) {
  report.finishing_seconds += seconds_since(begin);
  report.num_unknowns = 0;
  report.num_cells = 0;
  report.work = solvers->work();
  for (const auto& [body, count] : num_unknowns) {
    report.num_unknowns =
        is_divided ? std::max(report.num_unknowns, count) : report.num_unknowns + count;
  }
  for (const SpaceBody& body : bodies) {
    const bool is_touched =
        std::any_of(spaces.begin(), spaces.end(),
                    [&](const PlannedSpace& planned) { return planned.setup.body == body.number; });
    if (is_divided && !is_touched) continue;
    const Index count = body.mesh().num_cells();
    report.num_cells = is_divided ? std::max(report.num_cells, count) : report.num_cells + count;
  }
  const ToolSpaceSetup& first = spaces.front().setup;
  const auto held = solvers->tools(first.body).make(first.interaction)->prescribed_points();
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
