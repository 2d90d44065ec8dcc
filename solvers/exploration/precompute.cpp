// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/precompute.h"

#include <algorithm>
#include <functional>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <type_traits>
#include <utility>

#include "base/error.h"
#include "base/memory_error.h"
#include "equilibrium/equilibrium.h"
#include "equilibrium/tangent_solver.h"
#include "exploration/engine.h"
#include "exploration/monitor.h"
#include "exploration/plan_spaces.h"
#include "exploration/record.h"
#include "exploration/settle.h"
#include "exploration/start_graph.h"
#include "exploration/transfer.h"
#include "interaction/interaction_spec.h"
#include "interpolation/error_estimate.h"
#include "linear/group.h"

namespace palpate {
namespace {

/// Halving a cell has helped if the error of the half is below this share of the cell's. Where the
/// force is smooth, or contact begins, it falls to an eighth or less.
constexpr double kShrinks = 1.0 / 3;
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

/// The ranks, in groups that solve together.
struct Groups {
  Groups(Communicator& all, int ranks_per_solve) {
    const int last = all.size() / ranks_per_solve - 1;
    own = all.split(std::min(all.rank() / ranks_per_solve, last));
    leaders = all.split(leads() ? 0 : 1);
  }
  [[nodiscard]] bool leads() const { return own->rank() == 0; }

  std::unique_ptr<Communicator> own;
  /// The communicator of the ranks that lead a group.
  std::unique_ptr<Communicator> leaders;
};

/// @throws InputError
void validate_ranks_per_solve(const PrecomputeOptions& options, int num_ranks) {
  const int ranks = options.ranks_per_solve;
  if (ranks < 1 || ranks > num_ranks) {
    throw InputError("The ranks per solve are " + std::to_string(ranks) +
                     "; they must be from 1 to the number of ranks, " + std::to_string(num_ranks) +
                     '.');
  }
  const std::string solver =
      options.linear_solver.empty() ? linear_solver_names().front() : options.linear_solver;
  if (ranks > 1 && solver != "MUMPS") {
    throw InputError("The ranks per solve are " + std::to_string(ranks) +
                     "; with the linear solver " + solver + " there can be 1 alone.");
  }
}

/// Adds the figure of another rank.
template <class T>
void add(T& all, const T& one) {
  all += one;
}
template <class Key>
void add(std::map<Key, std::int64_t>& all, const std::map<Key, std::int64_t>& one) {
  for (const auto& [key, number] : one) all[key] += number;
}

/// Calls visit(figure, combine) for each figure of a report that is combined over the ranks;
/// combine(all, one) takes in the figure of one more rank.
template <class Visit>
void for_each_figure(PrecomputeReport& report, Visit&& visit) {
  constexpr auto sum = [](auto& all, const auto& one) { add(all, one); };
  constexpr auto largest = [](auto& all, const auto& one) { all = std::max(all, one); };
  visit(report.num_solved, sum);
  visit(report.num_reused, sum);
  visit(report.num_by_outcome, sum);
  visit(report.num_by_flag, sum);
  visit(report.num_expected, sum);
  visit(report.num_transitions, sum);
  visit(report.num_levels, sum);
  visit(report.num_beyond_most_levels, sum);
  visit(report.iterations, sum);
  visit(report.num_states_given, sum);
  visit(report.num_intermediate_states, sum);
  visit(report.num_intermediate_states_failed, sum);
  visit(report.intermediate_seconds, sum);
  visit(report.work, sum);
  visit(report.num_rounds, largest);
  visit(report.complete, largest);
  visit(report.num_unknowns, largest);
  visit(report.exploration_seconds, largest);
  visit(report.finishing_seconds, largest);
}

/// Packs the figures of a report.
Bytes packed(PrecomputeReport& report) {
  Packer figures;
  for_each_figure(report, [&](auto& figure, auto /*combine*/) { figures.put(figure); });
  return figures.take();
}

void take_in(PrecomputeReport& report, const Bytes& figures) {
  Unpacker one(figures);
  for_each_figure(report, [&](auto& figure, auto combine) {
    combine(figure, one.take<std::decay_t<decltype(figure)>>());
  });
}

/// Combines the reports of all ranks. Ranks that serve others in a solve have empty reports.
void combine(PrecomputeReport& report, Communicator& communicator) {
  const Bytes mine = packed(report);
  for_each_figure(report, [](auto& figure, auto /*combine*/) { figure = {}; });
  for (const Bytes& figures : communicator.all_gather(mine)) take_in(report, figures);
  report.schedule = sum(communicator, report.schedule);
  report.num_not_reached = report.num_expected - report.num_solved - report.num_reused;
}

/// The rounds in which cells of a rigid tool's space are halved. Every rank plans the same rounds.
class ShellRounds {
 public:
  ShellRounds(PlannedSpace& space, const ToolClearance& clearance, const Vec3& begin_at)
      : space_(space), clearance_(clearance), begin_at_(begin_at) {
    take(static_cast<const StartGraph&>(*space.plan));
  }

  /// Plans the next round, after a complete one.
  /// @returns false: no further round is needed.
  /// @note Collective
  bool plan(Engine& engine, Communicator& communicator, PrecomputeReport& report) {
    gather_known(engine, communicator);
    bool goes_on = false;
    agree(communicator, [&] {
      const ToolSpaceSetup& setup = space_.setup;
      // Configurations of earlier runs that belong to later rounds do not count yet.
      std::map<CheckPoint, ConfigurationSummary> known;
      std::vector<ConfigurationSummary> found;
      for (const auto& [p, c] : known_) {
        if (asked_.count(p) == 0) continue;
        known.emplace(p, c);
        found.push_back(c);
      }
      const double tolerance = force_tolerance(setup.policy, found);
      if (!(tolerance > 0)) return;
      const Clearance clearance = [&](const Vec3& q) { return clearance_.clearance(q); };
      const Refinement refinement =
          plan_refinement(setup.grid, found, tolerance, 1, clearance,
                          [&](const CellEstimate& estimate) { return is_in_vain(estimate); });
      for (const CellEstimate& e : refinement.estimates) errors_[e.cell] = e.error;
      auto graph = std::make_shared<const StartGraph>(
          setup.id, refined_targets(clearance_, setup.grid, refinement.to_split, known, begin_at_));
      if (graph->targets().empty()) return;
      take(*graph);
      space_.plan = std::move(graph);
      engine.plan_anew();
      report.num_rounds = ++num_rounds_;
      goes_on = true;
    });
    return goes_on;
  }

 private:
  /// Whether halving has not helped, as between the branches at a ridge.
  [[nodiscard]] bool is_in_vain(const CellEstimate& estimate) const {
    const auto before = errors_.find(parent_of(estimate.cell, space_.setup.grid.reach()));
    return before != errors_.end() && !(estimate.error < kShrinks * before->second);
  }

  void take(const StartGraph& graph) {
    for (const StartGraph::Target& target : graph.targets()) asked_.insert(target.check_point);
  }

  /// @note Collective
  void gather_known(const Engine& engine, Communicator& communicator) {
    const std::vector<ConfigurationSummary>& here = engine.known_here(space_.setup.id);
    Packer mine;
    mine.put_list(std::vector<ConfigurationSummary>(
        here.begin() + static_cast<std::ptrdiff_t>(num_told_), here.end()));
    num_told_ = here.size();
    for (const Bytes& bytes : communicator.all_gather(mine.take())) {
      for (const auto& c : Unpacker(bytes).take_list<std::vector<ConfigurationSummary>>()) {
        known_[c.check_point] = c;
      }
    }
  }

  PlannedSpace& space_;
  const ToolClearance& clearance_;
  Vec3 begin_at_;
  /// The check-points that the rounds so far have asked for.
  std::set<CheckPoint> asked_;
  std::map<CheckPoint, ConfigurationSummary> known_;
  /// The error estimates of all cells so far, also of cells that were split since.
  std::map<Cell, double> errors_;
  std::size_t num_told_ = 0;
  int num_rounds_ = 0;
};

/// Explores, on the ranks that lead a solve.
/// @param make_solver Makes the solver of this rank; null: a solver without factorisation.
PrecomputeResult explore(const Scene& asked, const PrecomputeOptions& options,
                         Communicator& communicator, const Progress& progress,
                         const std::function<std::unique_ptr<LinearSolver>()>& make_solver) {
  PrecomputeResult result;
  PrecomputeReport& report = result.report;
  const SteadyClock::time_point start = SteadyClock::now();
  Monitor monitor(progress, communicator.network());
  std::vector<PlannedSpace> spaces;
  std::unique_ptr<EquilibriumSolver> solver;
  std::string solver_name;
  // Check everything that can be wrong before a file is touched.
  agree(communicator, [&] {
    with_memory("to prepare the solver of the body", [&] {
      std::unique_ptr<LinearSolver> linear_solver = make_solver();
      solver_name = linear_solver == nullptr ? kConjugateGradients : linear_solver->name();
      solver = std::make_unique<EquilibriumSolver>(asked, solver_options(options, monitor),
                                                   std::move(linear_solver));
    });
  });
  std::optional<Scene> settled;
  const Scene& scene = settle(asked, *solver, options.file, communicator, settled);
  result.settled = scene.settled;
  InteractionFactory tools(scene);
  std::optional<InteractionSolver> state_solver;
  agree(communicator, [&] {
    with_memory("to prepare the solver of the body", [&] {
      state_solver.emplace(scene, *solver, tools);
      spaces = plan_spaces(scene, options, tools);
      require_few_enough(options, spaces);
      if (communicator.rank() != 0 || !options.expects) return;
      const SolveCost cost = measure_solve_cost(scene, solver_name, options.equilibrium.threads);
      options.expects(estimate_exploration(options, spaces, cost, communicator.size()));
    });
  });
  std::vector<ToolSpaceSetup> setups;
  for (const PlannedSpace& space : spaces) setups.push_back(space.setup);
  const double tolerance = options.equilibrium.tolerance;
  const std::unique_ptr<Record> record =
      options.file.empty() ? make_memory_record(scene, setups, communicator)
                           : make_file_record(options.file, scene, setups, tolerance, options.keep,
                                              options.touch_bound, communicator);
  result.damaged = record->damaged();

  Engine engine(spaces, *state_solver, *record, communicator.network(), monitor, report);
  std::optional<ShellRounds> rounds;
  if (options.contact && options.tolerance > 0) {
    rounds.emplace(spaces.front(), *tools.clearance(setups.front().interaction),
                   options.contact->shell.begin_at);
  }
  do {
    report.complete = run(engine, communicator, &report.schedule);
    monitor.set_mail(nullptr);
  } while (report.complete && rounds && rounds->plan(engine, communicator, report));
  report.exploration_seconds = seconds_since(start);

  const SteadyClock::time_point finish_start = SteadyClock::now();
  result.space = record->finish(report.complete, options.touch_bound);
  report.finishing_seconds = seconds_since(finish_start);
  const auto held = tools.make(setups.front().interaction)->prescribed_points();
  report.num_unknowns = solver->assembly().pattern().size - 3 * static_cast<Index>(held.size());
  report.work = solver->work();
  return result;
}

/// Explores, on all ranks.
/// @note Collective
PrecomputeResult explore_on_ranks(const Scene& scene, const PrecomputeOptions& options,
                                  Communicator& communicator, const Progress& progress) {
  PrecomputeResult result;
  if (options.ranks_per_solve == 1) {
    result = explore(scene, options, communicator, progress, [&] {
      return options.linear_solver.empty()
                 ? choose_tangent_solver(scene, options.equilibrium.threads)
                 : make_tangent_solver(options.linear_solver);
    });
  } else {
    const Groups groups(communicator, options.ranks_per_solve);
    const void* group = groups.own->mpi_comm();
    agree(communicator, prepare_group_solver);
    agree(communicator, [&] {
      if (groups.leads()) {
        // Make the solver first: the other ranks already serve it, and if anything fails its
        // destructor releases them.
        auto solver = make_group_solver(group);
        result = explore(scene, options, *groups.leaders, progress,
                         [&solver] { return std::move(solver); });
      } else {
        serve_group_solver(group);
      }
    });
  }
  return result;
}

PrecomputeOptions without_nodes(const PrecomputeOptions& options) {
  PrecomputeOptions result = options;
  if (options.contact) result.active_nodes.clear();
  return result;
}

PrecomputeOptions without_contact(const PrecomputeOptions& options) {
  PrecomputeOptions result = options;
  result.contact.reset();
  return result;
}

/// Adds the results of an earlier exploration to those of a later one.
/// @param in_memory true: the spaces are joined here. false: the file, and so the later result, has
///   all.
void append(PrecomputeResult& all, PrecomputeResult newer, bool in_memory) {
  PrecomputeReport& report = newer.report;
  // The later report says whether the run is complete; the times are added up.
  report.exploration_seconds += all.report.exploration_seconds;
  report.finishing_seconds += all.report.finishing_seconds;
  all.report.complete = false;
  take_in(report, packed(all.report));
  report.schedule += all.report.schedule;
  const auto put_before = [](auto& list, auto& first) {
    list.insert(list.begin(), std::make_move_iterator(first.begin()),
                std::make_move_iterator(first.end()));
  };
  put_before(newer.damaged, all.damaged);
  if (in_memory) put_before(newer.space.tool_spaces, all.space.tool_spaces);
  all = std::move(newer);
}

}  // namespace

PrecomputeResult precompute(const Scene& scene, const PrecomputeOptions& asked,
                            Communicator& communicator, const Progress& progress) {
  const SteadyClock::time_point start = SteadyClock::now();
  const bool has_both = asked.contact && !asked.active_nodes.empty();
  agree(communicator, [&] {
    validate(asked);
    validate_ranks_per_solve(asked, communicator.size());
    // Check the active nodes now, and not after the first exploration.
    if (has_both) (void)plan_grids(scene, asked);
  });
  PrecomputeOptions options = asked;
  options.equilibrium.threads = num_threads(communicator, asked.equilibrium.threads);
  if (asked.contact) {
    bool is_earlier = false;
    agree(communicator,
          [&] { is_earlier = communicator.rank() == 0 && has_earlier_layer(scene, asked); });
    if (any(communicator, is_earlier)) {
      options.contact->tool = with_earlier_layer(asked.contact->tool, scene);
    }
  }
  PrecomputeResult result;
  // A rank may run out of memory anywhere.
  agree(communicator, [&] {
    result = explore_on_ranks(scene, without_nodes(options), communicator, progress);
    if (has_both && any(communicator, result.report.complete)) {
      append(result, explore_on_ranks(scene, without_contact(options), communicator, progress),
             options.file.empty());
    }
    combine(result.report, communicator);
  });
  PrecomputeReport& report = result.report;
  report.num_ranks = communicator.size();
  report.num_cells = scene.mesh.num_cells();
  if (report.complete && progress) {
    const std::int64_t found = report.num_solved + report.num_reused;
    (void)progress({found, found, report.num_solved, seconds_since(start), 0});
  }
  return result;
}

}  // namespace palpate
