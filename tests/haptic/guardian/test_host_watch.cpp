// SPDX-License-Identifier: BSD-3-Clause
// When a program counts as hanging, by times and figures that are written down.
#include "haptic/guardian/host_watch.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <cstring>
#include <fstream>
#include <sstream>
#include <thread>

namespace palpate::test::test_host_watch {
namespace {

using namespace std::chrono_literals;

constexpr std::int32_t kThread = 7;
constexpr std::uint64_t kBlocked = std::uint64_t{1} << (SIGSEGV - 1);

struct HostWatchTest : testing::Test {
  /// Half a minute and more, by steps of 50 ms.
  /// @param status, host_lived Of each step.
  /// @return When it was first found to hang, from the begin; none: never.
  template <class Status, class Lived>
  std::optional<Duration> first_hang(Status status, Lived host_lived, Duration length = 100s) {
    const Time begin = 1000s;
    for (Duration since = 0s; since < length; since += HostWatch::kPeriod) {
      if (watch.hangs(begin + since, kThread, status(since), host_lived(begin + since))) {
        return since;
      }
    }
    return {};
  }

  HostWatch watch{::getpid()};
};

/// Sleeps all the time.
ThreadStatus sleeps(Duration) { return {false, 0, 5}; }
std::optional<Time> never(Time) { return {}; }
/// It has said once that it lives, and then no more.
std::optional<Time> once(Time) { return Time(1000s); }

TEST_F(HostWatchTest, AThreadThatNoLongerRunsHangsAfterHalfAMinute) {
  const auto at = first_hang(sleeps, once);
  ASSERT_TRUE(at);
  EXPECT_EQ(*at, HostWatch::kSilence + HostWatch::kPeriod);
}

TEST_F(HostWatchTest, AThreadThatHasNeverSaidThatItLivesMayWaitForEver) {
  EXPECT_FALSE(first_hang(sleeps, never));
}

TEST_F(HostWatchTest, AThreadThatComputesForLongDoesNotHang) {
  EXPECT_FALSE(first_hang([](Duration) { return ThreadStatus{true, 0, 5}; }, once, 1000s));
}

TEST_F(HostWatchTest, AThreadThatWaitsAndLooksNowAndThenDoesNotHang) {
  const auto looks = [](Duration since) {
    return ThreadStatus{false, 0, static_cast<std::uint64_t>(since / 25s)};
  };
  EXPECT_FALSE(first_hang(looks, once, 1000s));
}

TEST_F(HostWatchTest, WhoSaysThatHeLivesDoes) {
  EXPECT_FALSE(first_hang(sleeps, [](Time now) { return std::optional(now - 29s); }));
}

TEST_F(HostWatchTest, AThreadThatGoesOnNoLongerHangs) {
  ASSERT_TRUE(first_hang(sleeps, once));
  EXPECT_FALSE(watch.hangs(1101s, kThread, {false, 0, 6}, once(1101s)));
}

TEST_F(HostWatchTest, ACrashThatIsHandledForLongIsAHang) {
  const auto crashes = [](Duration since) {
    return ThreadStatus{true, since >= 10s ? kBlocked : 0, 5};
  };
  const auto at = first_hang(crashes, never);
  ASSERT_TRUE(at);
  EXPECT_EQ(*at, 10s + HostWatch::kHandling + HostWatch::kPeriod);
}

// All signals are blocked for a moment where a program or a thread is started.
TEST_F(HostWatchTest, SignalsThatAreBlockedForAMomentAreNoCrash) {
  const auto blocks = [](Duration since) {
    return ThreadStatus{true, since % 1s < HostWatch::kHandling ? kBlocked : 0, 5};
  };
  EXPECT_FALSE(watch.hangs(999s, kThread, sleeps(0s), {}));
  EXPECT_FALSE(first_hang(blocks, never));
}

TEST_F(HostWatchTest, SignalsThatWereBlockedAllAlongAreNoCrash) {
  EXPECT_FALSE(first_hang([](Duration) { return ThreadStatus{true, kBlocked, 5}; }, never));
}

// The system blocks all signals of a thread as it starts the guardian, and the guardian may look
// before that is over.
TEST_F(HostWatchTest, SignalsThatWereBlockedWhenTheWatchBeganAreWatchedFromThenOn) {
  const auto crashes = [](Duration since) {
    const bool blocks = since < HostWatch::kPeriod || since >= 10s;
    return ThreadStatus{true, blocks ? kBlocked : 0, 5};
  };
  const auto at = first_hang(crashes, never);
  ASSERT_TRUE(at);
  EXPECT_EQ(*at, 10s + HostWatch::kHandling + HostWatch::kPeriod);
}

// palpate-servo waits for the wish that it end with those signals blocked.
TEST_F(HostWatchTest, AnotherSignalThanThoseThatWereBlockedAllAlongIsHandled) {
  const std::uint64_t end = std::uint64_t{1} << (SIGTERM - 1);
  const auto crashes = [&](Duration since) {
    return ThreadStatus{true, since >= 10s ? end | kBlocked : end, 5};
  };
  const auto at = first_hang(crashes, never);
  ASSERT_TRUE(at);
  EXPECT_EQ(*at, 10s + HostWatch::kHandling + HostWatch::kPeriod);
}

TEST_F(HostWatchTest, ReadsWhatTheSystemSays) {
  std::ifstream file("/proc/thread-self/status");
  std::ostringstream text;
  text << file.rdbuf();
  const auto status = parse_thread_status(text.str());
  ASSERT_TRUE(status);
  EXPECT_TRUE(status->runs);
  EXPECT_EQ(status->blocked, 0U);
  EXPECT_FALSE(parse_thread_status(""));
  EXPECT_FALSE(parse_thread_status("State:\tR"));
}

// Of this process itself.
TEST(HostWatchOfAProcess, SeesThatAThreadBlocksItsSignals) {
  for (const int signal : {SIGSEGV, SIGTERM, SIGINT}) {
    SCOPED_TRACE(::strsignal(signal));
    HostWatch watch(::getpid());
    GuardianChannel channel;
    MonotonicClock clock;
    ASSERT_FALSE(watch.hangs(clock.now(), channel));
    sigset_t handled;
    sigemptyset(&handled);
    sigaddset(&handled, signal);
    pthread_sigmask(SIG_BLOCK, &handled, nullptr);
    bool hangs = false;
    for (int i = 0; i < 1000 && !hangs; ++i) {
      std::this_thread::sleep_for(10ms);
      hangs = watch.hangs(clock.now(), channel);
    }
    EXPECT_TRUE(hangs);
    pthread_sigmask(SIG_UNBLOCK, &handled, nullptr);
    std::this_thread::sleep_for(HostWatch::kPeriod);
    EXPECT_FALSE(watch.hangs(clock.now(), channel));
  }
}

TEST(HostWatchOfAProcess, WhatTheSystemDoesNotTellIsTakenForWell) {
  HostWatch watch(-1);
  GuardianChannel channel;
  EXPECT_FALSE(watch.hangs(MonotonicClock().now(), channel));
}

}  // namespace
}  // namespace palpate::test::test_host_watch
