// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/precompute.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <type_traits>

#include "base/error.h"
#include "equilibrium/tip.h"
#include "exploration/engine.h"
#include "exploration/layered_grid.h"
#include "exploration/monitor.h"
#include "exploration/record.h"
#include "state_space/pod.h"

namespace palpate {
namespace {

/// @throws InputError a node that the tip cannot be put on.
std::vector<Site> make_sites(const Scene& scene, const PrecomputeOptions& options, const Tip& tip) {
  std::vector<Index> nodes = options.active_nodes;
  if (nodes.empty()) {
    for (Index p = 0; p < scene.mesh.num_points(); ++p) {
      if (scene.touchable[p] != 0 && scene.fixed[p] == 0) nodes.push_back(p);
    }
    if (nodes.empty()) {
      throw InputError("No point of the body is touchable. Choose touchable points with Set "
                       "Boundary or name active nodes.");
    }
  }
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  std::vector<Site> sites;
  for (const Index node : nodes) {
    (void)tip.hold({node});
    sites.push_back({node, options.half_width, options.resolution, options.force_limit,
                     options.tip_radius});
  }
  return sites;
}

EquilibriumOptions solver_options(const PrecomputeOptions& options, Monitor& monitor) {
  EquilibriumOptions result = options.equilibrium;
  // Depth first, the starts on the way down keep their factors beside those of a step.
  result.follow_folds = false;
  result.kept_factors = (options.resolution - 1) / 2 + 2;
  result.abort_requested = [&monitor, asked = options.equilibrium.abort_requested] {
    return !monitor.go_on() || (asked && asked());
  };
  return result;
}

/// Sum over the ranks.
Work total(const Work& mine, Communicator& communicator) {
  static_assert(std::is_trivially_copyable_v<Work>);
  Bytes bytes(sizeof mine);
  std::memcpy(bytes.data(), &mine, sizeof mine);
  Work sum;
  for (const Bytes& one : communicator.all_gather(bytes)) {
    Work work;
    std::memcpy(&work, one.data(), sizeof work);
    sum += work;
  }
  return sum;
}

}  // namespace

void validate(const PrecomputeOptions& options) {
  if (!(std::isfinite(options.half_width) && options.half_width > 0)) {
    throw InputError("The half-width is " + std::to_string(options.half_width) +
                     "; it must be a positive length in m.");
  }
  if (options.resolution < 3 || options.resolution % 2 == 0 ||
      options.resolution > kLargestResolution) {
    throw InputError("The resolution is " + std::to_string(options.resolution) +
                     "; it must be odd, so that the rest position is a check-point, and from 3 to " +
                     std::to_string(kLargestResolution) + '.');
  }
  if (!(std::isfinite(options.force_limit) && options.force_limit >= 0)) {
    throw InputError("The force limit is " + std::to_string(options.force_limit) +
                     "; it must be a force in N, or 0 for none.");
  }
  if (!(options.touch_bound >= kLeastPodBound && options.touch_bound < 1)) {
    throw InputError("The displacement bound is " + std::to_string(options.touch_bound) +
                     "; it must be a share from 0.00001 to below 1.");
  }
  validate(options.equilibrium);
}

PrecomputeResult precompute(const Scene& scene, const PrecomputeOptions& options,
                            Communicator& communicator, const Progress& progress) {
  PrecomputeResult result;
  PrecomputeReport& report = result.report;
  const Clock::time_point start = Clock::now();
  Monitor monitor(progress, communicator);
  std::vector<Site> sites;
  std::unique_ptr<Tip> tip;
  std::unique_ptr<EquilibriumSolver> solver;
  // All that can be wrong, before a file is touched.
  agree(communicator, [&] {
    validate(options);
    solver = std::make_unique<EquilibriumSolver>(
        scene, solver_options(options, monitor),
        options.linear_solver.empty() ? make_linear_solver()
                                      : make_linear_solver(options.linear_solver));
    tip = std::make_unique<Tip>(scene, options.tip_radius);
    sites = make_sites(scene, options, *tip);
  });
  const double tolerance = options.equilibrium.tolerance;
  const std::unique_ptr<Record> record =
      options.file.empty()
          ? make_memory_record(scene, sites, tolerance, communicator)
          : make_file_record(options.file, scene, sites, tolerance, communicator);

  LayeredGrid frontier(sites);
  Engine engine(sites, *tip, *solver, *record, communicator, monitor);
  report.complete = engine.explore(frontier, report);
  if (!report.complete) communicator.forget_stop();
  report.exploration_seconds = seconds_since(start);

  const Clock::time_point finish_start = Clock::now();
  result.space = record->finish(report.complete, options.touch_bound);
  report.finishing_seconds = seconds_since(finish_start);
  report.num_ranks = communicator.size();
  report.num_cells = scene.mesh.num_cells();
  report.num_unknowns =
      solver->assembly().pattern().size -
      3 * static_cast<Index>(tip->hold({sites.front().active_node}).points.size());
  report.num_not_reached = frontier.num_expected() - report.num_solved - report.num_reused;
  report.work = total(solver->work(), communicator);
  return result;
}

}  // namespace palpate
