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

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "benchmark/table.h"
#include "equilibrium/equilibrium.h"
#include "exploration/precompute.h"
#include "interaction/bonded_patch.h"
#include "linear/group.h"
#include "schedule/mpi_communicator.h"
#include "solvers/support/box_mesh.h"

namespace palpate {
namespace {

using namespace benchmarks;

/// Bricks along an edge: 6 084, 13 872, 45 000, 147 852, 304 842 unknowns.
constexpr int kBricks[] = {6, 8, 12, 18, 23};
constexpr double kEdge = 0.1;  // m
constexpr double kPatch = 0.2 * kEdge;

int num_unknowns(int bricks) {
  const int points = 2 * bricks + 1;
  return 3 * points * points * (points - 1);
}

Scene make_cube(int bricks) {
  Scene scene;
  scene.mesh =
      test::make_box(ElementOrder::quadratic, {bricks, bricks, bricks}, Vec3::Constant(kEdge));
  for (const Vec3& p : scene.mesh.points) scene.fixed.push_back(p.z() == 0 ? 1 : 0);
  scene.touchable.assign(scene.fixed.size(), 1);
  scene.materials = {make_isotropic(Law::neo_hookean, 10e3, 0.45)};
  return scene;
}

/// The points of the top within the patch move as one.
BondedPatch bond_patch(const TetMesh& mesh) {
  std::vector<Index> points;
  const Vec3 middle(kEdge / 2, kEdge / 2, kEdge);
  for (Index p = 0; p < mesh.num_points(); ++p) {
    const Vec3& x = mesh.points[p];
    if (std::abs(x.z() - kEdge) < 1e-9 && (x - middle).norm() <= kPatch) {
      points.push_back(p);
    }
  }
  return BondedPatch(std::move(points));
}

std::unique_ptr<LinearSolver> make_solver() {
  const MPI_Comm world = MPI_COMM_WORLD;
  return make_group_solver(&world);
}

/// So many configurations lead from rest to the corner of the box and part of the way back.
constexpr int kExplored = 12;

PrecomputeReport explore(const Scene& scene) {
  const MPI_Comm world = MPI_COMM_WORLD;
  const auto communicator = make_mpi_communicator(&world);
  PrecomputeOptions options;
  const Vec3 middle(kEdge / 2, kEdge / 2, kEdge);
  for (Index p = 0; p < scene.mesh.num_points(); ++p) {
    if ((scene.mesh.points[p] - middle).norm() < 1e-9) options.active_nodes = {p};
  }
  options.tip_radius = kPatch;
  options.half_width = kEdge / 10;
  options.resolution = 7;
  options.ranks_per_solve = communicator->size();
  return precompute(scene, options, *communicator,
                    [](const ProgressState& state) { return state.num_done < kExplored; })
      .report;
}

std::vector<Figure> measure(int bricks) {
  const Scene scene = make_cube(bricks);
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
                       body.set_interaction(bond_patch(scene.mesh));
                       pulled = body.solve(Vec3(0, 0, kEdge / 10), body.rest());
                       factorisations = body.work().factorisations;
                     })});
  figures.push_back({"factorisations", 1, static_cast<double>(factorisations)});
  figures.push_back({"iterations", 1, static_cast<double>(pulled.iterations)});
  figures.push_back({"memory, MB", kMega, peak_bytes()});
  forget_peak();
  if (explore(scene).num_solved == 0) std::printf("nothing found\n");
  figures.push_back({"memory of an exploration, MB", kMega, peak_bytes()});
  if (pulled.outcome != Outcome::converged) std::printf("%s\n", pulled.message.c_str());
  return figures;
}

void serve(int most_unknowns) {
  const MPI_Comm world = MPI_COMM_WORLD;
  for (int bricks : kBricks) {
    if (num_unknowns(bricks) > most_unknowns) break;
    serve_group_solver(&world);
    serve_group_solver(&world);
    (void)explore(make_cube(bricks));
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
