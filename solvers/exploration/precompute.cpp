// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/precompute.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "base/error.h"
#include "equilibrium/tip.h"
#include "exploration/engine.h"
#include "exploration/monitor.h"
#include "exploration/record.h"
#include "linear/group.h"
#include "state_space/pod.h"

namespace palpate {
namespace {

/// Cells are halved this often at the most.
constexpr int kMaxDepth = 6;

/// Makes the grid of a site that of the smallest cells that a tolerance may ask for.
void refine(const PrecomputeOptions& options, Site& site) {
  site.tolerance = options.tolerance;
  site.tolerance_is_relative = options.tolerance_is_relative;
  site.history = History::flat;
  for (int depth = 0; depth < kMaxDepth; ++depth) {
    const std::int32_t finer = 2 * site.resolution - 1;
    if (finer > kLargestResolution) break;
    site.resolution = finer;
    site.coarsest *= 2;
  }
}

/// @throws InputError a node that the tip cannot be put on.
std::vector<Site> make_sites(const Scene& scene, const PrecomputeOptions& options, const Tip& tip) {
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
  std::vector<Site> sites;
  for (const Index node : nodes) {
    (void)tip.hold({node});
    Site site{node, options.half_width, options.resolution, options.force_limit,
              options.tip_radius};
    site.history = options.history;
    site.intermediate_states = options.intermediate_states;
    site.third_derivatives = options.equilibrium.third_derivatives;
    if (options.tolerance > 0) refine(options, site);
    sites.push_back(site);
  }
  return sites;
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

/// Combines what each rank has; the ranks that serve others have nothing.
void combine(PrecomputeReport& report, Communicator& communicator) {
  Packer mine;
  mine.put(report.num_solved);
  mine.put(report.num_reused);
  mine.put(report.num_expected);
  mine.put(report.num_transitions);
  mine.put(report.num_levels);
  mine.put(report.num_beyond_most_levels);
  mine.put(report.iterations);
  mine.put(report.num_states_given);
  mine.put(report.num_intermediate_states);
  mine.put(report.num_intermediate_states_failed);
  mine.put(report.intermediate_seconds);
  mine.put(report.work);
  mine.put(report.complete);
  mine.put(report.num_unknowns);
  mine.put(report.exploration_seconds);
  mine.put(report.finishing_seconds);
  mine.put_list(report.num_by_outcome);
  mine.put_list(report.num_by_flag);
  report.num_solved = report.num_reused = report.num_expected = report.iterations = 0;
  report.num_transitions = report.num_levels = report.num_beyond_most_levels = 0;
  report.num_states_given = 0;
  report.num_intermediate_states = report.num_intermediate_states_failed = 0;
  report.intermediate_seconds = 0;
  report.work = {};
  report.schedule = sum(communicator, report.schedule);
  report.num_by_outcome.clear();
  report.num_by_flag.clear();
  for (const Bytes& bytes : communicator.all_gather(mine.take())) {
    Unpacker of_rank(bytes);
    report.num_solved += of_rank.take<std::int64_t>();
    report.num_reused += of_rank.take<std::int64_t>();
    report.num_expected += of_rank.take<std::int64_t>();
    report.num_transitions += of_rank.take<std::int64_t>();
    report.num_levels += of_rank.take<std::int64_t>();
    report.num_beyond_most_levels += of_rank.take<std::int64_t>();
    report.iterations += of_rank.take<std::int64_t>();
    report.num_states_given += of_rank.take<std::int64_t>();
    report.num_intermediate_states += of_rank.take<std::int64_t>();
    report.num_intermediate_states_failed += of_rank.take<std::int64_t>();
    report.intermediate_seconds += of_rank.take<double>();
    report.work += of_rank.take<Work>();
    report.complete = of_rank.take<bool>() || report.complete;
    report.num_unknowns = std::max(report.num_unknowns, of_rank.take<Index>());
    report.exploration_seconds = std::max(report.exploration_seconds, of_rank.take<double>());
    report.finishing_seconds = std::max(report.finishing_seconds, of_rank.take<double>());
    using ByOutcome = std::vector<std::pair<Outcome, std::int64_t>>;
    using ByFlag = std::vector<std::pair<Flags, std::int64_t>>;
    for (const auto& [outcome, number] : of_rank.take_list<ByOutcome>()) {
      report.num_by_outcome[outcome] += number;
    }
    for (const auto& [flag, number] : of_rank.take_list<ByFlag>()) {
      report.num_by_flag[flag] += number;
    }
  }
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
  std::vector<Site> sites;
  std::unique_ptr<Tip> tip;
  std::unique_ptr<EquilibriumSolver> solver;
  // All that can be wrong, before a file is touched.
  agree(communicator, [&] {
    std::unique_ptr<LinearSolver> linear_solver = make_solver();
    solver = std::make_unique<EquilibriumSolver>(scene, solver_options(options, monitor),
                                                 std::move(linear_solver));
    tip = std::make_unique<Tip>(scene, options.tip_radius);
    sites = make_sites(scene, options, *tip);
  });
  const double tolerance = options.equilibrium.tolerance;
  const std::unique_ptr<Record> record =
      options.file.empty() ? make_memory_record(scene, sites, tolerance, communicator)
                           : make_file_record(options.file, scene, sites, tolerance, communicator);
  result.damaged = record->damaged();

  TipSolver site_solver(*solver, *tip);
  Engine engine(sites, site_solver, *record, communicator.network(), monitor, report);
  report.complete = run(engine, communicator, &report.schedule);
  monitor.set_mail(nullptr);
  report.exploration_seconds = seconds_since(start);

  const Clock::time_point finish_start = Clock::now();
  result.space = record->finish(report.complete, options.touch_bound);
  report.finishing_seconds = seconds_since(finish_start);
  report.num_unknowns =
      solver->assembly().pattern().size -
      3 * static_cast<Index>(tip->hold({sites.front().active_node}).points.size());
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
