// SPDX-License-Identifier: BSD-3-Clause
// How fast a hand can be followed: the strategy that explores where the hand is going
// (following/follow_tool.h) by a virtual clock, with the configurations of a complete space of a
// rigid tool and the time that each took in place of the mechanics. The hand palpates at random: it
// glides over the surface, its velocity is forgotten within 0.35 s, and it presses 1 to 7 mm deep.
// Prints Markdown tables: the share of the ticks in computed cells, the first second left out, and
// the longest time in cells that were not computed, by the speed of the hand and the number of
// cores.
//
//   palpate_benchmark_following space.palpate [--extent 80] [--seconds 20] [--seed 1]
//
// The extent of the palpation is in mm around the middle of the pressed places.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "base/error.h"
#include "benchmark/arguments.h"
#include "benchmark/palpating_hand.h"
#include "following/follow_tool.h"
#include "interaction/interaction_spec.h"
#include "solvers/following/simulated_following.h"
#include "storage/state_space_file.h"

namespace palpate {
namespace {

const std::map<std::string, double> kDefaults{{"extent", 80}, {"seconds", 20}, {"seed", 1}};

constexpr double kSpeeds[] = {0.01, 0.03, 0.1, 0.2, 0.4};
constexpr int kCores[] = {1, 2, 4, 8, 32, 128, 1024};
class Bench {
 public:
  explicit Bench(const std::string& path) : file_(StateSpaceFile::open_read_only(path)) {
    for (const ToolSpace& space : file_.read_tool_spaces()) {
      if (!space.setup.presses() || space.setup.region) continue;
      setup_ = space.setup;
      for (const Configuration& c : file_.read_summaries(space.setup.key())) {
        recorded_[c.check_point] = c;
      }
    }
    if (recorded_.empty()) throw InputError("The file has no space of a rigid tool.");
    scene_ = file_.read_scene(setup_.body);
    tools_ = std::make_unique<InteractionFactory>(scene_.body, file_.read_rest(setup_.body));
    clearance_ = tools_->clearance(setup_.interaction);
    shell_.depth = setup_.policy.depth;
    setup_.policy.tolerance = 0;
    double seconds = 0;
    double number = 0;
    for (const auto& [p, c] : recorded_) {
      if ((c.flags & flags::touches_nothing) != 0) continue;
      seconds += c.seconds;
      ++number;
    }
    mean_seconds_ = seconds / number;
    std::printf("%.0f configurations of %.0f ms in the mean, cells of %.3g mm\n\n", number,
                1e3 * mean_seconds_, 1e3 * setup_.grid.coarsest * setup_.grid.spacing());
  }

  void print(double extent, double seconds, unsigned seed) const {
    // Of all that is pressed, the place that is nearest to its middle.
    Vec3 mean = Vec3::Zero();
    std::vector<Vec3> pressed;
    for (const auto& [p, c] : recorded_) {
      if ((c.flags & flags::touches_nothing) != 0) continue;
      pressed.push_back(clearance_->approach(setup_.grid.place(p)).touched);
      mean += pressed.back();
    }
    mean /= static_cast<double>(pressed.size());
    const Vec3 middle = *std::min_element(
        pressed.begin(), pressed.end(),
        [&](const Vec3& a, const Vec3& b) { return (a - mean).norm() < (b - mean).norm(); });
    std::printf("| hand, mm/s |");
    for (const int cores : kCores) std::printf(" %d |", cores);
    std::printf("\n|---|");
    for (std::size_t i = 0; i < std::size(kCores); ++i) std::printf("---|");
    std::printf("\n");
    for (const double speed : kSpeeds) {
      std::printf("| %.0f |", 1e3 * speed);
      for (const int cores : kCores) {
        const auto [share, longest] = measure(middle, extent, seconds, seed, speed, cores);
        std::printf(" %.1f %%, %.2f s |", 100 * share, longest);
        std::fflush(stdout);
      }
      std::printf("\n");
    }
  }

 private:
  [[nodiscard]] std::pair<double, double> measure(const Vec3& middle, double extent, double seconds,
                                                  unsigned seed, double speed, int cores) const {
    FollowTool strategy(setup_, clearance_, scene_.body.touchable, shell_);
    ShellCells cells(*clearance_, setup_.grid, scene_.body.touchable, shell_);
    test::FollowingOptions options;
    options.solvers = cores;
    options.seconds = [this](const Transition& transition) {
      const auto known = recorded_.find(transition.target);
      const double from_start = known != recorded_.end() ? known->second.seconds : mean_seconds_;
      return transition.needs_no_start() ? 2 * from_start : from_start;
    };
    test::FollowingSimulation simulation(strategy, cells, options,
                                         [this](const Transition& t, ConfigurationSummary& found) {
                                           const CheckPoint parent = found.parent;
                                           const auto known = recorded_.find(t.target);
                                           if (known != recorded_.end()) found = known->second;
                                           found.parent = parent;
                                         });
    PalpatingHand hand(*clearance_, middle, extent, speed, seed);
    const auto move = [&](double) { return hand.next(); };
    simulation.run(move, 1);
    const test::Following before = simulation.result();
    simulation.run(move, seconds);
    const test::Following& after = simulation.result();
    return {static_cast<double>(after.in_known - before.in_known) /
                static_cast<double>(after.in_shell - before.in_shell),
            after.longest_miss};
  }

  StateSpaceFile file_;
  ToolSpaceSetup setup_;
  Scene scene_;
  std::unique_ptr<InteractionFactory> tools_;
  std::shared_ptr<const ToolClearance> clearance_;
  ShellOptions shell_;
  std::map<CheckPoint, ConfigurationSummary> recorded_;
  double mean_seconds_ = 0;
};

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  using namespace palpate;
  try {
    const Arguments arguments(argc, argv, kDefaults);
    Bench(arguments.scene)
        .print(1e-3 * arguments["extent"], arguments["seconds"],
               static_cast<unsigned>(arguments["seed"]));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return EXIT_FAILURE;
  }
}
