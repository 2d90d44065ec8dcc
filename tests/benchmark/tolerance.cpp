// SPDX-License-Identifier: BSD-3-Clause
// Error asked for, error reached, configurations, seconds and megabytes: spaces that refine
// themselves to a tolerance, beside uniform grids, of the scene and the first active node of a
// .palpate file, which any short run of PrecomputeStateSpace makes.
//
//   OPENBLAS_NUM_THREADS=1 palpate_benchmark_tolerance liver.palpate 0.012 2000
//
// The arguments are the file, the half-width of the box in m, and the number of random points at
// which the equilibrium is solved exactly and compared. Prints a Markdown table.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <random>
#include <vector>

#include "equilibrium/tip.h"
#include "exploration/precompute.h"
#include "interpolation/interpolator.h"
#include "state_space/state_space_file.h"

namespace palpate {
namespace {

struct Exact {
  Vec3 t;
  Vec3 force;
  /// On the branch that is reached from rest, without inverted elements.
  bool regular;
};

/// Each solved from rest.
std::vector<Exact> solve_exactly(const Scene& scene, const Site& site, double half_width, int num) {
  EquilibriumSolver solver(scene, {});
  solver.hold(Tip(scene, site.tip_radius).hold({site.active_node}));
  const Equilibrium rest = solver.rest();
  std::mt19937_64 random(2008);
  std::uniform_real_distribution<double> uniform(-half_width, half_width);
  std::vector<Exact> all;
  while (static_cast<int>(all.size()) < num) {
    const Vec3 t(uniform(random), uniform(random), uniform(random));
    const Equilibrium exact = solver.solve(t, rest);
    const bool converged = exact.outcome == Outcome::converged;
    all.push_back({t, converged ? Vec3(exact.reaction) : Vec3::Zero(),
                   converged && exact.flags == 0});
  }
  return all;
}

void print_row(const char* name, const Scene& scene, const PrecomputeOptions& options,
               const std::vector<Exact>& exact) {
  const auto communicator = make_serial_communicator();
  const PrecomputeResult result = precompute(scene, options, *communicator, nullptr);
  const TouchSite& site = result.space.sites.front();
  const auto interpolator = make_interpolator(Method::energy_hermite, site);
  double largest_force = 0;
  for (const ConfigurationSummary& c : site.configurations) {
    if (c.usable()) largest_force = std::max(largest_force, c.force.norm());
  }
  std::vector<double> errors;
  int num_marked = 0;
  double worst_marked = 0;
  for (const Exact& point : exact) {
    const TouchResult touched = interpolator->evaluate(point.t);
    const double error = (touched.force - point.force).norm() / largest_force;
    if (touched.found != Found::inside || !point.regular) {
      ++num_marked;
      if (point.regular) worst_marked = std::max(worst_marked, error);
      continue;
    }
    errors.push_back(error);
  }
  std::sort(errors.begin(), errors.end());
  double sum = 0;
  for (const double e : errors) sum += e;
  const auto count = static_cast<double>(errors.size());
  const TouchSpace& space = result.space;
  const double bytes =
      4.0 * static_cast<double>(space.modes.size() + site.coefficients.size() +
                                site.coefficient_gradients.size()) +
      static_cast<double>(sizeof(ConfigurationSummary) * site.configurations.size());
  std::printf("| %s | %lld | %.1f | %.4f | %.4f | %.4f | %.1f | %.3f | %.2f |\n", name,
              static_cast<long long>(result.report.num_solved), result.report.exploration_seconds,
              100 * sum / count, 100 * errors[errors.size() * 99 / 100], 100 * errors.back(),
              100.0 * num_marked / static_cast<double>(exact.size()), 100 * worst_marked,
              bytes / 1e6);
  std::fflush(stdout);
}

int main_of(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "Give a .palpate file, a half-width in m and a number of points.\n");
    return EXIT_FAILURE;
  }
  const StateSpaceFile file = StateSpaceFile::open_read_only(argv[1]);
  const Scene scene = file.read_scene();
  const Site site = file.read_sites().front().site;
  PrecomputeOptions options;
  options.active_nodes = {site.active_node};
  options.tip_radius = site.tip_radius;
  options.half_width = argc > 2 ? std::atof(argv[2]) : site.half_width;
  options.equilibrium.tolerance = 1e-9;
  const auto exact =
      solve_exactly(scene, site, options.half_width, argc > 3 ? std::atoi(argv[3]) : 2000);
  std::printf("| space | configurations | s | error: mean %% | p99 %% | largest %% | marked %% | largest "
              "there %% | MB |\n|---|---|---|---|---|---|---|---|---|\n");
  char name[64];
  for (const int resolution : {3, 5}) {
    for (const double tolerance : {0.05, 0.02, 0.01, 0.005}) {
      options.resolution = resolution;
      options.tolerance = tolerance;
      std::snprintf(name, sizeof name, "%g %% from %d³", 100 * tolerance, resolution);
      print_row(name, scene, options, exact);
    }
  }
  options.tolerance = 0;
  for (const int resolution : {5, 7, 9, 11}) {
    options.resolution = resolution;
    std::snprintf(name, sizeof name, "uniform, %d³", resolution);
    print_row(name, scene, options, exact);
  }
  return EXIT_SUCCESS;
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) { return palpate::main_of(argc, argv); }
