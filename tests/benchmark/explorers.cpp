// SPDX-License-Identifier: BSD-3-Clause
// A hand is followed on this machine, in real time, by explorers in processes of their own: the
// share of the ticks in which the hand is in a cell that is computed, the first second left out,
// how long the first cell takes, and what the states take. The hand palpates at random as that of
// following.cpp. Prints a row of a Markdown table.
//
//   palpate_benchmark_explorers space.palpate build/bin/palpate-explore [--explorers 2]
//       [--speed 30] [--extent 80] [--seconds 20] [--seed 1] [--spacing 8] [--depth 8] [--force 0]
//
// The scene and the tool are those of the file. If it has a complete space, that tells how wrong
// the force is, in cells that are computed and outside of them, where configurations around give
// it. Lengths are in mm, the speed is in mm/s, the force in N.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "base/clock.h"
#include "base/error.h"
#include "benchmark/arguments.h"
#include "benchmark/palpating_hand.h"
#include "explorers/explorer_hub.h"
#include "explorers/keys.h"
#include "explorers/local_explorers.h"
#include "interaction/interaction_spec.h"
#include "interpolation/tool_force.h"
#include "storage/state_space_file.h"
#include "storage/stored_touch_space.h"

namespace palpate {
namespace {

const std::map<std::string, double> kDefaults{{"explorers", 2}, {"speed", 30}, {"extent", 80},
                                              {"seconds", 20},  {"seed", 1},   {"spacing", 8},
                                              {"depth", 8},     {"force", 0}};

/// The time between two poses that the session hears of, s.
constexpr double kBetweenPoses = 0.01;

/// The force that is felt, beside that of a complete space.
class Felt {
 public:
  /// @param reach ToolForce's.
  Felt(const StateSpaceFile& file, TouchSpace begun, double reach)
      : space_(std::move(begun)), whole_(make_touch_space_without_modes(file)) {
    options_.reach_of_states = reach;
    exact_ = std::make_unique<ToolForce>(whole_.list_pressing(), Method::energy_hermite);
  }
  void take(const SpaceChunk& chunk) {
    palpate::take(chunk, space_);
    force_ = std::make_unique<ToolForce>(space_.list_pressing(), Method::energy_hermite, options_);
  }
  void feel(const Vec3& place) {
    const TouchResult exact = exact_->evaluate(place);
    if (exact.support != Support::inside || exact.force.isZero(0)) return;
    const bool is_known = force_ && force_->has_cell(place);
    const bool is_near = force_ && force_->expands(place);
    sizes_.push_back(exact.force.norm());
    if (!is_known && !is_near) return;
    (is_known ? in_cells_ : beside_)
        .push_back((force_->evaluate(place).force - exact.force).norm());
  }
  /// Of the ticks in which something is to be felt.
  void print() {
    if (sizes_.empty()) return;
    const double usual = quantile(sizes_, 0.9);
    const auto all = static_cast<double>(sizes_.size());
    std::printf(
        "\n| force | share of ticks, %% | error, %% of %.2f N: median | 90 %% "
        "|\n|---|---|---|---|\n",
        usual);
    for (const auto& [name, errors] : {std::pair("in computed cells", &in_cells_),
                                       std::pair("from configurations around", &beside_)}) {
      std::printf("| %s | %.1f | %.1f | %.1f |\n", name,
                  100 * static_cast<double>(errors->size()) / all,
                  100 * quantile(*errors, 0.5) / usual, 100 * quantile(*errors, 0.9) / usual);
    }
  }

 private:
  static double quantile(std::vector<double>& values, double share) {
    if (values.empty()) return 0;
    std::sort(values.begin(), values.end());
    return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
  }

  TouchSpace space_;
  TouchSpace whole_;
  InterpolationOptions options_;
  std::unique_ptr<ToolForce> exact_;
  std::unique_ptr<ToolForce> force_;
  std::vector<double> sizes_;
  std::vector<double> in_cells_;
  std::vector<double> beside_;
};

int run(const std::string& path, const std::string& program, const Arguments& arguments) {
  const StateSpaceFile file = StateSpaceFile::open_read_only(path);
  PrecomputeOptions options;
  BodyId body = kFirstBody;
  for (const ToolSpace& space : file.read_tool_spaces()) {
    if (!space.setup.presses()) continue;
    options.contact.emplace();
    options.contact->tool = space.setup.interaction.tool;
    body = space.setup.body;
    break;
  }
  if (!options.contact) throw InputError("The file has no space of a rigid tool.");
  options.contact->spacing = 1e-3 * arguments["spacing"];
  options.contact->shell.depth = 1e-3 * arguments["depth"];
  options.force_limit = arguments["force"];
  const auto scene = std::make_shared<const Scene>(file.read_scene(body));

  const SteadyClock::time_point started = SteadyClock::now();
  std::string folder = (std::filesystem::temp_directory_path() / "palpate_keys_XXXXXX").string();
  if (mkdtemp(folder.data()) == nullptr) throw BackendError("No folder for the keys can be made.");
  make_keys(folder);
  ExplorerHub hub(folder, "tcp://127.0.0.1:*");
  LocalExplorers explorers(program, static_cast<int>(arguments["explorers"]), folder,
                           hub.endpoint());
  FollowSession session(scene, options);
  hub.explore_for(&session);
  const double prepared = seconds_since(started);

  InteractionFactory tools(scene->body, file.read_rest(body));
  const ToolSpaceSetup& setup = session.job().setup;
  const auto clearance = tools.clearance(setup.interaction);
  ShellCells cells(*clearance, setup.grid, scene->body.touchable, options.contact->shell);
  const Vec3 middle = clearance->approach(session.first_hand().place).touched;
  PalpatingHand hand(*clearance, middle, 1e-3 * arguments["extent"], 1e-3 * arguments["speed"],
                     static_cast<unsigned>(arguments["seed"]));
  Felt felt(file, session.empty_space(), NearStates::usual_reach(setup.grid));
  std::map<CheckPoint, char> known;
  long in_shell = 0;
  long in_known = 0;
  double first_cell = -1;
  double longest_miss = 0;
  double missed_since = 0;
  bool is_missing = false;
  const SteadyClock::time_point begin = SteadyClock::now();
  double next_pose = 0;
  HandMotion motion = hand.next();
  for (long tick = 1; 1e-3 * static_cast<double>(tick) < 1 + arguments["seconds"]; ++tick) {
    const double time = PalpatingHand::kTick * static_cast<double>(tick);
    const double ahead = time - seconds_since(begin);
    if (ahead > 0) std::this_thread::sleep_for(std::chrono::duration<double>(ahead));
    motion = hand.next();
    if (time >= next_pose) {
      next_pose = time + kBetweenPoses;
      session.follow(HandPrediction(motion));
      if (hub.exchange()) {
        while (const auto chunk = session.take_chunk()) {
          felt.take(*chunk);
          for (const ToolSpaceChunk& part : chunk->tool_spaces) {
            for (const ConfigurationSummary& c : part.configurations) known[c.check_point] = 1;
          }
        }
      }
      (void)explorers.watch();
    }
    if (time > 1) felt.feel(motion.place);
    const CheckPoint numbers = cells.numbers_of(motion.place);
    if (!cells.holds(numbers)) continue;
    const Cell cell = cells.root(numbers);
    bool is_known = true;
    for (int corner = 0; corner < 8; ++corner) {
      is_known = is_known && known.count(corner_of(cell, corner)) > 0;
    }
    if (is_known && first_cell < 0) first_cell = seconds_since(started);
    if (is_known) {
      if (is_missing) longest_miss = std::max(longest_miss, time - missed_since);
    } else if (!is_missing) {
      missed_since = time;
    }
    is_missing = !is_known;
    if (time < 1) continue;
    ++in_shell;
    in_known += is_known ? 1 : 0;
  }
  const FollowSession::Figures figures = session.figures();
  std::printf(
      "| explorers | hand, mm/s | ticks in computed cells, %% | longest miss, s | ready, s | "
      "first cell, s | states | ms each |\n|---|---|---|---|---|---|---|---|\n");
  std::printf("| %.0f | %.0f | %.1f | %.2f | %.2f | %.2f | %lld | %.0f |\n", arguments["explorers"],
              arguments["speed"], 100.0 * static_cast<double>(in_known) / std::max(1L, in_shell),
              longest_miss, prepared, first_cell, static_cast<long long>(figures.num_solved),
              1e3 * figures.seconds / std::max<double>(1, static_cast<double>(figures.num_solved)));
  felt.print();
  std::filesystem::remove_all(folder);
  return EXIT_SUCCESS;
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  using namespace palpate;
  try {
    if (argc < 3) throw InputError("Give a .palpate file and the program palpate-explore.");
    const std::string program = argv[2];
    std::rotate(argv + 2, argv + 3, argv + argc);
    return run(argv[1], program, Arguments(argc - 1, argv, kDefaults));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return EXIT_FAILURE;
  }
}
