// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/transport/simulated_board.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "base/error.h"
#include "haptic/profile/reports.h"

namespace palpate::test::test_simulated_board {
namespace {

using palpate_report::Input;
using palpate_report::Output;
using std::chrono::microseconds;
using std::chrono::milliseconds;
using Span = BoardFaults::Span;

/// Along x with 1 m/s from the time it is switched on.
std::shared_ptr<Motion> steadily() {
  return std::make_shared<ScriptedMotion>([](Time time) {
    Motion::Pose pose;
    pose.position[0] = seconds(time);
    return pose;
  });
}

struct Board {
  explicit Board(const BoardOptions& options = {}, std::shared_ptr<Motion> motion = steadily())
      : board(clock, std::move(motion), options) {}

  std::shared_ptr<VirtualClock> clock = std::make_shared<VirtualClock>();
  SimulatedBoard board;
  Report report;

  TransportStatus read(Duration timeout = Duration(0)) { return board.read(report, timeout); }
  /// The next report, which must be there in time.
  Input input(Duration timeout = Duration(0)) {
    Input in;
    EXPECT_EQ(read(timeout), TransportStatus::data);
    EXPECT_TRUE(palpate_report::decode_input(report, in));
    return in;
  }
  TransportStatus push(std::int16_t x, std::uint8_t command = palpate_report::kForce) {
    Output out;
    out.counter = 77;
    out.force = {x, 0, static_cast<std::int16_t>(-x)};
    out.command = command;
    return board.write(palpate_report::encode_output(out));
  }
  double force() { return board.status().force[0]; }
};

BoardOptions with(const BoardFaults& faults) {
  BoardOptions options;
  options.faults = faults;
  return options;
}

TEST(SimulatedBoard, ReportsAThousandTimesASecond) {
  Board b;
  for (int i = 0; i < 100; ++i) {
    const Input in = b.input(milliseconds(5));
    EXPECT_EQ(b.clock->now(), milliseconds(i)) << "it is waited for, and no longer";
    EXPECT_EQ(in.time_us, 1000U * static_cast<unsigned>(i));
    EXPECT_EQ(in.counter, i);
    EXPECT_EQ(in.position, (std::array<std::int32_t, 3>{100 * i, 0, 0})) << "in steps of 10 µm";
  }
  EXPECT_EQ(b.read(), TransportStatus::nothing);
  EXPECT_EQ(b.read(microseconds(300)), TransportStatus::nothing);
  EXPECT_EQ(b.clock->now(), microseconds(99300));
}

TEST(SimulatedBoard, TellsItsPose) {
  BoardOptions options;
  options.feature.flags |= palpate_report::kSensesRotation;
  Motion::Pose pose;
  pose.position = {0.0100049, -0.0100051, 0};
  pose.rotation = Eigen::AngleAxisd(1, Vec3(1, 2, 3).normalized());
  pose.buttons = 1;
  Board b(options, std::make_shared<ScriptedMotion>([&](Time) { return pose; }));
  const auto profile = make_profile(ProfileKind::palpate_report, b.board.feature());
  DeviceState state;
  ASSERT_EQ(b.read(), TransportStatus::data);
  ASSERT_TRUE(profile->decode(b.report, state));
  EXPECT_TRUE(state.position.isApprox(Vec3(0.01, -0.01001, 0), 1e-12)) << "to the next count";
  EXPECT_LT(state.rotation.angularDistance(pose.rotation), 1e-4) << "of 16 bits";
  EXPECT_EQ(state.buttons, 1U);
}

TEST(SimulatedBoard, DefaultsAreThoseOfADeviceOnADesk) {
  const Specification s =
      make_profile(ProfileKind::palpate_report, Board().board.feature())->specification();
  EXPECT_DOUBLE_EQ(s.max_linear_force, 7.9);
  EXPECT_DOUBLE_EQ(s.max_linear_stiffness, 3000);
  EXPECT_DOUBLE_EQ(s.workspace_radius, 0.08);
  EXPECT_DOUBLE_EQ(s.position_resolution, 1e-5);
  EXPECT_DOUBLE_EQ(s.force_resolution, 1e-3);
}

TEST(SimulatedBoard, TheOldestUnreadReportsAreKept) {
  Board b;
  b.clock->advance(milliseconds(100));
  for (int i = 0; i < 63; ++i) EXPECT_EQ(b.input().counter, i);
  EXPECT_EQ(b.read(), TransportStatus::nothing) << "there were 101";
  EXPECT_EQ(b.board.status().reports, 101U);
  EXPECT_EQ(b.board.status().lost, 38U);
  EXPECT_EQ(b.input(milliseconds(1)).counter, 101);
}

TEST(SimulatedBoard, ClockAndCounterWrapAndDrift) {
  BoardOptions options;
  options.first_time_us = 0xFFFFFFFF;
  options.first_counter = 0xFFFF;
  options.clock_drift = 1e-3;
  Board b(options);
  EXPECT_EQ(b.input().time_us, 0xFFFFFFFFU);
  const Input in = b.input(milliseconds(1));
  EXPECT_EQ(in.time_us, 1000U) << "−1 + 1001";
  EXPECT_EQ(in.counter, 0);
}

TEST(SimulatedBoard, MotorsFollowTheForce) {
  Board b;
  EXPECT_FALSE(b.board.status().motors_on);
  EXPECT_EQ(b.push(1500), TransportStatus::data);
  EXPECT_EQ(b.board.status().force, Vec3(1.5, 0, -1.5));
  EXPECT_TRUE(b.board.status().motors_on);
  EXPECT_EQ(b.board.status().last_output.counter, 77);
  EXPECT_EQ(b.push(1500, palpate_report::kMotorsOff), TransportStatus::data);
  EXPECT_EQ(b.board.status().force, Vec3::Zero());
  EXPECT_FALSE(b.board.status().motors_on);
  EXPECT_EQ(b.board.status().outputs, 2U);
  EXPECT_EQ(b.board.write(test::report({3, 1, 2})), TransportStatus::data) << "for the host it is";
  EXPECT_EQ(b.board.status().bad_outputs, 1U);
  EXPECT_EQ(b.board.status().outputs, 2U);
}

TEST(SimulatedBoard, WatchdogCutsTheMotors) {
  Board b;
  (void)b.push(1000);
  b.clock->advance(milliseconds(40));
  (void)b.push(1000);
  b.clock->advance(milliseconds(50) - Duration(1));
  EXPECT_EQ(b.force(), 1);
  EXPECT_EQ(b.board.status().cuts, 0U);
  b.clock->advance(Duration(1));
  EXPECT_EQ(b.force(), 0);
  EXPECT_FALSE(b.board.status().motors_on);
  EXPECT_EQ(b.board.status().cuts, 1U);
  while (b.read() == TransportStatus::data) {
  }
  EXPECT_EQ(b.input(milliseconds(1)).status, palpate_report::kWatchdogCut);
  (void)b.push(1000);
  EXPECT_EQ(b.input(milliseconds(1)).status, palpate_report::kMotorsOn);
  EXPECT_EQ(b.force(), 1) << "and on again";
}

/// Adds up what the motors do.
struct Impulse final : Motion {
  Pose advance(Time time, const Vec3& force) noexcept override {
    EXPECT_GE(time, last);
    sum += seconds(time - last) * force;
    last = time;
    return {};
  }
  Vec3 sum = Vec3::Zero();
  Time last{0};
};

TEST(SimulatedBoard, AForceHoldsUntilTheNextOne) {
  const auto motion = std::make_shared<Impulse>();
  BoardOptions options;
  options.force_delay = microseconds(700);
  Board b(options, motion);
  b.clock->advance(microseconds(2500));
  (void)b.push(2000);
  b.clock->advance(microseconds(600));
  EXPECT_EQ(b.force(), 0) << "on its way";
  b.clock->advance(microseconds(900));  // 4 ms: it is there since 3.2 ms
  (void)b.push(3000);
  b.clock->advance(milliseconds(6));  // 10 ms: the second since 4.7 ms
  (void)b.board.status();
  EXPECT_NEAR(motion->sum[0], 2 * 1.5e-3 + 3 * 5.3e-3, 1e-12);
  b.clock->advance(milliseconds(100));
  (void)b.board.status();
  EXPECT_NEAR(motion->sum[0], 2 * 1.5e-3 + 3 * 50e-3, 1e-12) << "and is cut in the end";
}

TEST(SimulatedBoard, ReportsMayBeOnTheirWay) {
  BoardOptions options;
  options.report_delay = microseconds(2300);
  Board b(options);
  b.clock->advance(microseconds(2299));
  EXPECT_EQ(b.read(), TransportStatus::nothing);
  EXPECT_EQ(b.input(milliseconds(1)).time_us, 0U);
  EXPECT_EQ(b.clock->now(), microseconds(2300));
  EXPECT_EQ(b.input(milliseconds(1)).time_us, 1000U);
  EXPECT_EQ(b.clock->now(), microseconds(3300));
}

TEST(SimulatedBoard, InLockStepEachReportAnswersAWrite) {
  BoardOptions options;
  options.feature.flags |= palpate_report::kLockStep;
  Board b(options);
  EXPECT_EQ(b.input().counter, 0) << "the first comes by itself";
  EXPECT_EQ(b.read(milliseconds(20)), TransportStatus::nothing);
  (void)b.push(0);
  EXPECT_EQ(b.input().counter, 1);
  (void)b.push(0);
  EXPECT_EQ(b.read(), TransportStatus::nothing) << "one in a frame of the bus";
  EXPECT_EQ(b.input(milliseconds(1)).counter, 2);
  EXPECT_EQ(b.clock->now(), milliseconds(21));
}

TEST(SimulatedBoard, InLockStepALostFirstReportIsTheEndUntilAWrite) {
  BoardOptions options;
  options.feature.flags |= palpate_report::kLockStep;
  options.faults.first_report_lost = true;
  Board b(options);
  EXPECT_EQ(b.read(milliseconds(500)), TransportStatus::nothing);
  (void)b.push(0);
  EXPECT_EQ(b.input().counter, 1);
}

TEST(SimulatedBoard, Silence) {
  BoardFaults faults;
  faults.silent = {milliseconds(2), milliseconds(10)};
  Board b(with(faults));
  EXPECT_EQ(b.input().counter, 0);
  EXPECT_EQ(b.input(milliseconds(1)).counter, 1);
  EXPECT_EQ(b.read(milliseconds(8)), TransportStatus::nothing);
  EXPECT_EQ(b.clock->now(), milliseconds(9));
  EXPECT_EQ(b.input(milliseconds(1)).counter, 10);
}

TEST(SimulatedBoard, ShortAndDuplicateReports) {
  BoardFaults faults;
  faults.short_reports = {milliseconds(1), milliseconds(2)};
  faults.duplicates = {milliseconds(2), milliseconds(3)};
  Board b(with(faults));
  EXPECT_EQ(b.input().counter, 0);
  EXPECT_EQ(b.read(milliseconds(1)), TransportStatus::data);
  EXPECT_EQ(b.report.size, palpate_report::kInputSize - 1);
  EXPECT_EQ(b.input(milliseconds(1)).counter, 2);
  EXPECT_EQ(b.input().counter, 2);
  EXPECT_EQ(b.read(), TransportStatus::nothing);
}

TEST(SimulatedBoard, EmptyPacketsHideTheReportBehind) {
  BoardFaults faults;
  faults.empty_packets = {Time(0), milliseconds(1)};
  Board b(with(faults));
  EXPECT_EQ(b.read(milliseconds(1)), TransportStatus::nothing);
  EXPECT_EQ(b.clock->now(), Time(0));
  EXPECT_EQ(b.input().counter, 0);
}

TEST(SimulatedBoard, UnpluggedItIsGoneWithItsForce) {
  BoardFaults faults;
  faults.unplugged = milliseconds(3);
  Board b(with(faults));
  (void)b.push(1000);
  b.clock->advance(milliseconds(2));
  EXPECT_EQ(b.force(), 1);
  for (int i = 0; i < 3; ++i) (void)b.input();
  EXPECT_EQ(b.read(milliseconds(5)), TransportStatus::gone);
  EXPECT_EQ(b.clock->now(), milliseconds(3)) << "it is told when it happens";
  EXPECT_EQ(b.push(1000), TransportStatus::gone);
  EXPECT_EQ(b.force(), 0);
  EXPECT_FALSE(b.board.problem().empty());

  Board pulled;
  pulled.clock->advance(milliseconds(3));
  pulled.board.unplug();
  EXPECT_EQ(pulled.read(), TransportStatus::gone) << "though reports were unread";
}

TEST(SimulatedBoard, WritesThatFail) {
  BoardFaults faults;
  faults.failing_writes = {milliseconds(1), milliseconds(2)};
  Board b(with(faults));
  (void)b.push(1000);
  b.clock->advance(milliseconds(1));
  EXPECT_EQ(b.push(2000), TransportStatus::error);
  EXPECT_EQ(b.force(), 1);
  b.clock->advance(milliseconds(1));
  EXPECT_EQ(b.push(2000), TransportStatus::data);
  EXPECT_EQ(b.force(), 2);
}

TEST(SimulatedBoard, WritesThatBlockForATime) {
  BoardFaults faults;
  faults.blocking_writes = {milliseconds(1), milliseconds(200)};
  Board b(with(faults));
  (void)b.push(1000);
  EXPECT_EQ(b.clock->now(), Time(0));
  b.clock->advance(milliseconds(1));
  EXPECT_EQ(b.push(2000), TransportStatus::error);
  EXPECT_EQ(b.clock->now(), milliseconds(200));
  EXPECT_EQ(b.board.status().cuts, 1U) << "the watchdog did what it is for";
  EXPECT_EQ(b.push(2000), TransportStatus::data);
}

TEST(SimulatedBoard, WritesThatBlockUntilTheyAreReleased) {
  for (const bool by_unplug : {false, true}) {
    BoardFaults faults;
    faults.blocking_writes.from = Time(0);
    Board b(with(faults));
    std::atomic<bool> began{false};
    std::atomic<bool> returned{false};
    std::atomic<int> status{-1};
    std::thread writer([&] {
      began = true;
      status = static_cast<int>(b.push(1000));
      returned = true;
    });
    while (!began) std::this_thread::yield();
    std::this_thread::sleep_for(milliseconds(50));
    EXPECT_FALSE(returned);
    if (by_unplug) {
      b.board.unplug();
    } else {
      b.board.release_writes();
    }
    writer.join();
    const auto expected = by_unplug ? TransportStatus::gone : TransportStatus::error;
    EXPECT_EQ(status, static_cast<int>(expected));
    EXPECT_EQ(b.force(), 0);
    EXPECT_EQ(b.push(1000), by_unplug ? TransportStatus::gone : TransportStatus::data);
  }
}

TEST(SimulatedBoard, KeepsRealTimeToo) {
  const auto clock = std::make_shared<MonotonicClock>();
  SimulatedBoard board(clock, steadily());
  const Time begin = clock->now();
  Report report;
  for (int i = 0; i < 20; ++i) {
    ASSERT_EQ(board.read(report, std::chrono::seconds(10)), TransportStatus::data);
  }
  EXPECT_GE(clock->now() - begin, microseconds(18500));
}

TEST(SimulatedBoard, RefusesOptionsThatCannotBe) {
  const auto refuses = [](const BoardOptions& options) {
    EXPECT_THROW(Board{options}, InputError);
  };
  BoardOptions options;
  options.report_delay = milliseconds(32);
  refuses(options);
  options = {};
  options.force_delay = Duration(-1);
  refuses(options);
  options = {};
  options.feature.watchdog_ms = 0;
  refuses(options);
}

TEST(SimulatedBoard, LongDelaysFitOnTheWay) {
  BoardOptions options;
  options.report_delay = options.force_delay = milliseconds(31);
  options.faults.duplicates = {Time(0), BoardFaults::kNever};
  Board b(options);
  for (int i = 0; i < 200; ++i) {
    (void)b.push(1);
    while (b.read() == TransportStatus::data) {
    }
    b.clock->advance(milliseconds(1));
  }
  EXPECT_EQ(b.board.status().lost, 0U);
  EXPECT_EQ(b.board.status().bad_outputs, 0U);
}

}  // namespace
}  // namespace palpate::test::test_simulated_board
