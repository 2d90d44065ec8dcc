// SPDX-License-Identifier: BSD-3-Clause
// The loop by a virtual clock, with each fault that a device has. What the board's motors do is
// what counts.
#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "base/error.h"
#include "haptic/servo/rig.h"
#include "haptic/support/pressed_body.h"
#include "haptic/touching/body_touch.h"

namespace palpate::test::test_loop {
namespace {

using namespace std::chrono_literals;
using test::Rig;

/// Of the board's force, and of the interpolation of a smooth spring.
constexpr double kForceUnit = 1e-3;
constexpr double kInterpolation = 1e-3;

/// What a hand at a place of the device feels of the box that is pressed at its middle.
Vec3 exact_force(const Vec3& device) { return -test::stiffening_spring(200)(device).force; }

TEST(Loop, EachForceIsThatOfTheNewestReport) {
  Rig rig(test::pressing());
  ServoSettings settings;
  settings.passivity_control = false;
  rig.set(settings);
  int touching = 0;
  for (int i = 0; i < 3000; ++i, rig.loop->wait()) {
    const Tick& tick = rig.tick();
    const BoardStatus board = rig.board.status();
    ASSERT_EQ(board.outputs, static_cast<std::uint64_t>(i + 1)) << "one force each tick";
    if (i < 2) continue;
    ASSERT_EQ(tick.state, ServoState::running);
    ASSERT_EQ(board.last_output.counter, static_cast<std::uint16_t>(tick.device.counter));
    ASSERT_EQ(board.reports, tick.device.counter + 1U) << "the newest";
    if (tick.contact.status != ContactStatus::attached) {
      ASSERT_EQ(tick.force, Vec3::Zero());
      continue;
    }
    ++touching;
    const Vec3 exact = exact_force(tick.position - tick.contact.anchor);
    if (tick.limited == 0) {
      ASSERT_LT((tick.force - exact).norm(), kInterpolation * exact.norm() + 1e-9);
      ASSERT_LT((board.force - tick.force).norm(), 2 * kForceUnit);
    }
  }
  EXPECT_GT(touching, 1500);
  const Counters counters = rig.counters();
  EXPECT_EQ(counters.lost_reports, 0U);
  EXPECT_EQ(counters.bad_reports, 0U);
  EXPECT_EQ(counters.missed, 0U);
  EXPECT_EQ(counters.magnitude_limited, 0U);
}

TEST(Loop, TheHandIsPushedBack) {
  Rig rig(test::holding());
  rig.run(400ms);
  EXPECT_GT(rig.motors()[2], 0.5);
  EXPECT_LT(rig.motors()[0], 0);
  EXPECT_LT(rig.motors()[1], 0);
}

TEST(Loop, KeepsItsRate) {
  Rig rig(test::pressing());
  rig.step();
  const Time begin = rig.loop->last().time;
  for (int i = 0; i < 10000; ++i) {
    rig.tick();
    rig.clock->advance(Duration((i * 7919) % 900'000));  // what a tick takes differs
    rig.loop->wait();
  }
  rig.tick();
  EXPECT_EQ(rig.loop->last().time - begin, 10001 * 1ms);
  EXPECT_EQ(rig.counters().missed, 0U);
}

// With real-time priority nothing else would run on its processor.
TEST(Loop, TicksThatTakeLongerThanThePeriodLeaveTimeToOthers) {
  Rig rig(test::pressing());
  for (int i = 0; i < 100; ++i) {
    rig.tick();
    rig.clock->advance(3ms);
    const Time before = rig.clock->now();
    rig.loop->wait();
    ASSERT_GE(rig.clock->now() - before, 100us);
  }
  EXPECT_GT(rig.counters().missed, 100U);
}

TEST(Loop, DoesNotCatchUpAfterAnOverrun) {
  Rig rig(test::pressing());
  rig.run(50ms);
  rig.clock->advance(20500us);
  const Time begin = rig.clock->now();
  rig.step();
  // The late tick at once, the next ones in the new rhythm.
  for (int i = 1; i <= 20; ++i) {
    rig.tick();
    EXPECT_EQ(rig.loop->last().time - begin, i * 1ms);
    rig.loop->wait();
  }
  EXPECT_EQ(rig.counters().missed, 20U);
}

// hidraw keeps the oldest reports: what is read last after a pause is old.
TEST(Loop, NoForceFromStaleReportsAfterAPauseOfTheHost) {
  Rig rig(test::pressing());
  rig.run(450ms);
  ASSERT_GT(rig.motors().norm(), 0.5);
  rig.clock->advance(200ms);
  Tick tick = rig.tick();
  EXPECT_GT(tick.num_reports, 60);
  EXPECT_EQ(tick.state, ServoState::stale);
  EXPECT_GT(tick.age, 100ms);
  EXPECT_EQ(tick.force, Vec3::Zero());
  EXPECT_EQ(rig.motors(), Vec3::Zero());
  rig.loop->wait();
  tick = rig.step();
  EXPECT_EQ(tick.state, ServoState::tripped);
  EXPECT_EQ(tick.tripped, trips::stale);
  EXPECT_EQ(words_for(tick.tripped), "the device was silent");
  EXPECT_LE(tick.age, 1ms);
  rig.run(750ms);  // out of the body and in again
  EXPECT_GT(rig.motors().norm(), 0.5);
  EXPECT_GT(rig.counters().lost_reports, 100U);
  EXPECT_EQ(rig.counters().trips_by_stale_reports, 1U);
}

TEST(Loop, NoForceWhileTheDeviceIsSilent) {
  BoardOptions options;
  options.faults.silent = {500ms, 600ms};
  Rig rig(test::pressing(), options);
  rig.run(499ms);
  ASSERT_GT(rig.motors().norm(), 0.5);
  while (rig.clock->now() < 599ms) {
    const Tick& tick = rig.step();
    if (tick.time < 507ms) continue;
    ASSERT_EQ(tick.state, ServoState::stale);
    ASSERT_EQ(rig.motors(), Vec3::Zero());
  }
  rig.run(800ms);
  EXPECT_EQ(rig.loop->last().state, ServoState::running);
  EXPECT_GT(rig.motors().norm(), 0.5);
}

TEST(Loop, GoneIsForGood) {
  BoardOptions options;
  options.faults.unplugged = 500ms;
  Rig rig(test::holding(), options);
  rig.run(499ms);
  ASSERT_EQ(rig.loop->last().state, ServoState::running);
  rig.run(3ms);
  EXPECT_EQ(rig.loop->last().state, ServoState::gone);
  EXPECT_EQ(rig.loop->last().force, Vec3::Zero());
  const std::uint64_t ticks = rig.loop->last().number;
  rig.run(1s);
  EXPECT_EQ(rig.loop->last().state, ServoState::gone);
  EXPECT_EQ(rig.loop->last().number, ticks + 1000) << "it does not spin";
}

TEST(Loop, ShortReportsAreCountedAndGiveNoForce) {
  BoardOptions options;
  options.faults.short_reports = {500ms, 600ms};
  Rig rig(test::pressing(), options);
  rig.run(590ms);
  EXPECT_EQ(rig.loop->last().state, ServoState::stale);
  EXPECT_EQ(rig.motors(), Vec3::Zero());
  EXPECT_NEAR(static_cast<double>(rig.counters().bad_reports), 90, 2);
  rig.run(800ms);
  EXPECT_GT(rig.motors().norm(), 0.5);
}

TEST(Loop, DuplicatesAndEmptyPacketsChangeNothing) {
  for (bool duplicates : {true, false}) {
    BoardOptions options;
    BoardFaults::Span& fault =
        duplicates ? options.faults.duplicates : options.faults.empty_packets;
    fault = {400ms, 700ms};
    Rig rig(test::pressing(), options);
    rig.run(399ms);
    while (rig.clock->now() < 700ms) {
      const Tick& tick = rig.step();
      ASSERT_EQ(tick.state, ServoState::running);
      ASSERT_LE(tick.age, 2ms);
      ASSERT_EQ(tick.contact.status, ContactStatus::attached);
      ASSERT_GT(rig.motors().norm(), 0.1);
    }
    EXPECT_EQ(rig.counters().lost_reports, 0U);
    EXPECT_EQ(rig.counters().bad_reports, 0U);
  }
}

TEST(Loop, LockStepGoesOnAfterALostReport) {
  BoardOptions options;
  options.feature.flags |= palpate_report::kLockStep;
  options.faults.first_report_lost = true;
  Rig rig(test::holding(), options);
  rig.run(500ms);
  EXPECT_EQ(rig.loop->last().state, ServoState::running);
  EXPECT_GT(rig.motors().norm(), 0.5);
  EXPECT_GT(rig.counters().reports, 400U);
}

// Whether it has arrived nobody knows, and what the motors have must be known before it grows.
TEST(Loop, AWriteThatFailsIsFollowedByZero) {
  BoardOptions options;
  options.faults.failing_writes = {500ms, 501ms};
  Rig rig(test::holding(), options);
  rig.run(500ms);
  const Vec3 held = rig.motors();
  ASSERT_GT(held.norm(), 0.5);
  rig.step();
  EXPECT_EQ(rig.counters().failed_writes, 1U);
  EXPECT_LT((rig.loop->last().force - held).norm(), 2 * kForceUnit) << "the motors may have it";
  rig.step();
  EXPECT_EQ(rig.board.status().last_output.command, palpate_report::kMotorsOff);
  EXPECT_EQ(rig.loop->last().force, Vec3::Zero());
  rig.run(10ms);
  EXPECT_GT(rig.motors().norm(), 0.5);
  EXPECT_EQ(rig.counters().tripped_ticks, 0U);
}

/// Pressed in at one place, at another 5 cm away from 2 s on, out of the body and in again there.
std::shared_ptr<Motion> pressing_elsewhere() {
  const Vec3 here(-0.025, -0.025, 0);
  const Vec3 there(0.015, 0.015, 0);
  const Vec3 above(0, 0, 0.005);
  const Vec3 below(0, 0, -0.004);
  return std::make_shared<ScriptedMotion>(
      std::vector<ScriptedMotion::Waypoint>{{0ms, here + above},
                                            {200ms, here + below},
                                            {600ms, here + below},
                                            {2000ms, there + below},
                                            {3000ms, there + below},
                                            {3200ms, there + above},
                                            {3300ms, there + above},
                                            {3500ms, there + below}});
}

/// From now until that time the motors have no force.
void expect_no_force(Rig& rig, Time until) {
  while (rig.clock->now() < until) {
    rig.step();
    ASSERT_EQ(rig.motors(), Vec3::Zero()) << "at " << seconds(rig.clock->now()) << " s";
  }
}

TEST(Loop, AfterAnOutageNoForceUntilTheToolWasOutside) {
  BoardOptions options;
  options.faults.silent = {500ms, 2500ms};
  Rig rig(pressing_elsewhere(), options);
  rig.run(499ms);
  ASSERT_GT(rig.motors().norm(), 0.5);
  rig.run(10ms);
  expect_no_force(rig, 3000ms);
  EXPECT_EQ(rig.loop->last().contact.status, ContactStatus::inside);
  rig.run(600ms);
  EXPECT_GT(rig.motors().norm(), 0.5);
}

// The last place that is known is outside: that is not where the hand is.
TEST(Loop, AnOutageWhileTheToolIsOutsideDoesNotCountAsOutside) {
  BoardOptions options;
  options.faults.silent = {50ms, 400ms};
  Rig rig(test::holding(), options);
  rig.run(49ms);
  ASSERT_EQ(rig.loop->last().contact.status, ContactStatus::free);
  expect_no_force(rig, 1s);
  EXPECT_EQ(rig.loop->last().contact.status, ContactStatus::inside);
}

TEST(Loop, AfterAPauseOfTheHostNoForceUntilTheToolWasOutside) {
  for (const Duration pause : {15ms, 25ms, 63ms}) {
    Rig rig(test::holding());
    rig.run(500ms);
    ASSERT_GT(rig.motors().norm(), 0.5);
    rig.clock->advance(pause);
    rig.run(100ms);
    EXPECT_EQ(rig.loop->last().age, 0ms) << "fresh";
    EXPECT_EQ(rig.motors().norm() > 0.5, pause < 20ms) << seconds(pause);
  }
}

/// Each report as if the device had been switched on anew at some time.
class Restarted final : public Transport {
 public:
  Restarted(Transport& inner, VirtualClock& clock, Time at)
      : inner_(inner), clock_(clock), at_(at) {}
  TransportStatus read(Report& report, Duration timeout) noexcept override {
    const TransportStatus status = inner_.read(report, timeout);
    palpate_report::Input input;
    if (status == TransportStatus::data && clock_.now() >= at_ &&
        palpate_report::decode_input(report, input)) {
      input.time_us -= static_cast<std::uint32_t>(at_ / 1us);
      report = palpate_report::encode_input(input);
    }
    return status;
  }
  TransportStatus write(const Report& report) noexcept override { return inner_.write(report); }
  std::string problem() const override { return inner_.problem(); }

 private:
  Transport& inner_;
  VirtualClock& clock_;
  Time at_;
};

TEST(Loop, AfterARestartOfTheDeviceNoForceUntilTheToolWasOutside) {
  Rig rig(pressing_elsewhere());
  Restarted restarted(rig.board, *rig.clock, 500ms);
  rig.loop = std::make_unique<Loop>(restarted, *rig.profile, *rig.clock, ServoOptions{}, rig.inbox,
                                    rig.outbox);
  rig.run(499ms);
  ASSERT_GT(rig.motors().norm(), 0.5);
  rig.run(10ms);
  expect_no_force(rig, 3000ms);
  rig.run(600ms);
  EXPECT_GT(rig.motors().norm(), 0.5);
  rig.loop.reset();  // before what it writes to
}

TEST(Loop, WhatMotorsHoldWhileWritesFailIsZeroAsSoonAsOneSucceeds) {
  BoardOptions options;
  options.feature.watchdog_ms = 100;
  options.faults.failing_writes = {500ms, 560ms};
  Rig rig(pressing_elsewhere(), options);
  rig.run(499ms);
  const Vec3 held = rig.motors();
  ASSERT_GT(held.norm(), 0.5);
  rig.run(59ms);
  EXPECT_EQ(rig.motors(), held) << "the board has no news";
  EXPECT_LT((rig.loop->last().force - held).norm(), 2 * kForceUnit) << "nor is it told otherwise";
  EXPECT_LE(rig.counters().failed_writes, 20U) << "a device that fails is not hammered";
  rig.run(8ms);
  expect_no_force(rig, 3000ms);
  rig.run(600ms);
  EXPECT_GT(rig.motors().norm(), 0.5);
}

// As from a window that has not yet heard that the tool has attached.
TEST(Loop, TheWorkspaceStaysWhereItIsWhileTheToolIsAttached) {
  Rig rig(std::make_shared<ScriptedMotion>(
      std::vector<ScriptedMotion::Waypoint>{{0ms, Vec3(0, 0, 0.005)},
                                            {200ms, Vec3(0.001, 0.002, -0.004)},
                                            {600ms, Vec3(0.001, 0.002, -0.004)},
                                            {800ms, Vec3(0, 0, 0.02)}}));
  TouchSettings touch;
  touch.coupling_stiffness = 300;
  rig.set(rig.settings, touch);
  rig.run(500ms);
  const Tick before = rig.loop->last();
  ASSERT_EQ(before.contact.status, ContactStatus::attached);
  LoopInbox::Settings settings{rig.settings, {}};
  settings.touch.coupling_stiffness = 200;  // as stiff at the device, with the scale that follows
  settings.servo.workspace_centre += Vec3(0.003, 0, -0.002);
  settings.servo.workspace_scale = 1.5;
  settings.servo.workspace_rotation = Eigen::AngleAxisd(0.5, Vec3::UnitY()).toRotationMatrix();
  rig.inbox.settings.write(settings);
  for (int i = 0; i < 50; ++i) {
    const Tick& tick = rig.step();
    ASSERT_EQ(tick.position, before.position);
    ASSERT_EQ(tick.contact.force, before.contact.force);
    ASSERT_LT((tick.force - before.force).norm(), 1e-12);
  }
  rig.run(400ms);
  const Tick& after = rig.loop->last();
  ASSERT_EQ(after.contact.status, ContactStatus::free);
  const ServoSettings& servo = settings.servo;
  EXPECT_LT((after.position - servo.workspace_centre -
             servo.workspace_scale * servo.workspace_rotation * after.device.position)
                .norm(),
            1e-15);
}

// The body comes to the hand: nothing is felt before the hand comes to the body.
TEST(Loop, AWorkspaceThatIsMovedIntoTheBodyGivesNoForce) {
  Rig rig(std::make_shared<ScriptedMotion>(
      std::vector<ScriptedMotion::Waypoint>{{0ms, Vec3(0, 0, 0.01)},
                                            {500ms, Vec3(0, 0, 0.01)},
                                            {600ms, Vec3(0, 0, 0.03)},
                                            {700ms, Vec3(0, 0, 0.03)},
                                            {800ms, Vec3(0, 0, 0.014)}}));
  rig.run(200ms);
  LoopInbox::Settings settings{rig.settings, {}};
  settings.servo.workspace_centre -= Vec3(0, 0, 0.016);
  rig.inbox.settings.write(settings);
  expect_no_force(rig, 500ms);
  EXPECT_EQ(rig.loop->last().contact.status, ContactStatus::inside);
  rig.run(400ms);
  EXPECT_GT(rig.motors().norm(), 0.2);
}

/// The motors' force never grows by more than the slew limit allows; a late tick has the time of
/// two.
void expect_no_jump(Rig& rig, Duration duration) {
  double before = rig.motors().norm();
  for (const Time until = rig.clock->now() + duration; rig.clock->now() < until;) {
    rig.step();
    const double now = rig.motors().norm();
    ASSERT_LE(now - before, rig.settings.slew_limit * 2e-3 + 2 * kForceUnit)
        << "at " << seconds(rig.clock->now()) << " s";
    before = now;
  }
}

// The device's own watchdog has cut the motors: the force must grow from nothing, whatever it was.
TEST(Loop, NoJumpAfterTheWatchdogOrFailingWrites) {
  for (std::uint16_t watchdog : {10, 50}) {
    for (Duration pause : {14ms, 52ms, 56ms, 63ms, 70ms}) {
      BoardOptions options;
      options.feature.watchdog_ms = watchdog;
      Rig rig(test::pressing(), options);
      rig.inbox.touch.offer(make_touch(test::box_body(2000)));
      rig.run(350ms);
      ASSERT_GT(rig.motors().norm(), 5);
      rig.clock->advance(pause);
      (void)rig.motors();  // the board sees the pause
      expect_no_jump(rig, 1s);
      EXPECT_GT(rig.motors().norm(), 5);
    }
  }
  BoardOptions options;
  options.faults.failing_writes = {350ms, 410ms};
  Rig rig(test::pressing(), options);
  rig.inbox.touch.offer(make_touch(test::box_body(2000)));
  rig.run(349ms);
  ASSERT_GT(rig.motors().norm(), 5);
  expect_no_jump(rig, 1s);
  EXPECT_GT(rig.motors().norm(), 5);
}

// The thread may be held up between reading and writing.
TEST(Loop, NoForceFromAStateThatBecameStaleInTheTick) {
  class SlowRead final : public Transport {
   public:
    SlowRead(Transport& inner, VirtualClock& clock) : inner_(inner), clock_(clock) {}
    TransportStatus read(Report& report, Duration timeout) noexcept override {
      const TransportStatus status = inner_.read(report, timeout);
      if (status == TransportStatus::nothing) clock_.advance(std::exchange(hold_up, 0ms));
      return status;
    }
    TransportStatus write(const Report& report) noexcept override { return inner_.write(report); }
    std::string problem() const override { return {}; }

    Duration hold_up{0};

   private:
    Transport& inner_;
    VirtualClock& clock_;
  };
  Rig rig(test::holding());
  SlowRead slow(rig.board, *rig.clock);
  rig.loop =
      std::make_unique<Loop>(slow, *rig.profile, *rig.clock, ServoOptions{}, rig.inbox, rig.outbox);
  rig.run(500ms);
  ASSERT_GT(rig.motors().norm(), 0.5);
  slow.hold_up = 20ms;
  EXPECT_EQ(rig.tick().state, ServoState::stale);
  EXPECT_EQ(rig.motors(), Vec3::Zero());
  rig.loop.reset();  // before what it writes to
}

TEST(Loop, OnlyWhatTheMotorsGiveIsTold) {
  BoardOptions options;
  options.feature.flags = 4;  // a motor for z alone
  Rig rig(test::holding(), options);
  rig.run(500ms);
  const Tick& tick = rig.loop->last();
  EXPECT_EQ(tick.force[0], 0);
  EXPECT_EQ(tick.force[1], 0);
  EXPECT_GT(tick.force[2], 0.5);
  EXPECT_NEAR(rig.motors()[2], tick.force[2], kForceUnit);
}

TEST(Loop, EnergyIsOnlyThatOfTheLoop) {
  Rig plain(test::pressing());
  plain.inbox.touch.offer(make_touch(test::box_body(300)));
  plain.run(3s);
  // Off, cut, another body: none of these makes energy.
  Rig rig(test::pressing());
  ServoSettings settings;
  settings.engaged = false;
  rig.set(settings);
  rig.run(1s);
  settings.engaged = true;
  settings.force_limit = 0.3;
  rig.set(settings);
  for (int i = 0; i < 40; ++i) {
    rig.run(50ms);
    rig.inbox.touch.offer(make_touch(test::box_body(100 + 100 * (i % 3))));
  }
  EXPECT_LT(plain.counters().least_dissipated, 0);
  EXPECT_GT(rig.counters().least_dissipated, 2 * plain.counters().least_dissipated);
}

// A body of the same scene that knows more is no reason to forget what the loop has made of energy;
// what it stores more at the same place is nothing that the loop has made. Of another scene nothing
// is known.
TEST(Loop, TheEnergyGoesOnWithABodyOfTheSameScene) {
  const auto of_scene = [](const std::string& scene, double stiffness) {
    TouchSpace space = test::box_space([=](int) { return test::stiffening_spring(stiffness); });
    space.scene_hash = scene;
    return make_touch(std::make_shared<const Touchable>(space));
  };
  Rig rig(test::pressing());
  ServoSettings settings;
  settings.passivity_control = false;
  rig.set(settings);
  rig.inbox.touch.offer(of_scene("scene", 300));
  rig.run(450ms);
  const Tick before = rig.loop->last();
  ASSERT_EQ(before.contact.status, ContactStatus::attached);
  ASSERT_NE(before.dissipated, 0);
  rig.inbox.touch.offer(of_scene("scene", 600));
  Tick after = rig.step();
  ASSERT_EQ(after.contact.status, ContactStatus::attached);
  EXPECT_GT(after.contact.energy, 1.5 * before.contact.energy);
  EXPECT_EQ(after.dissipated, before.dissipated);
  rig.run(50ms);
  EXPECT_NE(rig.loop->last().dissipated, before.dissipated) << "It goes on from there.";

  rig.inbox.touch.offer(of_scene("another scene", 600));
  after = rig.step();
  EXPECT_EQ(after.contact.status, ContactStatus::inside);
  EXPECT_EQ(after.dissipated, 0);
}

TEST(Loop, ZeroForceOnTheWayOut) {
  Rig rig(test::holding());
  rig.run(500ms);
  ASSERT_GT(rig.motors().norm(), 0.5);
  rig.loop.reset();
  EXPECT_EQ(rig.motors(), Vec3::Zero());
  EXPECT_FALSE(rig.board.status().motors_on);
  EXPECT_EQ(rig.board.status().cuts, 0U) << "not by the board's own watchdog";
}

TEST(Loop, ZeroForceOnTheWayOutThoughAWriteFails) {
  class Flaky final : public Transport {
   public:
    Flaky(Transport& inner, int& failures) : inner_(inner), failures_(failures) {}
    TransportStatus read(Report& report, Duration timeout) noexcept override {
      return inner_.read(report, timeout);
    }
    TransportStatus write(const Report& report) noexcept override {
      return failures_ > 0 && failures_-- > 0 ? TransportStatus::error : inner_.write(report);
    }
    std::string problem() const override { return inner_.problem(); }

   private:
    Transport& inner_;
    int& failures_;
  };
  Rig rig(test::holding());
  int failures = 0;
  Flaky flaky(rig.board, failures);
  rig.loop = std::make_unique<Loop>(flaky, *rig.profile, *rig.clock, ServoOptions{}, rig.inbox,
                                    rig.outbox);
  rig.run(500ms);
  ASSERT_GT(rig.motors().norm(), 0.5);
  failures = 9;
  rig.loop.reset();
  EXPECT_EQ(rig.motors(), Vec3::Zero());
  EXPECT_EQ(rig.board.status().cuts, 0U) << "not by the board's own watchdog";
}

TEST(Loop, NotEngagedNoForceUntilTheToolWasOutside) {
  Rig rig(test::pressing());
  ServoSettings settings;
  settings.engaged = false;
  rig.set(settings);
  rig.run(500ms);
  EXPECT_EQ(rig.loop->last().state, ServoState::ready);
  EXPECT_EQ(rig.loop->last().contact.status, ContactStatus::inside);
  EXPECT_EQ(rig.motors(), Vec3::Zero());
  settings.engaged = true;
  rig.set(settings);
  expect_no_force(rig, 700ms);
  EXPECT_EQ(rig.loop->last().state, ServoState::tripped);
  EXPECT_EQ(rig.loop->last().tripped, trips::disengaged);
  rig.run(700ms);
  EXPECT_EQ(rig.loop->last().state, ServoState::running);
  EXPECT_GT(rig.motors().norm(), 0.5);
}

// Held while it goes in, let go in the body, held again there, and from then on.
TEST(Loop, ForcesOnlyWhileTheDeadManButtonIsHeld) {
  const auto pressing = test::pressing();
  Rig rig(std::make_shared<ScriptedMotion>([&](Time time) {
    Motion::Pose pose = pressing->advance(time, Vec3::Zero());
    pose.buttons = time < 400ms || time >= 500ms ? 0b10 : 0b01;
    return pose;
  }));
  ServoSettings settings;
  settings.dead_man_button = 1;
  rig.set(settings);
  rig.run(399ms);
  EXPECT_GT(rig.motors().norm(), 0.5);
  rig.run(3ms);
  EXPECT_EQ(rig.loop->last().contact.status, ContactStatus::inside) << "the tool lets go";
  expect_no_force(rig, 700ms);
  EXPECT_EQ(rig.loop->last().tripped, trips::disengaged);
  rig.run(700ms);
  EXPECT_GT(rig.motors().norm(), 0.5);
  EXPECT_EQ(rig.counters().trips_by_disengaging, 1U);
}

TEST(Loop, WithoutAButtonTheDeadManSwitchIsRefused) {
  Specification device;
  device.model = "Ball on a spring";
  device.max_linear_force = 3;
  device.num_buttons = 0;
  try {
    (void)dead_man_button_of(device);
    FAIL();
  } catch (const InputError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("Ball on a spring has motors and no button"), std::string::npos) << text;
    EXPECT_NE(text.find("'Only while the button is held'"), std::string::npos) << text;
  }
  device.num_buttons = 2;
  EXPECT_EQ(dead_man_button_of(device), 0);
  device.max_linear_force = 0;
  EXPECT_EQ(dead_man_button_of(device), 0);
  device.num_buttons = 0;
  EXPECT_EQ(dead_man_button_of(device), -1) << "nothing moves the hand";
}

TEST(Loop, TheLimitsHoldWhateverTheBody) {
  for (double stiffness : {1e3, 1e7, 1e300}) {
    Rig rig(test::pressing());
    rig.inbox.touch.offer(make_touch(test::box_body(stiffness)));
    ServoSettings settings;
    settings.force_limit = 2;
    settings.slew_limit = 300;
    settings.damping = 5;
    rig.set(settings);
    Vec3 before = Vec3::Zero();
    double largest = 0;
    for (int i = 0; i < 2000; ++i) {
      const Tick& tick = rig.step();
      ASSERT_TRUE(tick.force.allFinite());
      ASSERT_LE(tick.force.norm(), 2 * (1 + 1e-12));
      ASSERT_LE((tick.force - before).norm(), 0.3 * (1 + 1e-9));
      before = tick.force;
      largest = std::max(largest, tick.force.norm());
    }
    EXPECT_GT(largest, 1.99);
  }
}

TEST(Loop, ABodyReplacedWhileTouchedMakesNoJump) {
  Rig rig(test::holding());
  rig.run(500ms);
  Vec3 before = rig.motors();
  const Vec3 soft = before;
  rig.inbox.touch.offer(make_touch(test::box_body(2000)));
  for (int i = 0; i < 30; ++i) {
    rig.step();
    EXPECT_LE((rig.motors() - before).norm(), 0.5 + 2 * kForceUnit);
    before = rig.motors();
  }
  EXPECT_EQ(rig.loop->last().contact.status, ContactStatus::attached);
  EXPECT_GT(before.norm(), 4 * soft.norm());
  rig.inbox.touch.collect();
  rig.inbox.touch.offer(nullptr);
  rig.run(50ms);
  EXPECT_EQ(rig.loop->last().contact.status, ContactStatus::nothing);
  EXPECT_EQ(rig.motors(), Vec3::Zero());
}

// The device's x to the left of the scene, its z out of it, and half as long.
TEST(Loop, WorkspaceIsTurnedAndScaled) {
  Mat3 turn;
  turn << 0, -1, 0,  //
      1, 0, 0,       //
      0, 0, 1;
  Rig rig(test::holding());
  ServoSettings settings;
  settings.workspace_rotation = turn;
  settings.workspace_scale = 0.5;
  settings.force_scale = 3;
  rig.set(settings);
  rig.run(500ms);
  const Tick& tick = rig.loop->last();
  const Vec3 place = test::kMiddle + 0.5 * turn * tick.device.position;
  EXPECT_LT((tick.position - place).norm(), 1e-15);
  const Vec3 wanted = 3 * turn.transpose() * exact_force(place - tick.contact.anchor);
  EXPECT_LT((rig.motors() - wanted).norm(), 2 * kForceUnit + kInterpolation * wanted.norm());
}

TEST(Loop, DampingIsAgainstTheVelocity) {
  const auto moving = std::make_shared<ScriptedMotion>([](Time time) {
    // Sideways along the top at a steady 50 mm/s, 4 mm deep from 200 ms on.
    const double s = seconds(time);
    return Motion::Pose{Vec3(0, 0.05 * (s - 0.3), s < 0.2 ? 0.005 - 0.045 * s : -0.004)};
  });
  Vec3 forces[2];
  for (int damped : {0, 1}) {
    Rig rig(moving);
    ServoSettings settings;
    settings.damping = 4.0 * damped;
    settings.passivity_control = false;
    rig.set(settings);
    rig.run(300ms);
    EXPECT_NEAR(rig.loop->last().velocity[1], 0.05, 0.002);
    forces[damped] = rig.motors();
  }
  EXPECT_NEAR((forces[1] - forces[0])[1], -0.2, 0.01);
}

// Every second tick has no report: that is no stop of the hand.
TEST(Loop, VelocityIsThatBetweenReports) {
  for (std::uint16_t interval_us : {1003, 1500, 2000}) {
    BoardOptions options;
    options.feature.interval_us = interval_us;
    Rig rig(std::make_shared<ScriptedMotion>(
                [](Time time) { return Motion::Pose{Vec3(0.1 * seconds(time), 0, 0.02)}; }),
            options);
    rig.run(50ms);
    for (int i = 0; i < 100; ++i) {
      EXPECT_NEAR(rig.step().velocity[0], 0.1, 0.005) << interval_us;
    }
  }
}

TEST(Loop, ClocksMayDriftThroughASilence) {
  for (double drift : {-2.8e-3, 2.8e-3}) {
    BoardOptions options;
    options.clock_drift = drift;
    options.faults.silent = {500ms, 2500ms};
    Rig rig(test::pressing(), options);
    rig.run(2510ms);
    const std::uint64_t stale = rig.counters().stale_ticks;
    EXPECT_GT(stale, 1900U) << drift;
    rig.run(500ms);
    EXPECT_EQ(rig.counters().stale_ticks, stale) << drift;
  }
}

TEST(Loop, ClocksMayDrift) {
  for (double drift : {-2e-3, 2e-3}) {
    BoardOptions options;
    options.clock_drift = drift;
    options.first_time_us = 0xFFFFFFFF - 2'000'000;  // it wraps on the way
    options.first_counter = 65000;
    Rig rig(test::holding(), options);
    rig.run(20s);
    EXPECT_LE(rig.counters().stale_ticks, 3U) << drift;
    EXPECT_EQ(rig.counters().lost_reports, 0U);
  }
}

TEST(Loop, EveryTickIsRecorded) {
  Rig rig(test::pressing());
  const auto ring = std::make_shared<TickRing>(1024);
  rig.inbox.recording.offer(ring);
  rig.run(500ms);
  TickRecord record;
  for (std::uint64_t n = 1; n <= 500; ++n) {
    ASSERT_TRUE(ring->pop(record));
    EXPECT_EQ(record.tick.number, n);
    if (n < 3) continue;
    EXPECT_EQ(record.tick.num_reports, 1);
    DeviceState state = record.tick.device;
    EXPECT_TRUE(rig.profile->decode(record.received[0], state));
    EXPECT_EQ(state.position, record.tick.device.position);
    EXPECT_EQ(record.sent, rig.profile->encode(record.tick.force, record.tick.device));
  }
  EXPECT_FALSE(ring->pop(record));
}

TEST(Loop, CouplingForADeviceThatDisplaysLess) {
  Specification device;
  device.max_linear_stiffness = 1000;
  ServoSettings settings;
  EXPECT_EQ(coupling_stiffness_for(device, 900, settings), 0);
  EXPECT_EQ(coupling_stiffness_of_tool(device, 900, settings), 900);
  EXPECT_EQ(coupling_stiffness_of_tool(device, 1100, settings), 1000);
  EXPECT_EQ(coupling_stiffness_for(device, 1100, settings), 1000);
  settings.force_scale = 4;
  settings.workspace_scale = 0.5;
  EXPECT_EQ(coupling_stiffness_for(device, 900, settings), 500);
  EXPECT_EQ(coupling_stiffness_of_tool(device, 900, settings), 500);
  device.max_linear_stiffness = 0;
  EXPECT_EQ(coupling_stiffness_for(device, 1e9, settings), 0);
  EXPECT_EQ(coupling_stiffness_of_tool(device, 1e9, settings), 1e9);
}

TEST(Loop, BadOptionsAndSettings) {
  const auto refuses_options = [](auto&& change) {
    ServoOptions options;
    EXPECT_NO_THROW(validate(options));
    change(options);
    EXPECT_THROW(validate(options), InputError);
  };
  refuses_options([](ServoOptions& o) { o.period = 0ms; });
  refuses_options([](ServoOptions& o) { o.stale_after = -1ms; });
  refuses_options([](ServoOptions& o) { o.release_after = 0ms; });
  refuses_options([](ServoOptions& o) { o.lock_step_timeout = 0ms; });
  refuses_options([](ServoOptions& o) { o.stop_timeout = 0ms; });
  refuses_options([](ServoOptions& o) { o.priority = 100; });
  refuses_options([](ServoOptions& o) { o.priority = -1; });
  const auto refuses = [](auto&& change) {
    ServoSettings settings;
    EXPECT_NO_THROW(validate(settings));
    change(settings);
    EXPECT_THROW(validate(settings), InputError);
  };
  const double nan = std::nan("");
  refuses([&](ServoSettings& s) { s.workspace_centre[1] = nan; });
  refuses([](ServoSettings& s) { s.workspace_rotation *= 1.01; });
  refuses([](ServoSettings& s) { s.workspace_rotation.col(0) *= -1; });
  refuses([&](ServoSettings& s) { s.workspace_rotation(0, 1) = nan; });
  refuses([](ServoSettings& s) { s.workspace_scale = 0; });
  refuses([](ServoSettings& s) { s.force_scale = -1; });
  refuses([](ServoSettings& s) { s.force_limit = -1; });
  refuses([](ServoSettings& s) { s.slew_limit = 0; });
  refuses([&](ServoSettings& s) { s.damping = nan; });
  refuses([](ServoSettings& s) { s.dead_man_button = -2; });
  refuses([](ServoSettings& s) { s.dead_man_button = 32; });
  Specification device;
  device.num_buttons = 2;
  ServoSettings settings;
  EXPECT_NO_THROW(validate(settings, device));
  settings.dead_man_button = 1;
  EXPECT_NO_THROW(validate(settings, device));
  settings.dead_man_button = 2;
  EXPECT_THROW(validate(settings, device), InputError);
}

/// A rigid tool down into the middle of the top and up again.
std::shared_ptr<Motion> diving(double depth) {
  const Vec3 touching = test::kTouching - test::kMiddle;
  const Vec3 above = touching + Vec3(0, 0, 0.003);
  return std::make_shared<ScriptedMotion>(std::vector<ScriptedMotion::Waypoint>{
      {0ms, above}, {300ms, touching - Vec3(0, 0, depth)}, {600ms, above}, {700ms, above}});
}

// A tool that has gone through the surface feels nothing there: that is told as inside and beyond
// what the space knows, and is never a force of zero of one that is free or presses.
TEST(Loop, AToolThatHasGoneThroughTheSurfaceIsInside) {
  Rig rig(diving(0.005));
  rig.inbox.touch.offer(make_touch(test::pierced_body(0.5 * test::kPressedCell)));
  int inside = 0;
  for (int i = 0; i < 700; ++i) {
    const Tick& tick = rig.step();
    EXPECT_EQ(tick.force, Vec3::Zero());
    EXPECT_EQ(rig.motors(), Vec3::Zero());
    if (tick.state != ServoState::running) continue;
    if (tick.position[2] > test::kTouching[2]) {
      EXPECT_EQ(tick.contact.status, ContactStatus::free);
    } else {
      ++inside;
      EXPECT_EQ(tick.contact.status, ContactStatus::inside);
      EXPECT_EQ(tick.contact.support, Support::extrapolated);
      EXPECT_LT(tick.contact.distance, 0.01) << "that of its centre";
    }
  }
  EXPECT_GT(inside, 300);
}

// What was felt before goes on, as an extrapolation, and never without a force.
TEST(Loop, AToolThatGoesThroughTheSurfaceDeeperIsPressedOnByAnExtrapolation) {
  Rig rig(diving(0.005));
  rig.inbox.touch.offer(make_touch(test::pierced_body(1.5 * test::kPressedCell)));
  int extrapolated = 0;
  for (int i = 0; i < 700; ++i) {
    const Tick& tick = rig.step();
    if (tick.state != ServoState::running) continue;
    const double depth = test::kTouching[2] - tick.position[2];
    if (depth < 1e-4) continue;
    EXPECT_EQ(tick.contact.status, ContactStatus::pressing);
    EXPECT_GT(tick.contact.force[2], 0);
    if (depth < test::kPressedCell) {
      EXPECT_EQ(tick.contact.support, Support::inside);
    } else {
      ++extrapolated;
      EXPECT_EQ(tick.contact.support, Support::extrapolated);
    }
  }
  EXPECT_GT(extrapolated, 100);
}

}  // namespace
}  // namespace palpate::test::test_loop
