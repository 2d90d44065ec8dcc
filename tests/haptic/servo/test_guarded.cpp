// SPDX-License-Identifier: BSD-3-Clause
// The loop and its guardian, whose part the test plays. What the board's motors do is what counts.
#include <gtest/gtest.h>

#include "haptic/servo/haptic_device.h"
#include "haptic/servo/rig.h"
#include "haptic/support/guarded_transport.h"

namespace palpate::test::test_guarded {
namespace {

using namespace std::chrono_literals;
using test::GuardedTransport;
using test::Rig;

/// The board's profile with another specification.
class OtherProfile final : public Profile {
 public:
  OtherProfile(const Profile& profile, const Specification& specification)
      : Profile(specification), profile_(profile) {}
  bool decode(const Report& report, DeviceState& state) const noexcept override {
    return profile_.decode(report, state);
  }
  Report zero_force(const DeviceState& state) const noexcept override {
    return profile_.zero_force(state);
  }

 private:
  Report do_encode(const Vec3& force, const DeviceState& state) const noexcept override {
    return profile_.encode(force, state);
  }

  const Profile& profile_;
};

struct Guarded : testing::Test {
  /// The board's loop anew, with the transport and maybe another profile.
  void begin(std::shared_ptr<Motion> motion, GuardianChannel* guardian) {
    rig = std::make_unique<Rig>(std::move(motion));
    transport = std::make_unique<GuardedTransport>(rig->board, guardian);
    make_loop(*rig->profile);
  }
  void make_loop(const Profile& profile) {
    rig->loop = std::make_unique<Loop>(*transport, profile, *rig->clock, ServoOptions{}, rig->inbox,
                                       rig->outbox);
  }
  /// With a guardian that looks.
  void run(Duration duration) {
    for (const Time until = rig->clock->now() + duration; rig->clock->now() < until;) {
      channel.look(rig->clock->now());
      rig->step();
    }
  }

  void expect_no_force_after(HostState state) {
    begin(test::pressing(), &channel);
    run(500ms);
    ASSERT_GT(rig->motors().norm(), 0.5);
    channel.say_host_fails(state);
    channel.say_host_hangs(false);
    for (int i = 0; i < 3000; ++i) {
      run(1ms);
      ASSERT_EQ(rig->motors(), Vec3::Zero()) << "outside and in again";
    }
  }

  GuardianChannel channel;
  std::unique_ptr<Rig> rig;
  std::unique_ptr<GuardedTransport> transport;

  void TearDown() override {
    // Before the transport.
    if (rig) rig->loop.reset();
  }
};

TEST_F(Guarded, TheLoopSaysThatItLives) {
  begin(test::holding(), &channel);
  EXPECT_TRUE(channel.resting());
  run(500ms);
  EXPECT_GT(rig->motors().norm(), 0.5);
  EXPECT_GT(channel.until_loop_is_silent(rig->clock->now()), GuardianChannel::kLoopSilence - 2ms);
  rig->loop.reset();
  EXPECT_TRUE(channel.resting());
}

TEST_F(Guarded, NoRestWhereTheLastZeroIsNotTaken) {
  begin(test::holding(), &channel);
  run(500ms);
  transport->fails = true;
  rig->loop.reset();
  EXPECT_FALSE(channel.resting()) << "the guardian goes on where the loop has failed";
}

TEST_F(Guarded, ATripIsZeroUntilTheToolWasOutside) {
  begin(test::pressing(), &channel);
  run(500ms);
  ASSERT_GT(rig->motors().norm(), 0.5);
  channel.trip();
  run(1ms);
  EXPECT_EQ(rig->motors(), Vec3::Zero()) << "in the next tick";
  EXPECT_FALSE(channel.tripped()) << "acknowledged";
  EXPECT_NE(rig->loop->last().tripped & trips::guardian, 0U);
  // Still inside for 270 ms more, and outside afterwards.
  for (int i = 0; i < 250; ++i) {
    run(1ms);
    ASSERT_EQ(rig->motors(), Vec3::Zero());
  }
  EXPECT_EQ(rig->loop->last().state, ServoState::tripped);
  run(700ms);
  EXPECT_GT(rig->motors().norm(), 0.5);
  EXPECT_EQ(rig->counters().trips_by_guardian, 1U);
}

TEST_F(Guarded, AProgramThatHasCrashedGetsNoForceAnyMore) {
  expect_no_force_after(HostState::crashed);
}

TEST_F(Guarded, AProgramThatWasAskedToEndGetsNoForceAnyMore) {
  expect_no_force_after(HostState::ending);
}

// A crash in what tidies up is a crash, and what comes after a crash makes it no less of one.
TEST_F(Guarded, ACrashCountsForMoreThanTheWishToEnd) {
  channel.say_host_fails(HostState::ending);
  EXPECT_EQ(channel.host(), HostState::ending);
  channel.say_host_fails(HostState::crashed);
  channel.say_host_fails(HostState::ending);
  EXPECT_EQ(channel.host(), HostState::crashed);
}

TEST_F(Guarded, AHostThatHangsGetsNoForceUntilTheToolWasOutside) {
  begin(test::pressing(), &channel);
  run(500ms);
  ASSERT_GT(rig->motors().norm(), 0.5);
  channel.say_host_hangs(true);
  for (int i = 0; i < 2000; ++i) {
    run(1ms);
    ASSERT_EQ(rig->motors(), Vec3::Zero()) << "outside and in again";
  }
  // At 500 ms of its motion, inside.
  channel.say_host_hangs(false);
  for (int i = 0; i < 250; ++i) {
    run(1ms);
    ASSERT_EQ(rig->motors(), Vec3::Zero());
  }
  run(700ms);
  EXPECT_GT(rig->motors().norm(), 0.5);
}

TEST_F(Guarded, ATripIsAcknowledgedWhenTheDeviceHasTakenZero) {
  begin(test::holding(), &channel);
  run(500ms);
  transport->fails = true;
  channel.trip();
  run(100ms);
  EXPECT_TRUE(channel.tripped());
  EXPECT_EQ(rig->loop->last().state, ServoState::tripped);
  transport->fails = false;
  run(10ms);
  EXPECT_FALSE(channel.tripped());
  EXPECT_EQ(rig->motors(), Vec3::Zero());
}

TEST_F(Guarded, TheLoopLetsGoWhenTheGuardianIsDead) {
  begin(test::pressing(), &channel);
  run(400ms);
  ASSERT_GT(rig->motors().norm(), 0.5);
  // It no longer looks.
  rig->run(GuardianChannel::kGuardianSilence + 1ms);
  EXPECT_EQ(rig->motors(), Vec3::Zero());
  for (int i = 0; i < 3000; ++i) {
    rig->step();
    ASSERT_EQ(rig->motors(), Vec3::Zero()) << "outside and in again";
  }
}

TEST_F(Guarded, NoForceBeforeTheGuardianLooks) {
  begin(test::holding(), &channel);
  rig->run(500ms);
  EXPECT_EQ(rig->counters().largest_force, 0);
}

TEST_F(Guarded, MotorsWithoutWatchdogAndGuardianStayOff) {
  for (GuardianChannel* guardian : {static_cast<GuardianChannel*>(nullptr), &channel}) {
    begin(test::holding(), guardian);
    Specification specification = rig->profile->specification();
    specification.watchdog = 0ms;
    const OtherProfile profile(*rig->profile, specification);
    make_loop(profile);
    run(500ms);
    EXPECT_EQ(rig->motors().norm() > 0.5, guardian != nullptr);
    rig->loop.reset();
  }
}

TEST_F(Guarded, AProgramWithItsOwnLoopToo) {
  begin(test::holding(), &channel);
  rig->loop.reset();
  HapticDevice device(std::make_unique<GuardedTransport>(rig->board, &channel),
                      make_profile(ProfileKind::palpate_report, rig->board.feature()), rig->clock);
  ASSERT_TRUE(device.open());
  const auto round = [&](const Vec3& force) {
    channel.look(rig->clock->now());
    Vec3 position;
    (void)device.getPosition(position);
    const bool sent = device.setForce(force);
    rig->clock->advance(1ms);
    return sent;
  };
  const Vec3 force(0, 0, 0.4);
  for (int i = 0; i < 20; ++i) (void)round(force);
  ASSERT_EQ(rig->motors(), force);
  channel.trip();
  for (int i = 0; i < 20; ++i) {
    EXPECT_FALSE(round(force));
    EXPECT_EQ(rig->motors(), Vec3::Zero());
  }
  EXPECT_FALSE(channel.tripped());
  (void)round(Vec3::Zero());
  for (int i = 0; i < 20; ++i) (void)round(force);
  EXPECT_EQ(rig->motors(), force) << "after it has asked for zero";
  EXPECT_TRUE(device.close());
  EXPECT_TRUE(channel.resting());
}

}  // namespace
}  // namespace palpate::test::test_guarded
