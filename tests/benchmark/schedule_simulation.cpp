// SPDX-License-Identifier: BSD-3-Clause
// How far the exploration of many active nodes, or of one space of a rigid tool, would scale: the
// engine explores on 1 … 4096 simulated ranks, with the configurations of a recorded space and the
// time that each took in place of the mechanics. Prints a Markdown table. Beside it are the floor
// (no rank is ever idle, or the longest way from rest takes longer) and, for the same
// configurations, a fixed share of the tool spaces and a master that hands out the transitions;
// efficiencies in %.
//
//   palpate_benchmark_schedule_simulation <factorisation, s> <tool spaces> space.palpate …
//   palpate_benchmark_schedule_simulation <factorisation, s> <number>/rank space.palpate …
//
// The first is of so many tool spaces on any number of ranks (strong scaling), the second of so
// many on each rank (weak scaling). The factorisation is that of a start which another rank has
// made already. Each tool space behaves as one that is drawn from the recorded ones. Of several
// recordings of the same space each configuration has its least time: on a machine that is not
// quiet that is nearest to its cost.
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
#include "solvers/support/forest.h"
#include "solvers/support/replay.h"
#include "storage/state_space_file.h"

namespace palpate {
namespace {

using test::Forest;
using test::Recording;
using test::TaskTree;

constexpr int kRanks[] = {1, 4, 16, 64, 128, 256, 1024, 4096};
/// Doubles of each degree of freedom that a state is made of: u and the three columns of v.
constexpr int kColumns = 4;
constexpr unsigned kSeed = 1;

/// @throws InputError recordings of one tool space that differ.
std::vector<Recording> read_recordings(const std::vector<std::string>& paths) {
  std::map<ToolSpaceId, Recording> recordings;
  for (const std::string& path : paths) {
    const StateSpaceFile file = StateSpaceFile::open_read_only(path);
    for (const ToolSpace& space : file.read_tool_spaces()) {
      const ToolSpaceId id = space.setup.id;
      const std::vector<Configuration> all = file.read_summaries({id});
      const auto [here, is_new] =
          recordings.emplace(id, Recording{space.setup, {all.begin(), all.end()}});
      if (is_new) continue;
      std::vector<ConfigurationSummary>& known = here->second.configurations;
      if (!(here->second.setup == space.setup) || known.size() != all.size()) {
        throw InputError(path + " has another space of " + space.setup.name() +
                         " than the file before it.");
      }
      for (std::size_t c = 0; c < all.size(); ++c) {
        known[c].seconds = std::min(known[c].seconds, all[c].seconds);
      }
    }
  }
  if (recordings.empty()) throw InputError("The files have no tool space.");
  std::vector<Recording> all;
  for (const auto& [id, recording] : recordings) all.push_back(recording);
  return all;
}

/// Each configuration behind the one that it was found from; the first, which takes no time, before
/// those that were found from none.
TaskTree to_tree(const Recording& recording) {
  std::map<CheckPoint, std::vector<const ConfigurationSummary*>> children;
  TaskTree tree{{0}, {-1}};
  std::vector<CheckPoint> found{{}};
  const auto add = [&](const ConfigurationSummary& c, std::size_t parent) {
    found.push_back(c.check_point);
    tree.seconds.push_back(c.seconds);
    tree.parent.push_back(static_cast<int>(parent));
  };
  for (const ConfigurationSummary& c : recording.configurations) {
    if (c.check_point == c.parent) {
      add(c, 0);
    } else {
      children[c.parent].push_back(&c);
    }
  }
  for (std::size_t i = 1; i < found.size(); ++i) {
    for (const ConfigurationSummary* c : children[found[i]]) add(*c, i);
  }
  return tree;
}

/// How many tool spaces there are.
struct Problem {
  int num_spaces = 0;
  /// So many on each rank, else in all.
  bool on_each_rank = false;

  [[nodiscard]] int num_on(int ranks) const {
    return on_each_rank ? num_spaces * ranks : num_spaces;
  }
};

void draw_spaces(int number, Forest& forest) {
  std::mt19937 random(kSeed);
  forest.tree_of_site.clear();
  for (int i = 0; i < number; ++i) {
    forest.tree_of_site.push_back(static_cast<int>(random() % forest.trees.size()));
  }
}

void print_table(double factorisation_seconds, const Problem& problem,
                 const std::vector<std::string>& paths) {
  const std::vector<Recording> recordings = read_recordings(paths);
  Forest forest;
  for (const Recording& recording : recordings) forest.trees.push_back(to_tree(recording));
  const StateSpaceFile file = StateSpaceFile::open_read_only(paths.front());
  test::ReplayOptions options;
  options.state_bytes = file.read_scene().body.mesh.points.size() * 3 * kColumns * sizeof(double);
  options.factorisation_seconds = factorisation_seconds;
  test::MasterOptions of_master;
  of_master.state_bytes = options.state_bytes;
  of_master.start_seconds = factorisation_seconds;
  draw_spaces(problem.num_spaces, forest);
  std::printf("%d tool spaces%s, longest way %.3g s, state %.0f kB\n\n", problem.num_spaces,
              problem.on_each_rank ? " a rank" : "", forest.critical_path(),
              1e-3 * static_cast<double>(options.state_bytes));
  std::printf(
      "| ranks | configurations | s | floor, s | engine | fixed share | master | shares | factors "
      "made again | messages a configuration | simulated in, s "
      "|\n|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const int ranks : kRanks) {
    draw_spaces(problem.num_on(ranks), forest);
    const auto start = std::chrono::steady_clock::now();
    const test::Replay engine = test::replay(recordings, forest.tree_of_site, ranks, options);
    const double took =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const auto efficiency = [&](double makespan) {
      return 100 * forest.work() / (ranks * makespan);
    };
    const ScheduleReport& schedule = engine.report.schedule;
    std::printf(
        "| %d | %lld | %.4g | %.4g | %.1f | %.1f | %.1f | %lld | %lld | %.2f | %.0f |\n", ranks,
        static_cast<long long>(forest.num_tasks()), engine.makespan, forest.least_makespan(ranks),
        efficiency(engine.makespan), efficiency(test::static_makespan(forest, ranks)),
        efficiency(test::master_makespan(forest, ranks, of_master)),
        static_cast<long long>(schedule.steals_granted),
        static_cast<long long>(engine.num_factorised_again),
        static_cast<double>(schedule.messages) / static_cast<double>(engine.report.num_solved),
        took);
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  if (argc < 4) {
    std::printf(
        "Give the time of a factorisation, the number of tool spaces, in all or a rank, and "
        "recorded spaces: %s 0.025 1000 space.palpate … or %s 0.025 4/rank space.palpate …\n",
        argv[0], argv[0]);
    return EXIT_FAILURE;
  }
  try {
    const std::string number = argv[2];
    palpate::print_table(std::atof(argv[1]),
                         {std::atoi(argv[2]), number.find("/rank") != std::string::npos},
                         {argv + 3, argv + argc});
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return EXIT_FAILURE;
  }
}
