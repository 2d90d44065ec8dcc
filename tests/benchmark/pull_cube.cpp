// SPDX-License-Identifier: BSD-3-Clause
// Our part of fenicsx_large.py, which starts it: a cube of Tet10, neo-Hookean, held at its bottom,
// a patch of its top pulled by a tenth of its height from rest, solved for without a factor. Prints
// as JSON what it found and what that took: seconds of the processor, and bytes beyond the mesh.
//
//   OPENBLAS_NUM_THREADS=1 palpate_benchmark_pull_cube 23 0.45
//
// The arguments are the bricks along an edge and Poisson's ratio.
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "benchmark/cube.h"
#include "benchmark/table.h"
#include "equilibrium/equilibrium.h"

namespace palpate {
namespace {

using namespace benchmarks;

int run(int bricks, double nu) {
  const Scene scene = make_cube(bricks, nu);
  forget_peak();
  const double before = peak_bytes();
  std::unique_ptr<EquilibriumSolver> solver;
  const double set_up = processor_seconds([&] {
    solver = std::make_unique<EquilibriumSolver>(scene, EquilibriumOptions{}, nullptr);
    solver->set_interaction(bond_patch(scene.body.mesh));
  });
  Equilibrium rest;
  const double at_rest = processor_seconds([&] { rest = solver->rest(); });
  const long before_pull = solver->work().krylov_iterations;
  Equilibrium pulled;
  const double configuration =
      processor_seconds([&] { pulled = solver->solve(Vec3(0, 0, kEdge / 10), rest); });
  if (pulled.outcome != Outcome::converged) {
    std::fprintf(stderr, "%s\n", pulled.summary.message.c_str());
    return EXIT_FAILURE;
  }
  const nlohmann::json figures = {
      {"unknowns", num_unknowns(bricks)},
      {"set_up", set_up},
      {"rest", at_rest},
      {"configuration", configuration},
      {"newton", pulled.summary.iterations},
      {"iterations", solver->work().krylov_iterations - before_pull},
      {"bytes", peak_bytes() - before},
      {"force", std::vector<double>(pulled.reaction.begin(), pulled.reaction.end())},
      {"stiffness", std::vector<double>(pulled.stiffness.reshaped().begin(),
                                        pulled.stiffness.reshaped().end())}};
  std::printf("%s\n", figures.dump().c_str());
  return EXIT_SUCCESS;
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "How many bricks along an edge, and which Poisson's ratio?\n");
    return EXIT_FAILURE;
  }
  return palpate::run(std::atoi(argv[1]), std::atof(argv[2]));
}
