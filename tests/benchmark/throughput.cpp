// SPDX-License-Identifier: BSD-3-Clause
// Configurations a second of ranks that explore together, beside those of as many runs of one rank
// side by side: the same work on the same cores, without messages and without an end at which some
// wait. Explores the tool spaces of a .palpate file anew, see seed_problem.py:
//
//   OPENBLAS_NUM_THREADS=1 mpiexec -n 2 palpate_benchmark_throughput seed.palpate 4 [folder]
//
// The arguments are the file, whose number of active nodes is a multiple of the ranks, the number
// of rounds, and a folder for files of the explorations; without it they are in memory. Prints a
// Markdown table, a row a round, and the ratio of the two rates. That of the runs side by side is
// the sum of each one's own: the one that ends first does not wait for the others. On a machine
// that is not quiet look at the processor time too, of all ranks: an idle rank sleeps.
#include <mpi.h>
#include <sys/resource.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <string>
#include <vector>

#include "base/error.h"
#include "exploration/precompute.h"
#include "schedule/mpi_communicator.h"
#include "schedule/packing.h"
#include "storage/state_space_file.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

struct Problem {
  Scene scene;
  std::vector<ToolSpaceSetup> setups;
  double solver_tolerance = 0;
};

Problem read(const fs::path& path, int num_ranks) {
  const StateSpaceFile file = StateSpaceFile::open_read_only(path);
  Problem problem{file.read_scene(), {}, file.solver_tolerance()};
  for (const ToolSpace& space : file.read_tool_spaces()) {
    problem.setups.push_back(space.setup);
    const ToolSpaceSetup& first = problem.setups.front();
    if (space.setup.grid.coarsest > 1 || space.setup.grid.resolution != first.grid.resolution ||
        space.setup.grid.half_width != first.grid.half_width) {
      throw InputError("Give a file of uniform grids that are all alike.");
    }
  }
  if (problem.setups.empty() || problem.setups.size() % num_ranks != 0) {
    throw InputError("The file has " + std::to_string(problem.setups.size()) +
                     " active nodes, which is no multiple of the ranks.");
  }
  return problem;
}

PrecomputeReport explore(const Problem& problem, const std::vector<Index>& nodes,
                         const fs::path& file, Communicator& communicator) {
  const ToolSpaceSetup& setup = problem.setups.front();
  PrecomputeOptions options;
  options.active_nodes = nodes;
  options.tip_radius = setup.interaction.tip_radius;
  options.half_width = setup.grid.half_width;
  options.resolution = setup.grid.resolution;
  options.force_limit = setup.policy.force_limit;
  options.equilibrium.tolerance = problem.solver_tolerance;
  options.file = file;
  PrecomputeReport report = precompute(problem.scene, options, communicator, nullptr).report;
  agree(communicator, [&] {
    if (communicator.rank() == 0 && !file.empty()) fs::remove(file);
  });
  return report;
}

/// Of this process, s.
double processor_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

/// Of all ranks.
struct Figures {
  double rate = 0;  // configurations a second
  double processor_seconds = 0;
  std::int64_t configurations = 0;
  long factorisations = 0;
};

template <class Visit>
void for_each_part(Figures& figures, Visit&& visit) {
  visit(figures.rate);
  visit(figures.processor_seconds);
  visit(figures.configurations);
  visit(figures.factorisations);
}

Figures sum(const Figures& mine, Communicator& world) {
  Packer message;
  message.put(mine);
  Figures sum;
  for (const Bytes& bytes : world.all_gather(message.take())) {
    const auto of_rank = Unpacker(bytes).take<Figures>();
    sum.rate += of_rank.rate;
    sum.processor_seconds += of_rank.processor_seconds;
    sum.configurations += of_rank.configurations;
    sum.factorisations += of_rank.factorisations;
  }
  return sum;
}

Figures side_by_side(const Problem& problem, const std::string& folder, Communicator& world) {
  std::vector<Index> nodes;
  for (std::size_t i = 0; i < problem.setups.size(); ++i) {
    if (static_cast<int>(i) % world.size() == world.rank()) {
      nodes.push_back(problem.setups[i].interaction.active_node);
    }
  }
  const std::string name = "alone_" + std::to_string(world.rank()) + ".palpate";
  Figures mine;
  const double start = processor_seconds();
  agree(world, [&] {
    const auto alone = make_serial_communicator();
    const PrecomputeReport report =
        explore(problem, nodes, folder.empty() ? fs::path() : fs::path(folder) / name, *alone);
    mine = {static_cast<double>(report.num_solved) / report.exploration_seconds,
            processor_seconds() - start, report.num_solved, report.work.factorisations};
  });
  return sum(mine, world);
}

/// The rate and what else the report says of all ranks are those of rank 0 here.
Figures together(const Problem& problem, const std::string& folder, Communicator& world,
                 PrecomputeReport& report) {
  std::vector<Index> nodes;
  for (const ToolSpaceSetup& setup : problem.setups) nodes.push_back(setup.interaction.active_node);
  const double start = processor_seconds();
  report = explore(problem, nodes,
                   folder.empty() ? fs::path() : fs::path(folder) / "together.palpate", world);
  Figures mine;
  mine.processor_seconds = processor_seconds() - start;
  if (world.rank() == 0) {
    mine.rate = static_cast<double>(report.num_solved) / report.exploration_seconds;
    mine.configurations = report.num_solved;
    mine.factorisations = report.work.factorisations;
  }
  return sum(mine, world);
}

void print_table(const Problem& problem, int num_rounds, const std::string& folder,
                 Communicator& world) {
  const bool prints = world.rank() == 0;
  if (prints) {
    std::printf(
        "| side by side, 1/s | together, 1/s | ratio | factorisations | together | processor, "
        "s | together | shares | idle, %% of a rank |\n|---|---|---|---|---|---|---|---|---|\n");
  }
  std::vector<double> ratios;
  for (int round = 0; round < num_rounds; ++round) {
    Figures apart;
    if (round % 2 == 0) apart = side_by_side(problem, folder, world);
    PrecomputeReport report;
    const Figures shared = together(problem, folder, world, report);
    if (round % 2 == 1) apart = side_by_side(problem, folder, world);
    if (apart.configurations != shared.configurations) throw BackendError("The spaces differ.");
    ratios.push_back(shared.rate / apart.rate);
    if (!prints) continue;
    std::printf("| %.2f | %.2f | %.3f | %ld | %ld | %.1f | %.1f | %lld | %.2f |\n", apart.rate,
                shared.rate, ratios.back(), apart.factorisations, shared.factorisations,
                apart.processor_seconds, shared.processor_seconds,
                static_cast<long long>(report.schedule.steals_granted),
                100 * report.schedule.idle_seconds / world.size() / report.exploration_seconds);
    std::fflush(stdout);
  }
  std::sort(ratios.begin(), ratios.end());
  if (prints) std::printf("\nmedian of the ratios: %.3f\n", ratios[ratios.size() / 2]);
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  const MPI_Comm mpi_world = MPI_COMM_WORLD;
  int result = EXIT_SUCCESS;
  {
    const auto world = palpate::make_mpi_communicator(&mpi_world);
    try {
      if (argc < 2) throw palpate::InputError("Give a .palpate file.");
      palpate::print_table(palpate::read(argv[1], world->size()),
                           argc > 2 ? std::max(1, std::atoi(argv[2])) : 3, argc > 3 ? argv[3] : "",
                           *world);
    } catch (const std::exception& error) {
      if (world->rank() == 0) std::fprintf(stderr, "%s\n", error.what());
      result = EXIT_FAILURE;
    }
  }
  MPI_Finalize();
  return result;
}
