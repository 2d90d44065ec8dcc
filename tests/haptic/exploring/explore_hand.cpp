// SPDX-License-Identifier: BSD-3-Clause
// Explores the space around a hand that rests on a block of tissue, with explorers in processes of
// their own, for test_kills.py. Prints the number of configurations that it has found each time it
// has grown, and "complete" when nothing is left to be done.
//
//   palpate_test_explore_hand block.palpate build/bin/palpate-explore
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <memory>
#include <optional>
#include <thread>

#include "haptic/exploring/hand_exploration.h"
#include "solvers/following/ball_on_block.h"

namespace palpate {
namespace {

void explore(const char* file, const char* program) {
  setenv("PALPATE_EXPLORE", program, 1);
  const test::BallOnBlock ball;
  HandExplorationOptions options;
  options.space = ball.options;
  options.space.file = file;
  options.num_explorers = 2;
  const Vec3 place = ball.hand().hand().place;
  HandExploration exploration(
      ball.scene, options,
      [&] {
        return std::optional(HandMotion{place, Vec3::Zero()});
      },
      [](const std::shared_ptr<const Touchable>& /*body*/) {});
  std::int64_t told = -1;
  while (true) {
    const auto figures = exploration.figures();
    if (figures.session.num_solved > told) {
      told = figures.session.num_solved;
      std::printf("%lld\n", static_cast<long long>(told));
      std::fflush(stdout);
    }
    if (figures.session.is_complete) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  exploration.end();
  std::printf("complete\n");
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  if (argc != 3) return EXIT_FAILURE;
  try {
    palpate::explore(argv[1], argv[2]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
