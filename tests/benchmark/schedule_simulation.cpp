// SPDX-License-Identifier: BSD-3-Clause
// How far the exploration of many active nodes would scale: what the configurations of a recorded
// space took is replayed on 1 … 4096 simulated ranks, with transposition-driven scheduling (the
// code that runs under MPI), with a fixed share of the active nodes and with a master that hands
// out the transitions. Prints a Markdown table; efficiencies in %.
//
//   palpate_benchmark_schedule_simulation space.palpate [active nodes] [seed]
//
// Each active node behaves as one that is drawn from the recorded ones.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "base/error.h"
#include "schedule/simulator.h"
#include "state_space/state_space_file.h"

namespace palpate {
namespace {

constexpr int kRanks[] = {1, 4, 16, 64, 256, 1024, 4096};
/// Doubles of each degree of freedom that a state is made of: u and the three columns of v.
constexpr int kColumns = 4;

/// The configurations of a site, each behind the one that it was found from; rest is the first. One
/// whose parent is not there follows from rest.
TaskTree to_tree(const std::vector<Configuration>& configurations) {
  TaskTree tree;
  std::map<CheckPoint, std::vector<const Configuration*>> children;
  std::map<CheckPoint, bool> is_there;
  for (const Configuration& c : configurations) is_there[c.check_point] = true;
  const CheckPoint rest{};
  tree.seconds.push_back(0);
  tree.parent.push_back(-1);
  for (const Configuration& c : configurations) {
    if (c.check_point == rest) {
      tree.seconds.front() += c.seconds;
    } else {
      children[is_there.count(c.parent) > 0 ? c.parent : rest].push_back(&c);
    }
  }
  std::vector<CheckPoint> found{rest};
  for (std::size_t i = 0; i < found.size(); ++i) {
    const auto of_this = children.extract(found[i]);
    if (of_this.empty()) continue;
    for (const Configuration* c : of_this.mapped()) {
      found.push_back(c->check_point);
      tree.seconds.push_back(c->seconds);
      tree.parent.push_back(static_cast<int>(i));
    }
  }
  return tree;
}

Forest read_forest(const StateSpaceFile& file, int num_sites, unsigned seed) {
  Forest forest;
  for (const SiteSpace& space : file.read_sites()) {
    forest.trees.push_back(to_tree(file.read_summaries(space.site.active_node)));
  }
  if (forest.trees.empty()) throw InputError("The file has no active node.");
  std::mt19937 random(seed);
  for (int i = 0; i < num_sites; ++i) {
    forest.tree_of_site.push_back(static_cast<int>(random() % forest.trees.size()));
  }
  return forest;
}

void print_table(const std::string& path, int num_sites, unsigned seed) {
  const StateSpaceFile file = StateSpaceFile::open_read_only(path);
  const Forest forest = read_forest(file, num_sites, seed);
  ForestOptions options;
  options.state_bytes = file.read_scene().mesh.points.size() * 3 * kColumns * sizeof(double);
  std::printf("%d active nodes, %lld configurations, %.0f s of work, critical path %.3g s, state "
              "%.0f kB\n\n",
              num_sites, static_cast<long long>(forest.num_tasks()), forest.work(),
              forest.critical_path(), 1e-3 * static_cast<double>(options.state_bytes));
  std::printf(
      "| ranks | makespan, s | TDS | at most | round robin | by hash | master-worker | shares | "
      "messages a configuration | simulated in, s |\n"
      "|---|---|---|---|---|---|---|---|---|---|\n");
  for (const int ranks : kRanks) {
    const auto start = std::chrono::steady_clock::now();
    const ForestResult tds = simulate_tds(forest, ranks, options);
    const double took =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const double least = std::max(forest.critical_path(), forest.work() / ranks);
    const auto round_robin = simulate_static(forest, ranks, StaticShare::round_robin);
    const auto by_hash = simulate_static(forest, ranks, StaticShare::by_hash);
    const auto master_worker = simulate_master_worker(forest, ranks, options);
    std::printf("| %d | %.4g | %.1f | %.1f | %.1f | %.1f | %.1f | %lld | %.2f | %.1f |\n", ranks,
                tds.makespan, 100 * tds.efficiency, 100 * forest.work() / (ranks * least),
                100 * round_robin.efficiency, 100 * by_hash.efficiency,
                100 * master_worker.efficiency,
                static_cast<long long>(tds.report.steals_granted),
                static_cast<double>(tds.report.messages) / static_cast<double>(tds.tasks), took);
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  if (argc < 2) {
    std::printf("Give a recorded space: %s space.palpate [active nodes, 1000] [seed, 1]\n",
                argv[0]);
    return EXIT_FAILURE;
  }
  try {
    palpate::print_table(argv[1], argc > 2 ? std::atoi(argv[2]) : 1000,
                 argc > 3 ? static_cast<unsigned>(std::atoi(argv[3])) : 1);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return EXIT_FAILURE;
  }
}
