// SPDX-License-Identifier: BSD-3-Clause
// What the guardian does, by times that are written down.
#include "haptic/guardian/watch.h"

#include <gtest/gtest.h>

namespace palpate::test::test_watch {
namespace {

using namespace std::chrono_literals;
using Action = Watch::Step::Action;
using Host = Watch::Host;

struct WatchTest : testing::Test {
  Action look(Time at, Host host = Host::running) {
    step = watch.look(at, host);
    return step.action;
  }

  GuardianChannel channel;
  Watch watch{channel};
  Watch::Step step;
};

TEST_F(WatchTest, LeavesARestingDeviceAlone) {
  EXPECT_EQ(look(0ms), Action::none);
  EXPECT_EQ(look(100s), Action::none);
  EXPECT_GT(step.wait, 0ms);
  channel.beat(200s);
  channel.rest();
  EXPECT_EQ(look(300s), Action::none);
  EXPECT_FALSE(channel.tripped());
}

TEST_F(WatchTest, LeavesALivingLoopAlone) {
  for (Time now = 0ms; now < 1s; now += 1ms) {
    channel.beat(now);
    ASSERT_EQ(look(now + 900us), Action::none);
  }
  EXPECT_FALSE(channel.tripped());
}

// However the looks lie before it, one comes when the silence has lasted 20 ms.
TEST_F(WatchTest, TripsAfterTwentyMillisecondsOfSilence) {
  for (Duration first = 0ms; first < 10ms; first += 100us) {
    GuardianChannel silent;
    Watch its(silent);
    silent.beat(1s);
    Time now = 1s + first;
    Watch::Step next = its.look(now, Host::running);
    while (next.action == Action::none) {
      ASSERT_FALSE(silent.tripped());
      ASSERT_GT(next.wait, 0ns);
      now += next.wait;
      next = its.look(now, Host::running);
    }
    EXPECT_EQ(next.action, Action::zero);
    EXPECT_TRUE(silent.tripped());
    EXPECT_EQ(now, 1s + GuardianChannel::kLoopSilence);
  }
}

TEST_F(WatchTest, WritesZeroUntilTheLoopAcknowledges) {
  channel.beat(1s);
  Time now = 1s + 20ms;
  Time last_wait{0};
  for (int i = 0; i < 1000; ++i, now += step.wait) {
    ASSERT_EQ(look(now), Action::zero);
    watch.zero_was_taken();
    last_wait = step.wait;
    if (i == 0) {
      ASSERT_EQ(step.wait, Watch::kZeroPeriod);
    }
  }
  EXPECT_EQ(last_wait, Watch::kSlowZeroPeriod);
  // The process goes on, and what its loop writes first is late: the zero comes after it.
  channel.beat(now);
  EXPECT_EQ(look(now + 1ms), Action::zero);
  channel.acknowledge();
  EXPECT_EQ(look(now + 2ms), Action::none);
  // The next silence is another trip, with many zeros at its beginning again.
  EXPECT_EQ(look(now + 20ms), Action::zero);
  EXPECT_TRUE(channel.tripped());
  EXPECT_EQ(step.wait, Watch::kZeroPeriod);
}

TEST_F(WatchTest, ADeadHostIsFollowedByZerosThatAreTaken) {
  channel.beat(1s);
  EXPECT_EQ(look(1s + 1ms), Action::none);
  Time now = 1s + 2ms;
  // Those that fail do not count.
  for (int i = 0; i < 500; ++i, now += step.wait) ASSERT_EQ(look(now, Host::dead), Action::zero);
  for (int i = 0; i < Watch::kLastZeros; ++i, now += step.wait) {
    ASSERT_EQ(look(now, Host::dead), Action::zero);
    watch.zero_was_taken();
  }
  EXPECT_EQ(look(now, Host::dead), Action::end);
  EXPECT_TRUE(channel.tripped());
}

TEST_F(WatchTest, ZerosFromBeforeTheDeathDoNotCount) {
  channel.beat(1s);
  for (int i = 0; i < 10; ++i) {
    ASSERT_EQ(look(2s), Action::zero);
    watch.zero_was_taken();
  }
  EXPECT_EQ(look(3s, Host::dead), Action::zero);
}

// What a host that crashes overwrites must not keep the guardian from its work.
TEST_F(WatchTest, ADeadHostIsBelievedWhateverTheMemorySays) {
  channel.rest();
  EXPECT_EQ(look(1s, Host::dead), Action::zero);
  channel.acknowledge();
  EXPECT_EQ(look(1s, Host::dead), Action::zero);
}

// Its loop lives on, takes zero and acknowledges, again and again.
TEST_F(WatchTest, AHostThatHasCrashedGetsZeroForGood) {
  channel.beat(1s);
  EXPECT_EQ(look(1s), Action::none);
  channel.say_host_fails(HostState::crashed);
  for (Time now = 1s; now < 3s; now += 10ms) {
    channel.beat(now);
    ASSERT_EQ(look(now), Action::zero);
    channel.acknowledge();
  }
  EXPECT_EQ(step.wait, Watch::kSlowZeroPeriod);
  EXPECT_EQ(channel.host(), HostState::crashed);
}

TEST_F(WatchTest, AHostThatHangsGetsZeroUntilItGoesOn) {
  for (Time now = 1s; now < 2s; now += 10ms) {
    channel.beat(now);
    ASSERT_EQ(look(now, Host::hanging), Action::zero);
    ASSERT_EQ(channel.host(), HostState::hanging);
    channel.acknowledge();
  }
  channel.beat(2s);
  EXPECT_EQ(look(2s, Host::running), Action::none);
  EXPECT_EQ(channel.host(), HostState::living);
  channel.say_host_fails(HostState::crashed);
  (void)look(2s + 2ms, Host::running);
  EXPECT_EQ(channel.host(), HostState::crashed) << "what has crashed does not live again";
}

TEST_F(WatchTest, ATimeThatIsStillToComeIsSilence) {
  channel.beat(1000s);
  EXPECT_EQ(look(1s), Action::zero);
}

TEST_F(WatchTest, EndsWithAHostThatHasFinished) {
  channel.beat(1s);
  channel.rest();
  EXPECT_EQ(look(1s, Host::finished), Action::end);
  EXPECT_FALSE(channel.tripped());
}

TEST_F(WatchTest, TheLoopSeesThatItIsGuarded) {
  EXPECT_FALSE(channel.guarded(1s)) << "before the guardian has looked";
  (void)look(1s);
  EXPECT_TRUE(channel.guarded(1s + GuardianChannel::kGuardianSilence));
  EXPECT_FALSE(channel.guarded(1s + GuardianChannel::kGuardianSilence + 1ns));
}

}  // namespace
}  // namespace palpate::test::test_watch
