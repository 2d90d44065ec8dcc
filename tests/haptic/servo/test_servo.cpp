// SPDX-License-Identifier: BSD-3-Clause
// The thread, by the real clock. How fast this machine is decides nothing here.
#include <gtest/gtest.h>
#include <pthread.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <future>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "base/error.h"
#include "haptic/servo/servo.h"
#include "haptic/support/analytic_body.h"
#include "haptic/support/locked_memory.h"
#include "haptic/touching/body_touch.h"
#include "haptic/transport/simulated_board.h"

namespace palpate::test::test_servo {
namespace {

using namespace std::chrono_literals;

/// At the least.
constexpr std::size_t kOwnStack = 256 << 10;

const Vec3 kMiddle(test::kBox[0] / 2, test::kBox[1] / 2, test::kBox[2]);

/// Above the box until it is told to go down, and then 4 mm deep in a tenth of a second.
class Descent final : public Motion {
 public:
  Pose advance(Time time, const Vec3& /*force*/) noexcept override {
    if (!down) {
      begun_ = time;
    }
    const double part = std::min(seconds(time - begun_) / 0.1, 1.0);
    Pose pose;
    pose.position = Vec3(0, 0, 0.005 - 0.009 * part);
    return pose;
  }

  std::atomic<bool> down{false};

 private:
  Time begun_{0};
};

/// A board whose writes hang when they are told to, and which others can wait for.
class Watched final : public Transport {
 public:
  explicit Watched(std::unique_ptr<Transport> inner) : inner_(std::move(inner)) {}
  TransportStatus read(Report& report, Duration timeout) noexcept override {
    return inner_->read(report, timeout);
  }
  TransportStatus write(const Report& report) noexcept override {
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [&] { return !hangs_; });
    }
    const TransportStatus status = inner_->write(report);
    const std::lock_guard lock(mutex_);
    ++writes_;
    changed_.notify_all();
    return status;
  }
  std::string problem() const override { return inner_->problem(); }

  void hang(bool hangs) {
    const std::lock_guard lock(mutex_);
    hangs_ = hangs;
    // With the lock: whoever hangs may end this when he goes on.
    changed_.notify_all();
  }

  /// Looks after each write, and now and then in between.
  /// @return false: it is not so within a long time.
  template <class Condition>
  [[nodiscard]] bool wait_until(Condition is_so) {
    const auto deadline = std::chrono::steady_clock::now() + 60s;
    std::unique_lock lock(mutex_);
    while (!is_so()) {
      if (std::chrono::steady_clock::now() > deadline) return false;
      changed_.wait_for(lock, 1ms);
    }
    return true;
  }
  /// @return false: there were not as many within a long time.
  [[nodiscard]] bool wait_for_writes(int number) {
    int until = -1;
    return wait_until([&] {
      if (until < 0) until = writes_ + number;
      return writes_ >= until;
    });
  }
  /// Is ready when this no longer lives.
  [[nodiscard]] std::future<void> end() { return end_.get_future(); }

 private:
  std::unique_ptr<Transport> inner_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool hangs_ = false;
  int writes_ = 0;
  std::promise<void> end_;
};

/// Made once: that takes longer than a test.
const std::shared_ptr<const Touchable>& box() {
  static const std::shared_ptr<const Touchable> box = test::box_body();
  return box;
}

/// A servo that presses the box, and what it owns.
struct Pressing {
  explicit Pressing(const ServoOptions& options = patient()) {
    auto clock = std::make_shared<MonotonicClock>();
    auto simulated = std::make_unique<SimulatedBoard>(clock, motion);
    board = simulated.get();
    auto watched = std::make_unique<Watched>(std::move(simulated));
    transport = watched.get();
    servo = std::make_unique<Servo>(std::move(watched),
                                    make_profile(ProfileKind::palpate_report, board->feature()),
                                    clock, options);
    ServoSettings settings;
    settings.workspace_centre = kMiddle;
    servo->set_settings(settings);
    servo->set_touch(make_touch(body));
  }

  /// A machine that is busy with other tests may take its time.
  static ServoOptions patient() {
    ServoOptions options;
    options.stop_timeout = 60s;
    options.release_after = 60s;
    return options;
  }

  /// Presses until the motors have that much force, N; false: not within a long time.
  bool wait_for_force(double force) {
    return transport->wait_until([&] {
      if (servo->latest().contact.status == ContactStatus::free) motion->down = true;
      return board->status().force.norm() > force;
    });
  }

  std::shared_ptr<const Touchable> body = box();
  std::shared_ptr<Descent> motion = std::make_shared<Descent>();
  SimulatedBoard* board = nullptr;
  Watched* transport = nullptr;
  std::unique_ptr<Servo> servo;
};

TEST(Servo, RunsAndStops) {
  Pressing pressing;
  EXPECT_EQ(pressing.servo->latest().state, ServoState::closed);
  pressing.servo->start();
  ASSERT_TRUE(pressing.wait_for_force(0.5));
  EXPECT_GT(pressing.servo->latest().force[2], 0.4);
  EXPECT_TRUE(pressing.servo->stop());
  EXPECT_EQ(pressing.servo->latest().state, ServoState::closed);
  EXPECT_FALSE(pressing.board->status().motors_on);
  EXPECT_EQ(pressing.board->status().last_output.command, palpate_report::kMotorsOff);
  const Statistics statistics = pressing.servo->statistics();
  EXPECT_GT(statistics.ticks, 2U);
  EXPECT_GT(statistics.touching_ticks, 1U);
  EXPECT_GT(statistics.mean_force(), 0);
  EXPECT_GE(statistics.lateness.largest, statistics.lateness.median);
  EXPECT_GT(statistics.own_time.median.count(), 0);
  EXPECT_LE(statistics.own_time.median, statistics.tick_time.median);
  EXPECT_TRUE(pressing.servo->stop()) << "again";
  EXPECT_THROW(pressing.servo->start(), BackendError);
}

TEST(Servo, AHundredTimes) {
  for (int i = 0; i < 100; ++i) {
    Pressing pressing;
    pressing.servo->start();
    if (i % 3 == 0) {
      ASSERT_TRUE(pressing.transport->wait_for_writes(2));
    }
    if (i % 2 == 0) {
      EXPECT_TRUE(pressing.servo->stop());
      EXPECT_FALSE(pressing.board->status().motors_on);
    }
  }
}

TEST(Servo, NeverStarted) {
  Pressing pressing;
  EXPECT_TRUE(pressing.servo->stop());
}

TEST(Servo, LetsGoWhenAnotherThreadSaysSo) {
  Pressing pressing;
  pressing.servo->start();
  ASSERT_TRUE(pressing.wait_for_force(0.5));
  std::thread([&] { pressing.servo->let_go(); }).join();
  EXPECT_TRUE(pressing.transport->wait_until(
      [&] { return pressing.servo->latest().state == ServoState::closed; }));
  EXPECT_FALSE(pressing.board->status().motors_on);
  EXPECT_TRUE(pressing.servo->stop());
}

TEST(Servo, StopsInTimeThoughAWriteHangs) {
  ServoOptions options = Pressing::patient();
  options.stop_timeout = 50ms;
  auto pressing = std::make_unique<Pressing>(options);
  pressing->servo->start();
  ASSERT_TRUE(pressing->wait_for_force(0.5));
  std::future<void> end = pressing->transport->end();
  pressing->transport->hang(true);
  // The loop hangs; whoever looks sees it, and the board's watchdog cuts the motors.
  EXPECT_TRUE(pressing->transport->wait_until(
      [&] { return pressing->servo->latest().state == ServoState::stale; }));
  EXPECT_TRUE(
      pressing->transport->wait_until([&] { return !pressing->board->status().motors_on; }));
  EXPECT_GE(pressing->board->status().cuts, 1U);
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_FALSE(pressing->servo->stop());
  EXPECT_LT(std::chrono::steady_clock::now() - begin, 20s);
  // The thread lets go of the board only when the driver lets go of the thread.
  Watched* const transport = pressing->transport;
  pressing.reset();
  EXPECT_EQ(end.wait_for(0s), std::future_status::timeout);
  transport->hang(false);
  EXPECT_EQ(end.wait_for(60s), std::future_status::ready);
}

TEST(Servo, UnpluggedWhileRunning) {
  Pressing pressing;
  pressing.servo->start();
  ASSERT_TRUE(pressing.wait_for_force(0.5));
  pressing.board->unplug();
  EXPECT_TRUE(pressing.transport->wait_until(
      [&] { return pressing.servo->latest().state == ServoState::gone; }));
  EXPECT_FALSE(pressing.servo->problem().empty()) << "while it runs";
  EXPECT_TRUE(pressing.servo->stop());
}

TEST(Servo, ChangedFromOutsideWhileItRuns) {
  Pressing pressing;
  pressing.servo->start();
  ASSERT_TRUE(pressing.wait_for_force(0.5));
  // One that the loop has done with is destroyed meanwhile.
  const TouchSpace space = test::box_space([](int) { return test::stiffening_spring(100); }, {}, 2);
  TouchableOptions options;
  options.method = Method::linear;
  ServoSettings settings;
  settings.workspace_centre = kMiddle;
  for (int i = 0; i < 300; ++i) {
    for (int offers = 0; offers <= i % 2; ++offers) {
      pressing.servo->set_touch(make_touch(std::make_shared<const Touchable>(space, options)));
    }
    settings.force_limit = 1 + 0.01 * (i % 100);
    pressing.servo->set_settings(settings);
    TouchSettings touch;
    touch.coupling_stiffness = 100 * (i % 3);
    pressing.servo->set_touch_settings(touch);
    pressing.servo->set_recording(i % 5 ? std::make_shared<TickRing>(64) : nullptr);
    const Tick tick = pressing.servo->latest();
    EXPECT_TRUE(tick.force.allFinite());
    EXPECT_LE(tick.force.norm(), 2);
    ASSERT_TRUE(pressing.transport->wait_for_writes(1));
  }
  EXPECT_TRUE(pressing.servo->stop());
  EXPECT_FALSE(pressing.board->status().motors_on);
  settings.workspace_scale = -1;
  EXPECT_THROW(pressing.servo->set_settings(settings), InputError);
}

std::atomic<bool> handled{false};
void handle(int) { handled = true; }

// A signal whose handler ran in the loop would delay it: with this thread not taking it there is
// none that does.
TEST(Servo, SignalsGoElsewhere) {
  struct sigaction action {};
  action.sa_handler = handle;
  struct sigaction before {};
  sigaction(SIGUSR1, &action, &before);
  Pressing pressing;
  pressing.servo->start();
  ASSERT_TRUE(pressing.wait_for_force(0.5));
  sigset_t usr1;
  sigemptyset(&usr1);
  sigaddset(&usr1, SIGUSR1);
  pthread_sigmask(SIG_BLOCK, &usr1, nullptr);
  kill(getpid(), SIGUSR1);
  ASSERT_TRUE(pressing.transport->wait_for_writes(20));
  EXPECT_FALSE(handled);
  sigset_t pending;
  sigpending(&pending);
  EXPECT_TRUE(sigismember(&pending, SIGUSR1)) << "it waits for a thread that takes it";
  pthread_sigmask(SIG_UNBLOCK, &usr1, nullptr);
  EXPECT_TRUE(pressing.transport->wait_until([] { return handled.load(); }));
  EXPECT_TRUE(pressing.servo->stop());
  sigaction(SIGUSR1, &before, nullptr);
}

#ifdef PALPATE_LOCKS_MEMORY
// As a program that shows data has them.
TEST(Servo, LocksItsOwnMemoryAndNotThatOfTheProgram) {
  // Where that is permitted the limit is none.
  const rlimit none{RLIM_INFINITY, RLIM_INFINITY};
  (void)setrlimit(RLIMIT_MEMLOCK, &none);
  const std::vector<char> data(std::size_t{256} << 20, 1);
  const std::size_t before = test::locked_memory();
  {
    Pressing pressing;
    pressing.servo->start();
    ASSERT_TRUE(pressing.wait_for_force(0.5));
    const std::size_t locked = test::locked_memory() - before;
    EXPECT_TRUE(pressing.servo->statistics().memory_locked);
    EXPECT_GT(locked, pressing.body->bytes() + kOwnStack);
    EXPECT_LT(locked, pressing.body->bytes() + (std::size_t{4} << 20));
    // Another body takes its place.
    pressing.servo->set_touch(make_touch(test::box_body()));
    ASSERT_TRUE(pressing.transport->wait_for_writes(3));
    EXPECT_TRUE(pressing.servo->stop());
  }
  EXPECT_EQ(test::locked_memory(), before);
  EXPECT_EQ(data.back(), 1);
}
#endif

TEST(Servo, BadOptions) {
  ServoOptions options;
  options.period = 0ms;
  EXPECT_THROW(Pressing{options}, InputError);
}

}  // namespace
}  // namespace palpate::test::test_servo
