// SPDX-License-Identifier: BSD-3-Clause
// How time and memory grow with the size of a body: a cube of Tet10, neo-Hookean (ν = 0.45), held
// at its bottom, a patch of its top pulled by a tenth of its height in one step; and the memory of
// an exploration on 7 × 7 × 7 check-points around that place, which keeps the factors of the starts
// on the way from rest to a corner of the box. Prints a Markdown table and the exponents of the
// growth; on several ranks they factorise together, and the memory is that of the first, the
// largest.
//
//   OPENBLAS_NUM_THREADS=1 palpate_benchmark_growth 160000
//   mpiexec -n 2 palpate_benchmark_growth 160000
//
// The argument is the number of unknowns not to exceed; 310 000 takes 11 GB.
#include <mpi.h>

#include <cstdio>
#include <cstdlib>
#include <vector>

#include "benchmark/cube.h"
#include "benchmark/table.h"
#include "equilibrium/equilibrium.h"
#include "exploration/precompute.h"
#include "linear/group.h"
#include "schedule/mpi_communicator.h"

namespace palpate {
namespace {

using namespace benchmarks;

/// Bricks along an edge: 6 084, 13 872, 45 000, 147 852, 304 842 unknowns.
constexpr int kBricks[] = {6, 8, 12, 18, 23};
constexpr double kPoissonsRatio = 0.45;

std::unique_ptr<LinearSolver> make_solver() {
  const MPI_Comm world = MPI_COMM_WORLD;
  return make_group_solver(&world);
}

/// So many configurations lead from rest to the corner of the box and part of the way back.
constexpr int kExplored = 12;

PrecomputeReport explore(const Scene& scene) {
  const MPI_Comm world = MPI_COMM_WORLD;
  const auto communicator = make_mpi_communicator(&world);
  PrecomputeOptions options = space_of_patch(scene.body.mesh, kEdge / 10, 7);
  options.ranks_per_solve = communicator->size();
  options.linear_solver = linear_solver_names().front();
  return precompute(scene, options, *communicator,
                    [](const ProgressState& state) { return state.num_done < kExplored; })
      .report;
}

std::vector<Figure> measure(int bricks) {
  const Scene scene = make_cube(bricks, kPoissonsRatio);
  forget_peak();
  std::vector<Figure> figures = {{"unknowns", 1, static_cast<double>(num_unknowns(bricks))}};
  EquilibriumOptions options;
  auto solver = make_solver();
  {
    const Assembly assembly(scene);
    const NodalVector u = NodalVector::Zero(assembly.state_size());
    NodalVector force;
    std::vector<double> values;
    assembly.tangent(u, force, values);  // the memory is there from now on
    figures.push_back(
        {"assembly, ms", kMilli, least_seconds([&] { assembly.tangent(u, force, values); })});
    figures.push_back(
        {"residual, ms", kMilli, least_seconds([&] { assembly.residual(u, force); })});
    figures.push_back({"analysis, s", 1, seconds([&] { solver->analyse(assembly.pattern()); })});
    FactorStatus status = FactorStatus::ok;
    figures.push_back(
        {"factorisation, s", 1, seconds([&] { status = solver->factorise(values); })});
    if (status != FactorStatus::ok) std::printf("singular\n");
    figures.push_back({"factor, MB", kMega, static_cast<double>(solver->factor_bytes())});
    Eigen::MatrixXd columns = Eigen::MatrixXd::Ones(assembly.pattern().size, 3);
    figures.push_back({"3 solves, s", 1, seconds([&] { solver->solve(columns); })});
    figures.push_back({"memory so far, MB", kMega, peak_bytes()});
  }
  solver.reset();  // its ranks serve the next one
  Equilibrium pulled;
  long factorisations = 0;
  figures.push_back({"equilibrium, s", 1, seconds([&] {
                       EquilibriumSolver body(scene, options, make_solver());
                       body.set_interaction(bond_patch(scene.body.mesh));
                       pulled = body.solve(Vec3(0, 0, kEdge / 10), body.rest());
                       factorisations = body.work().factorisations;
                     })});
  figures.push_back({"factorisations", 1, static_cast<double>(factorisations)});
  figures.push_back({"iterations", 1, static_cast<double>(pulled.summary.iterations)});
  figures.push_back({"memory, MB", kMega, peak_bytes()});
  forget_peak();
  if (explore(scene).num_solved == 0) std::printf("nothing found\n");
  figures.push_back({"memory of an exploration, MB", kMega, peak_bytes()});
  if (pulled.outcome != Outcome::converged) std::printf("%s\n", pulled.summary.message.c_str());
  return figures;
}

void serve(int most_unknowns) {
  const MPI_Comm world = MPI_COMM_WORLD;
  for (int bricks : kBricks) {
    if (num_unknowns(bricks) > most_unknowns) break;
    serve_group_solver(&world);
    serve_group_solver(&world);
    (void)explore(make_cube(bricks, kPoissonsRatio));
  }
}

void print_table(int most_unknowns) {
  std::vector<std::vector<Figure>> rows;
  for (int bricks : kBricks) {
    if (num_unknowns(bricks) > most_unknowns) break;
    rows.push_back(measure(bricks));
    print_row(rows);
  }
  print_exponents(rows);
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  const int most_unknowns = argc > 1 ? std::atoi(argv[1]) : 160'000;
  int rank = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  rank == 0 ? palpate::print_table(most_unknowns) : palpate::serve(most_unknowns);
  MPI_Finalize();
}
