// SPDX-License-Identifier: BSD-3-Clause
// What a configuration of a large body takes, without a factor and with one: a cube of Tet10,
// neo-Hookean, held at its bottom, a patch of its top pulled by a tenth of its height from rest,
// with sensitivity, stiffness and inertia; and one of the 27 of a space around that place. Prints a
// Markdown table and the exponents of the growth.
//
//   OPENBLAS_NUM_THREADS=1 palpate_benchmark_large 1100000 160000 0.45 1
//
// The arguments are the numbers of unknowns not to exceed, without a factor and with one, Poisson's
// ratio, and the threads without a factor; 0: as many as there are cores. A fifth one is the number
// of unknowns from which on.
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <vector>

#include "benchmark/cube.h"
#include "benchmark/table.h"
#include "equilibrium/equilibrium.h"
#include "equilibrium/tangent_solver.h"
#include "exploration/precompute.h"
#include "schedule/communicator.h"

namespace palpate {
namespace {

using namespace benchmarks;

/// Bricks along an edge: 6 084, 20 400, 45 000, 102 480, 147 852, 304 842, 553 500, 1 036 728
/// unknowns.
constexpr int kBricks[] = {6, 9, 12, 16, 18, 23, 28, 35};
constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

struct Run {
  Equilibrium pulled;
  Work work;
  double rest_seconds = 0;
  double bytes = 0;
};

Run run(const Scene& scene, std::unique_ptr<LinearSolver> linear_solver, int threads) {
  Run run;
  forget_peak();
  const double before = peak_bytes();
  EquilibriumOptions options;
  options.threads = threads;
  EquilibriumSolver solver(scene, options, std::move(linear_solver));
  solver.set_interaction(bond_patch(scene.body.mesh));
  const Equilibrium rest = solver.rest();
  run.rest_seconds = rest.summary.seconds;
  run.pulled = solver.solve(Vec3(0, 0, kEdge / 10), rest);
  run.work = solver.work();
  run.bytes = peak_bytes() - before;
  if (run.pulled.outcome != Outcome::converged)
    std::printf("%s\n", run.pulled.summary.message.c_str());
  return run;
}

/// Seconds for a configuration in the mean.
double explore(const Scene& scene, const std::string& linear_solver, int threads) {
  PrecomputeOptions options = space_of_patch(scene.body.mesh, kEdge / 20, 3);
  options.linear_solver = linear_solver;
  options.equilibrium.single_precision = true;
  options.equilibrium.threads = threads;
  const auto communicator = make_serial_communicator();
  const PrecomputeReport report = precompute(scene, options, *communicator, {}).report;
  return report.exploration_seconds / static_cast<double>(report.num_solved);
}

std::vector<Figure> measure(int bricks, int most_direct, double nu, int threads) {
  const Scene scene = make_cube(bricks, nu);
  const int unknowns = num_unknowns(bricks);
  const Run iterative = run(scene, nullptr, threads);
  std::vector<Figure> figures = {
      {"unknowns", 1, static_cast<double>(unknowns)},
      {"rest, s", 1, iterative.rest_seconds},
      {"configuration, s", 1, iterative.pulled.summary.seconds},
      {"Newton", 1, static_cast<double>(iterative.pulled.summary.iterations)},
      {"iterations", 1, static_cast<double>(iterative.work.krylov_iterations)},
      {"memory, MB", kMega, iterative.bytes},
      {"bytes an unknown", 1, iterative.bytes / unknowns},
      {"explored, s", 1,
       unknowns <= most_direct ? explore(scene, kConjugateGradients, threads) : kNothing},
  };
  double explored = kNothing, seconds = kNothing, bytes = kNothing, force = kNothing,
         stiffness = kNothing;
  if (unknowns <= most_direct) {
    const Run direct = run(scene, make_linear_solver(), threads);
    explored = explore(scene, linear_solver_names().front(), threads);
    seconds = direct.pulled.summary.seconds;
    bytes = direct.bytes;
    force =
        (direct.pulled.reaction - iterative.pulled.reaction).norm() / direct.pulled.reaction.norm();
    stiffness = (direct.pulled.stiffness - iterative.pulled.stiffness).norm() /
                direct.pulled.stiffness.norm();
  }
  figures.push_back({"with a factor, s", 1, seconds});
  figures.push_back({"explored, s", 1, explored});
  figures.push_back({"its memory, MB", kMega, bytes});
  figures.push_back({"difference of the force", 1, force});
  figures.push_back({"of the stiffness", 1, stiffness});
  return figures;
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  const int most = argc > 1 ? std::atoi(argv[1]) : 160'000;
  const int most_direct = argc > 2 ? std::atoi(argv[2]) : 50'000;
  const double nu = argc > 3 ? std::atof(argv[3]) : 0.45;
  const int threads = argc > 4 ? std::atoi(argv[4]) : 1;
  const int least = argc > 5 ? std::atoi(argv[5]) : 0;
  std::vector<std::vector<palpate::benchmarks::Figure>> rows;
  for (const int bricks : palpate::kBricks) {
    if (palpate::num_unknowns(bricks) > most) break;
    if (palpate::num_unknowns(bricks) < least) continue;
    rows.push_back(palpate::measure(bricks, most_direct, nu, threads));
    palpate::benchmarks::print_row(rows);
  }
  palpate::benchmarks::print_exponents(rows);
}
