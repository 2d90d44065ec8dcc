// SPDX-License-Identifier: BSD-3-Clause
// Explores a block of tissue into a state-space file, for test_kills.py, which kills it. Prints the
// process id of each rank, and at the end how many configurations were found and taken from the
// file.
//
//   mpiexec -n 2 palpate_test_explore block.palpate <tolerance of the force, 0: a uniform grid>
//     bonded | sphere   all | surface, what is kept of the fields
#include <mpi.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>

#include "exploration/precompute.h"
#include "schedule/mpi_communicator.h"
#include "solvers/support/block.h"

namespace palpate {
namespace {

int explore(const char* path, double tolerance, const std::string& tool, const std::string& keep) {
  const MPI_Comm world = MPI_COMM_WORLD;
  const auto communicator = make_mpi_communicator(&world);
  const test::Block block =
      test::make_block(Law::neo_hookean, {ElementOrder::linear, {3, 2, 2}, 0.1, 3000, 0.35});
  PrecomputeOptions options;
  options.tolerance = tolerance;
  if (tool == "sphere") {
    options.contact.emplace();
    options.contact->tool.radius = 0.015;
    options.contact->spacing = 0.008;
    options.contact->shell.depth = 0.004;
    // The free end.
    options.contact->shell.region = [](const Vec3& place) { return place.x() > 0.07; };
  } else {
    options.active_nodes = {block.corner, block.middle};
    options.half_width = 0.02;
    options.resolution = 5;
    options.intermediate_states = tolerance > 0 ? 0 : 1;
  }
  options.equilibrium.third_derivatives = true;
  options.file = path;
  options.keep = keep == "all" ? Keep::all : Keep::surface;
  try {
    const auto report = precompute(block.scene, options, *communicator, nullptr).report;
    if (communicator->rank() == 0) {
      std::printf("solved %lld reused %lld\n", static_cast<long long>(report.num_solved),
                  static_cast<long long>(report.num_reused));
    }
    return EXIT_SUCCESS;
  } catch (const std::exception& error) {
    if (communicator->rank() == 0) std::fprintf(stderr, "%s\n", error.what());
    return EXIT_FAILURE;
  }
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  if (argc != 5) return EXIT_FAILURE;
  MPI_Init(&argc, &argv);
  std::printf("pid %d\n", static_cast<int>(getpid()));
  std::fflush(stdout);
  const int result = palpate::explore(argv[1], std::atof(argv[2]), argv[3], argv[4]);
  MPI_Finalize();
  return result;
}
