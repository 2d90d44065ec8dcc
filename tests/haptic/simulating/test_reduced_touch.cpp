// SPDX-License-Identifier: BSD-3-Clause
// Devices that touch a reduced body together, by the real clock. What their motors do is what
// counts; how fast this machine is decides nothing.
#include <gtest/gtest.h>

#include "base/error.h"
#include "haptic/servo/reduced_touch.h"
#include "haptic/simulating/lift.h"
#include "haptic/support/block_model.h"
#include "haptic/support/guarded_transport.h"
#include "haptic/transport/simulated_board.h"

namespace palpate::test::test_reduced_touch {
namespace {

using namespace std::chrono_literals;
using test::kPatience;
using test::Lift;
using test::wait_until;

constexpr double kLimit = 0.4;  // N

struct Board {
  std::shared_ptr<Lift> lift = std::make_shared<Lift>();
  std::unique_ptr<SimulatedBoard> board;
  GuardianChannel guardian;
};

class ReducedTouchTest : public testing::Test {
 protected:
  std::unique_ptr<ReducedBodyThread> make_body() {
    std::vector<SimulatedToolOptions> tools;
    for (const Vec3& place : test::block_model().places) {
      tools.emplace_back();
      tools.back().place = place;
      tools.back().release_after = kPatience;
    }
    ReducedBodyThreadOptions options;
    options.loop.release_after = kPatience;
    return std::make_unique<ReducedBodyThread>(test::block_model().model, tools, clock_, options);
  }

  std::unique_ptr<Servo> make_servo(Board& at, const Vec3& place, const BoardFaults& faults = {}) {
    BoardOptions options;
    options.faults = faults;
    at.board = std::make_unique<SimulatedBoard>(clock_, at.lift, options);
    // As if it looked all the time.
    at.guardian.look(clock_->now() + kPatience);
    ServoOptions of_servo;
    of_servo.release_after = kPatience;
    of_servo.stop_timeout = 500ms;
    auto servo = std::make_unique<Servo>(
        std::make_unique<test::GuardedTransport>(*at.board, &at.guardian),
        make_profile(ProfileKind::palpate_report, at.board->feature()), clock_, of_servo);
    ServoSettings settings;
    settings.workspace_centre = place;
    settings.grasp_button = 0;
    settings.force_limit = kLimit;
    servo->set_settings(settings);
    return servo;
  }

  /// The hands take hold of their tools, and the first one lifts its own.
  void touch(std::size_t num_hands, const BoardFaults& faults_of_second = {}) {
    std::vector<std::unique_ptr<Servo>> servos;
    for (std::size_t hand = 0; hand < num_hands; ++hand) {
      servos.push_back(make_servo(boards_[hand], test::block_model().places[hand],
                                  hand == 1 ? faults_of_second : BoardFaults()));
    }
    touch_ = std::make_unique<ReducedTouch>(make_body(), std::move(servos));
    touch_->start();
  }
  [[nodiscard]] bool all_are(ContactStatus status) {
    return wait_until([&] {
      for (Index tool = 0; tool < touch_->body().num_tools(); ++tool) {
        Servo* servo = touch_->servo(tool);
        if (servo != nullptr && servo->latest().contact.status != status) return false;
      }
      return true;
    });
  }
  [[nodiscard]] bool grasp_and_pull() {
    if (!all_are(ContactStatus::free)) return false;
    for (Board& board : boards_) board.lift->grasps = true;
    if (!all_are(ContactStatus::attached)) return false;
    for (Board& board : boards_) board.lift->height = 0.012;
    return true;
  }
  /// Of the motors, N.
  [[nodiscard]] double force(std::size_t hand) {
    const BoardStatus status = boards_[hand].board->status();
    return status.motors_on ? status.force.norm() : 0;
  }

  std::shared_ptr<Clock> clock_ = std::make_shared<MonotonicClock>();
  Board boards_[2];
  // After the boards: it writes to them when it ends.
  std::unique_ptr<ReducedTouch> touch_;
};

TEST_F(ReducedTouchTest, ADeviceThatIsUnpluggedIsNamedAndTheOtherEndsWithZero) {
  touch(2);
  ASSERT_TRUE(grasp_and_pull());
  ASSERT_TRUE(wait_until([&] { return force(0) > 0.3 && force(1) > 0.3; }));
  EXPECT_TRUE(touch_->lost().empty());
  boards_[1].board->unplug();
  EXPECT_TRUE(wait_until([&] { return touch_->lost() == std::vector<Index>{1}; }));
  EXPECT_TRUE(wait_until([&] { return force(0) > 0.3; })) << "it goes on";
  EXPECT_TRUE(touch_->stop().empty());
  EXPECT_FALSE(boards_[0].board->status().motors_on);
  EXPECT_TRUE(boards_[0].guardian.resting());
}

TEST_F(ReducedTouchTest, EveryDeviceIsGuardedAndLimited) {
  touch(2);
  ASSERT_TRUE(grasp_and_pull());
  ASSERT_TRUE(wait_until([&] { return force(0) > 0.3 && force(1) > 0.3; }));
  for (Index tool : {0, 1}) {
    EXPECT_FALSE(boards_[tool].guardian.resting());
    EXPECT_TRUE(
        wait_until([&] { return touch_->servo(tool)->statistics().magnitude_limited > 0; }));
  }
  boards_[1].guardian.trip();
  EXPECT_TRUE(wait_until([&] { return force(1) == 0 && !boards_[1].guardian.tripped(); }));
  EXPECT_TRUE(wait_until([&] { return force(0) > 0.3; })) << "it goes on";
  boards_[0].guardian.trip();
  EXPECT_TRUE(wait_until([&] { return force(0) == 0 && !boards_[0].guardian.tripped(); }));
  EXPECT_TRUE(touch_->stop().empty());
  for (Index tool : {0, 1}) {
    const Statistics statistics = touch_->servo(tool)->statistics();
    EXPECT_EQ(statistics.trips_by_guardian, 1U);
    EXPECT_LE(statistics.largest_force, kLimit + 1e-9);
  }
}

TEST_F(ReducedTouchTest, ADriverThatHangsIsNamedAndHoldsUpNoOther) {
  BoardFaults faults;
  faults.blocking_writes.from = 0ms;
  touch(2, faults);
  ASSERT_TRUE(wait_until([&] { return touch_->servo(0)->latest().number > 10; }));
  EXPECT_EQ(touch_->stop(), std::vector<Index>{1});
  EXPECT_FALSE(boards_[0].board->status().motors_on);
  boards_[1].board->release_writes();
  // The loop lets go of the board before the board ends.
  EXPECT_TRUE(wait_until([&] { return touch_->servo(1)->latest().state == ServoState::closed; }));
}

TEST_F(ReducedTouchTest, AToolWithoutADeviceMovesWithTheBody) {
  touch(1);
  ASSERT_TRUE(grasp_and_pull());
  EXPECT_EQ(touch_->servo(1), nullptr);
  // Of the second tool, which the first one drags along.
  EXPECT_TRUE(wait_until([&] { return touch_->body().latest().coordinates.tail<3>()[2] > 0.001; }));
  EXPECT_TRUE(touch_->lost().empty());
}

TEST_F(ReducedTouchTest, TheBodyHasSteppedBeforeAHandFeelsIt) {
  touch(2);
  ASSERT_TRUE(all_are(ContactStatus::free));
  touch_->stop();
  for (Index tool : {0, 1}) EXPECT_EQ(touch_->servo(tool)->statistics().trips_by_body, 0U);
}

TEST_F(ReducedTouchTest, SaysWhatIsWrongWithItsInput) {
  std::vector<std::unique_ptr<Servo>> servos(3);
  EXPECT_THROW(ReducedTouch(make_body(), std::move(servos)), InputError);
  touch(2);
  EXPECT_THROW(touch_->start(), BackendError);
  EXPECT_EQ(touch_->lost(), (std::vector<Index>{0, 1})) << "all are stopped";
}

}  // namespace
}  // namespace palpate::test::test_reduced_touch
