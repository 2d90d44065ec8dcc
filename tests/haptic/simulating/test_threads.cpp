// SPDX-License-Identifier: BSD-3-Clause
// A reduced body and two servo loops on threads of their own, by the real clock. How fast this
// machine is decides nothing here.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <string>

#include "base/error.h"
#include "haptic/servo/servo.h"
#include "haptic/simulating/coupled_tool.h"
#include "haptic/simulating/lift.h"
#include "haptic/simulating/reduced_body_thread.h"
#include "haptic/support/block_model.h"
#include "haptic/support/locked_memory.h"
#include "haptic/transport/simulated_board.h"

namespace palpate::test::test_threads {
namespace {

using namespace std::chrono_literals;
using test::kPatience;
using test::Lift;
using test::wait_until;

/// At the least.
constexpr std::size_t kOwnStack = 256 << 10;

struct Threads {
  explicit Threads(Duration release_after = kPatience) {
    std::vector<SimulatedToolOptions> tools;
    for (const Vec3& place : test::block_model().places) {
      tools.emplace_back();
      tools.back().place = place;
      tools.back().release_after = release_after;
    }
    ReducedBodyThreadOptions options;
    options.loop.release_after = kPatience;
    body = std::make_unique<ReducedBodyThread>(test::block_model().model, tools, clock, options);
    for (int h = 0; h < 2; ++h) {
      auto board = std::make_unique<SimulatedBoard>(clock, lifts[h]);
      boards[h] = board.get();
      ServoOptions of_servo;
      of_servo.release_after = of_servo.stop_timeout = kPatience;
      auto profile = make_profile(ProfileKind::palpate_report, board->feature());
      servos[h] = std::make_unique<Servo>(std::move(board), std::move(profile), clock, of_servo);
      ServoSettings settings;
      settings.workspace_centre = tools[static_cast<std::size_t>(h)].place;
      settings.grasp_button = 0;
      servos[h]->set_settings(settings);
      servos[h]->set_touch(std::make_unique<CoupledTool>(body->tool(h)));
    }
  }
  void start() {
    body->start();
    for (const auto& servo : servos) servo->start();
  }
  /// Opens both hands, and closes them when there is a body to hold: what is closed before holds
  /// nothing until it has been open.
  [[nodiscard]] bool grasp() {
    if (!wait_until([&] { return body->statistics().steps > 0; })) return false;
    const auto both = [&](ContactStatus status) {
      return wait_until([&] {
        return servos[0]->latest().contact.status == status &&
               servos[1]->latest().contact.status == status;
      });
    };
    if (!both(ContactStatus::free)) return false;
    for (const auto& lift : lifts) lift->grasps = true;
    return both(ContactStatus::attached);
  }
  /// Of the motors, N.
  [[nodiscard]] double height_of_force(int hand) {
    const BoardStatus status = boards[hand]->status();
    return status.motors_on ? status.force[2] : 0;
  }

  std::shared_ptr<Clock> clock = std::make_shared<MonotonicClock>();
  std::shared_ptr<Lift> lifts[2] = {std::make_shared<Lift>(), std::make_shared<Lift>()};
  std::unique_ptr<ReducedBodyThread> body;
  SimulatedBoard* boards[2] = {};
  std::unique_ptr<Servo> servos[2];
};

TEST(ReducedBodyThread, TwoServosFeelEachOther) {
  Threads threads;
  threads.start();
  ASSERT_TRUE(threads.grasp());
  threads.lifts[0]->height = 0.008;
  EXPECT_TRUE(wait_until([&] { return threads.height_of_force(0) < -0.3; }));
  EXPECT_TRUE(wait_until([&] { return threads.height_of_force(1) > 0.05; }));
  EXPECT_EQ(threads.body->latest().coordinates.size(),
            test::block_model().model->num_coordinates());
  // Of the first tool.
  EXPECT_TRUE(wait_until([&] { return threads.body->latest().coordinates.tail<6>()[2] > 0.003; }));
  EXPECT_GT(threads.body->latest().state.trust, 0.1);
  // Let go, the other one feels it.
  threads.lifts[0]->grasps = false;
  EXPECT_TRUE(wait_until([&] { return threads.height_of_force(0) == 0; }));
  EXPECT_TRUE(wait_until([&] { return threads.height_of_force(1) < 0.01; }));
  const ReducedBodyStatistics statistics = threads.body->statistics();
  EXPECT_GT(statistics.steps, 20U);
  EXPECT_GT(statistics.step_time.largest.count(), 0);
  EXPECT_GT(statistics.rate(), 0);
}

TEST(ReducedBodyThread, NobodyFeelsAForceOfABodyThatHasStopped) {
  Threads threads(200ms);
  threads.start();
  ASSERT_TRUE(threads.grasp());
  threads.lifts[0]->height = 0.008;
  ASSERT_TRUE(wait_until([&] { return threads.height_of_force(0) < -0.3; }));
  threads.body->stop();
  EXPECT_TRUE(wait_until([&] { return (threads.servos[0]->latest().tripped & trips::body) != 0; }));
  EXPECT_TRUE(wait_until(
      [&] { return threads.height_of_force(0) == 0 && threads.height_of_force(1) == 0; }));
  EXPECT_NE(threads.servos[0]->problem().find("The body was not stepped"), std::string::npos)
      << threads.servos[0]->problem();
}

TEST(ReducedBodyThread, SaysWhereItIsNotToBeTrusted) {
  Threads threads;
  threads.start();
  ASSERT_TRUE(threads.grasp());
  threads.lifts[0]->height = 0.04;
  EXPECT_TRUE(wait_until([&] {
    return threads.servos[0]->problem().find("was trained for") != std::string::npos &&
           threads.body->problem().find("was trained for") != std::string::npos;
  }));
  threads.lifts[0]->height = 0;
  EXPECT_TRUE(wait_until(
      [&] { return threads.servos[0]->problem().find("was trained for") == std::string::npos; }));
}

#ifdef PALPATE_LOCKS_MEMORY
TEST(ReducedBodyThread, LocksItsOwnMemory) {
  // Where that is permitted the limit is none.
  const rlimit none{RLIM_INFINITY, RLIM_INFINITY};
  (void)setrlimit(RLIMIT_MEMLOCK, &none);
  const auto& model = test::block_model().model;
  const std::size_t before = test::locked_memory();
  {
    ReducedBodyThread body(model, {{}, {}}, std::make_shared<MonotonicClock>());
    body.start();
    ASSERT_TRUE(wait_until([&] { return body.statistics().steps > 0; }));
    EXPECT_TRUE(body.statistics().memory_locked);
    MemoryRanges ranges;
    ReducedBody(*model, {}).add_memory(ranges);
    EXPECT_GT(total_bytes(ranges), model->points.gradients.size() * sizeof(double));
    const std::size_t locked = test::locked_memory() - before;
    EXPECT_GT(locked, total_bytes(ranges) + kOwnStack);
    EXPECT_LT(locked, total_bytes(ranges) + (std::size_t{4} << 20));
  }
  EXPECT_EQ(test::locked_memory(), before);
}
#endif

TEST(ReducedBodyThread, SaysWhatIsWrongWithItsInput) {
  const auto clock = std::make_shared<MonotonicClock>();
  const auto& model = test::block_model().model;
  EXPECT_THROW(ReducedBodyThread(model, {{}}, clock), InputError);
  ReducedBodyThreadOptions options;
  options.priority = 100;
  EXPECT_THROW(ReducedBodyThread(model, {{}, {}}, clock, options), InputError);
  ReducedBodyThread body(model, {{}, {}}, clock);
  body.start();
  EXPECT_THROW(body.start(), BackendError);
}

}  // namespace
}  // namespace palpate::test::test_threads
