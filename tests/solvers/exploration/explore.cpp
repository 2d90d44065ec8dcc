// SPDX-License-Identifier: BSD-3-Clause
// Explores a block of tissue into a state-space file, for scripts that disturb it: test_kills.py
// and others. Prints the process id of each rank, and at the end how many configurations were found
// and taken from the file, and the number of allocations of 64 bytes or more of each rank.
//
//   mpiexec -n 2 palpate_test_explore block.palpate <tolerance of the force, 0: a uniform grid>
//     bonded | iterative, which is bonded and has no factor | sphere
//     all | surface, what is kept of the fields
//     [<rank> <number of its allocation of 64 bytes or more that fails>
//      | <rank> <number of its allocation of 64 bytes or more in which it is killed>K
//      | <rank> <MB of address space that it may take beside what it has>M]
#include <mpi.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>
#include <optional>
#include <string>
#include <vector>

#include "equilibrium/tangent_solver.h"
#include "exploration/precompute.h"
#include "schedule/mpi_communicator.h"
#include "solvers/exploration/pressed_corner.h"
#include "solvers/support/block.h"

namespace {

/// Smaller ones do not fail: there is room for them between the others.
constexpr std::size_t kCounted = 64;
/// Of an allocation that fails; 0: none.
std::atomic<std::int64_t> number_that_fails{0};
std::atomic<std::int64_t> number_that_kills{0};
std::atomic<std::int64_t> num_allocations{0};

}  // namespace

void* operator new(std::size_t size) {
  if (size >= kCounted) {
    const std::int64_t number = ++num_allocations;
    if (number == number_that_kills) (void)raise(SIGKILL);
    if (number == number_that_fails) throw std::bad_alloc();
  }
  if (void* place = std::malloc(size)) return place;
  throw std::bad_alloc();
}
void operator delete(void* place) noexcept { std::free(place); }
void operator delete(void* place, std::size_t) noexcept { std::free(place); }

namespace palpate {
namespace {

/// Of this process, in bytes.
rlim_t address_space() {
  long pages = 0;
  if (std::FILE* file = std::fopen("/proc/self/statm", "r")) {
    if (std::fscanf(file, "%ld", &pages) != 1) pages = 0;
    std::fclose(file);
  }
  return static_cast<rlim_t>(pages) * static_cast<rlim_t>(sysconf(_SC_PAGESIZE));
}

/// @param what As on the command line.
void disturb(const std::string& what) {
  if (what.back() != 'M') {
    (what.back() == 'K' ? number_that_kills : number_that_fails) =
        num_allocations + std::stoll(what);
    return;
  }
  constexpr rlim_t kMegabyte = 1'000'000;
  const rlim_t most = address_space() + kMegabyte * std::stoull(what);
  const rlimit limit{most, most};
  if (setrlimit(RLIMIT_AS, &limit) != 0) std::abort();
}

/// @param limit As on the command line, where this rank has one.
int explore(const char* path, double tolerance, const std::string& tool, const std::string& keep,
            const std::optional<std::string>& limit) {
  const MPI_Comm world = MPI_COMM_WORLD;
  const auto communicator = make_mpi_communicator(&world);
  const test::Block block =
      test::make_block(Law::neo_hookean, {ElementOrder::linear, {3, 2, 2}, 0.1, 3000, 0.35});
  PrecomputeOptions options;
  options.tolerance = tolerance;
  if (tool == "sphere") {
    test::press_corner_of_block(options);
    options.contact->spacing = 0.012;
    options.contact->shell.region = [](const Vec3& place) {
      return (place - Vec3(0.07, 0.03, 0.05)).norm() < 0.02;
    };
  } else {
    options.active_nodes = {block.corner, block.middle};
    options.half_width = tool == "iterative" ? 0.008 : 0.02;
    options.resolution = 5;
    if (tool == "iterative") options.linear_solver = kConjugateGradients;
    options.intermediate_states = tolerance > 0 ? 0 : 1;
  }
  options.equilibrium.third_derivatives = true;
  options.file = path;
  options.keep = keep == "all" ? Keep::all : Keep::surface;
  const std::int64_t num_before = num_allocations;
  if (limit) disturb(*limit);
  int result = EXIT_SUCCESS;
  try {
    const auto report = precompute(block.scene, options, *communicator, nullptr).report;
    if (communicator->rank() == 0) {
      std::printf("solved %lld reused %lld\n", static_cast<long long>(report.num_solved),
                  static_cast<long long>(report.num_reused));
    }
  } catch (const std::exception& error) {
    if (communicator->rank() == 0) std::fprintf(stderr, "%s\n", error.what());
    result = EXIT_FAILURE;
  }
  const std::int64_t mine = num_allocations - num_before;
  std::vector<std::int64_t> all(static_cast<std::size_t>(communicator->size()));
  MPI_Gather(&mine, 1, MPI_INT64_T, all.data(), 1, MPI_INT64_T, 0, world);
  if (communicator->rank() == 0) {
    std::printf("allocations");
    for (const std::int64_t number : all) std::printf(" %lld", static_cast<long long>(number));
    std::printf("\n");
  }
  return result;
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  if (argc != 5 && argc != 7) return EXIT_FAILURE;
  MPI_Init(&argc, &argv);
  std::printf("pid %d\n", static_cast<int>(getpid()));
  std::fflush(stdout);
  int rank = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  std::optional<std::string> limit;
  if (argc == 7 && std::atoi(argv[5]) == rank) limit = argv[6];
  const int result = palpate::explore(argv[1], std::atof(argv[2]), argv[3], argv[4], limit);
  MPI_Finalize();
  return result;
}
