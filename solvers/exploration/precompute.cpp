// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/precompute.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>

#include "base/error.h"
#include "exploration/engine.h"
#include "exploration/monitor.h"
#include "exploration/record.h"
#include "exploration/transfer.h"
#include "interaction/interaction_spec.h"
#include "linear/group.h"
#include "state_space/pod.h"

namespace palpate {
namespace {

/// Cells are halved this often at the most.
constexpr int kMaxDepth = 6;

/// Makes the grid of a tool space that of the smallest cells that a tolerance may ask for.
void refine(const PrecomputeOptions& options, ToolSpaceSetup& setup) {
  setup.policy.tolerance = options.tolerance;
  setup.policy.tolerance_is_relative = options.tolerance_is_relative;
  setup.policy.history = History::flat;
  for (int depth = 0; depth < kMaxDepth; ++depth) {
    const std::int32_t finer = 2 * setup.grid.resolution - 1;
    if (finer > kLargestResolution) break;
    setup.grid.resolution = finer;
    setup.grid.coarsest *= 2;
  }
}

/// @throws InputError a node where the tool cannot be.
std::vector<ToolSpaceSetup> make_setups(const Scene& scene, const PrecomputeOptions& options) {
  std::vector<Index> nodes = options.active_nodes;
  if (nodes.empty()) {
    for (Index p = 0; p < scene.mesh.num_points(); ++p) {
      if (scene.touchable[p] != 0 && scene.fixed[p] == 0) nodes.push_back(p);
    }
    if (nodes.empty()) {
      throw InputError(
          "No point of the body is touchable. Choose touchable points with Set "
          "Boundary or name active nodes.");
    }
  }
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  const BondedPatches patches(scene, options.tip_radius);
  std::vector<ToolSpaceSetup> setups;
  for (const Index node : nodes) {
    (void)patches.around(node);
    ToolSpaceSetup& setup = setups.emplace_back();
    setup.id = node;
    setup.interaction = bonded_patch_spec(scene, node, options.tip_radius);
    setup.grid.half_width = options.half_width;
    setup.grid.resolution = options.resolution;
    setup.policy.force_limit = options.force_limit;
    setup.policy.history = options.history;
    setup.policy.intermediate_states = options.intermediate_states;
    setup.policy.third_derivatives = options.equilibrium.third_derivatives;
    if (options.tolerance > 0) refine(options, setup);
  }
  return setups;
}

EquilibriumOptions solver_options(const PrecomputeOptions& options, Monitor& monitor) {
  EquilibriumOptions result = options.equilibrium;
  // Depth first, the starts on the way down keep their factors beside those of a step.
  result.follow_folds = false;
  result.kept_factors = num_kept_factors((options.resolution - 1) / 2);
  result.abort_requested = [&monitor, asked = options.equilibrium.abort_requested] {
    return !monitor.go_on() || (asked && asked());
  };
  return result;
}

/// Who solves together with whom.
struct Groups {
  Groups(Communicator& all, int ranks_per_solve) {
    const int last = all.size() / ranks_per_solve - 1;
    own = all.split(std::min(all.rank() / ranks_per_solve, last));
    leaders = all.split(leads() ? 0 : 1);
  }
  [[nodiscard]] bool leads() const { return own->rank() == 0; }

  std::unique_ptr<Communicator> own;
  /// On those that lead.
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

/// Adds what another rank has to what one has.
template <class T>
void add(T& all, const T& one) {
  all += one;
}
template <class Key>
void add(std::map<Key, std::int64_t>& all, const std::map<Key, std::int64_t>& one) {
  for (const auto& [key, number] : one) all[key] += number;
}

/// Calls visit(figure, combine) for each figure of a report that the ranks combine, where
/// combine(all, one) takes in that of one more.
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
  visit(report.complete, largest);
  visit(report.num_unknowns, largest);
  visit(report.exploration_seconds, largest);
  visit(report.finishing_seconds, largest);
}

/// Combines what each rank has; the ranks that serve others have nothing.
void combine(PrecomputeReport& report, Communicator& communicator) {
  Packer mine;
  for_each_figure(report, [&](auto& figure, auto /*combine*/) {
    mine.put(figure);
    figure = {};
  });
  for (const Bytes& bytes : communicator.all_gather(mine.take())) {
    Unpacker of_rank(bytes);
    for_each_figure(report, [&](auto& figure, auto combine) {
      combine(figure, of_rank.take<std::decay_t<decltype(figure)>>());
    });
  }
  report.schedule = sum(communicator, report.schedule);
  report.num_not_reached = report.num_expected - report.num_solved - report.num_reused;
}

/// On ranks that solve.
/// @param make_solver Is called first: ranks may have begun to serve what it makes.
PrecomputeResult explore(const Scene& scene, const PrecomputeOptions& options,
                         Communicator& communicator, const Progress& progress,
                         const std::function<std::unique_ptr<LinearSolver>()>& make_solver) {
  PrecomputeResult result;
  PrecomputeReport& report = result.report;
  const Clock::time_point start = Clock::now();
  Monitor monitor(progress, communicator.network());
  std::vector<ToolSpaceSetup> setups;
  std::unique_ptr<EquilibriumSolver> solver;
  InteractionFactory tools(scene);
  // All that can be wrong, before a file is touched.
  agree(communicator, [&] {
    std::unique_ptr<LinearSolver> linear_solver = make_solver();
    solver = std::make_unique<EquilibriumSolver>(scene, solver_options(options, monitor),
                                                 std::move(linear_solver));
    setups = make_setups(scene, options);
  });
  const double tolerance = options.equilibrium.tolerance;
  const std::unique_ptr<Record> record =
      options.file.empty() ? make_memory_record(scene, setups, tolerance, communicator)
                           : make_file_record(options.file, scene, setups, tolerance, communicator);
  result.damaged = record->damaged();

  InteractionSolver state_solver(*solver, tools);
  Engine engine(setups, state_solver, *record, communicator.network(), monitor, report);
  report.complete = run(engine, communicator, &report.schedule);
  monitor.set_mail(nullptr);
  report.exploration_seconds = seconds_since(start);

  const Clock::time_point finish_start = Clock::now();
  result.space = record->finish(report.complete, options.touch_bound);
  report.finishing_seconds = seconds_since(finish_start);
  const auto held = tools.make(setups.front().interaction)->prescribed_points();
  report.num_unknowns = solver->assembly().pattern().size - 3 * static_cast<Index>(held.size());
  report.work = solver->work();
  return result;
}

}  // namespace

void validate(const PrecomputeOptions& options) {
  if (!(std::isfinite(options.half_width) && options.half_width > 0)) {
    throw InputError("The half-width is " + std::to_string(options.half_width) +
                     "; it must be a positive length in m.");
  }
  if (options.resolution < 3 || options.resolution % 2 == 0 ||
      options.resolution > kLargestCoarsestResolution) {
    throw InputError(
        "The resolution is " + std::to_string(options.resolution) +
        "; it must be odd, so that the rest position is a check-point, and from 3 to " +
        std::to_string(kLargestCoarsestResolution) + '.');
  }
  if (!(std::isfinite(options.force_limit) && options.force_limit >= 0)) {
    throw InputError("The force limit is " + std::to_string(options.force_limit) +
                     "; it must be a force in N, or 0 for none.");
  }
  if (!(std::isfinite(options.tolerance) && options.tolerance >= 0)) {
    throw InputError(
        "The tolerance is " + std::to_string(options.tolerance) +
        "; it must be a force in N or a share of the largest, or 0 for a uniform grid.");
  }
  if (options.history == History::levels && options.tolerance > 0) {
    throw InputError(
        "Levels are explored on a uniform grid. Choose a resolution instead of a "
        "tolerance, or another history.");
  }
  if (options.intermediate_states < 0 || options.intermediate_states > kMostIntermediateStates) {
    throw InputError("The intermediate states are " + std::to_string(options.intermediate_states) +
                     "; they must be from 0 to " + std::to_string(kMostIntermediateStates) + '.');
  }
  if (!(options.touch_bound >= kLeastPodBound && options.touch_bound < 1)) {
    throw InputError("The displacement bound is " + std::to_string(options.touch_bound) +
                     "; it must be a share from 0.00001 to below 1.");
  }
  validate(options.equilibrium);
}

PrecomputeResult precompute(const Scene& scene, const PrecomputeOptions& options,
                            Communicator& communicator, const Progress& progress) {
  const Clock::time_point start = Clock::now();
  agree(communicator, [&] {
    validate(options);
    validate_ranks_per_solve(options, communicator.size());
  });
  PrecomputeResult result;
  if (options.ranks_per_solve == 1) {
    result = explore(scene, options, communicator, progress, [&] {
      return options.linear_solver.empty() ? make_linear_solver()
                                           : make_linear_solver(options.linear_solver);
    });
  } else {
    const Groups groups(communicator, options.ranks_per_solve);
    const void* group = groups.own->mpi_comm();
    agree(communicator, [&] {
      if (groups.leads()) {
        result = explore(scene, options, *groups.leaders, progress,
                         [group] { return make_group_solver(group); });
      } else {
        serve_group_solver(group);
      }
    });
  }
  PrecomputeReport& report = result.report;
  report.num_ranks = communicator.size();
  report.num_cells = scene.mesh.num_cells();
  combine(report, communicator);
  if (report.complete && progress) {
    const std::int64_t found = report.num_solved + report.num_reused;
    (void)progress({found, found, report.num_solved, seconds_since(start), 0});
  }
  return result;
}

}  // namespace palpate
