// SPDX-License-Identifier: BSD-3-Clause
#include "threads/thread_team.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <atomic>
#include <chrono>
#include <new>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace palpate::test::test_thread_team {
namespace {

constexpr bool kHasThreads = PALPATE_HAS_THREADS;
constexpr Index kParts = 64;

TEST(ThreadTeam, OneThreadNeedsNone) {
  EXPECT_EQ(make_thread_team(1), nullptr);
  EXPECT_GE(automatic_threads(), 1);
}

TEST(ThreadTeam, RunsEachPartOnce) {
  for (const int threads : {0, 1, 2, 3, 4, 8}) {
    const auto team = make_thread_team(threads);
    EXPECT_EQ(team != nullptr, kHasThreads && (threads == 0 ? automatic_threads() : threads) > 1);
    for (const Index num_parts : {0, 1, 2, 5, 256}) {
      std::vector<int> runs(num_parts, 0);
      with_team(team.get(), [&] { for_each_part(num_parts, [&](Index part) { ++runs[part]; }); });
      EXPECT_EQ(runs, std::vector<int>(num_parts, 1)) << threads << " threads";
    }
  }
}

TEST(ThreadTeam, PartsRunSideBySide) {
  if (!kHasThreads) GTEST_SKIP() << "This build has no OpenMP.";
  const auto team = make_thread_team(2);
  // Each part waits for the other one.
  std::atomic<int> arrived{0};
  std::vector<std::thread::id> who(2);
  with_team(team.get(), [&] {
    for_each_part(2, [&](Index part) {
      who[part] = std::this_thread::get_id();
      ++arrived;
      while (arrived < 2) std::this_thread::yield();
    });
  });
  EXPECT_NE(who[0], who[1]);
}

TEST(ThreadTeam, ALoopInAPartIsRunToo) {
  const auto team = make_thread_team(3);
  std::atomic<int> count{0};
  with_team(team.get(),
            [&] { for_each_part(4, [&](Index) { for_each_part(5, [&](Index) { ++count; }); }); });
  EXPECT_EQ(count, 20);
}

TEST(ThreadTeam, AnExceptionOfAPartIsThrownOn) {
  for (const int threads : {1, 2, 4}) {
    const auto team = make_thread_team(threads);
    const auto run = [&](auto&& fail) {
      with_team(team.get(), [&] {
        for_each_part(kParts, [&](Index part) {
          if (part == kParts / 2) fail();
        });
      });
    };
    EXPECT_THROW(run([] { throw std::bad_alloc(); }), std::bad_alloc);
    EXPECT_THROW(run([] { throw std::runtime_error("a part has failed"); }), std::runtime_error);
    // All of them at once, and caught where the loop is.
    std::atomic<int> count{0};
    with_team(team.get(), [&] {
      EXPECT_THROW(for_each_part(kParts, [](Index) { throw std::bad_alloc(); }), std::bad_alloc);
      for_each_part(kParts, [&](Index) { ++count; });
    });
    EXPECT_EQ(count, kParts);
    EXPECT_THROW(with_team(team.get(), [] { throw std::runtime_error("outside of a loop"); }),
                 std::runtime_error);
  }
}

TEST(ThreadTeam, WorkRunsInTheThreadThatAsks) {
  const auto team = make_thread_team(2);
  const auto here = std::this_thread::get_id();
  EXPECT_EQ(with_team(team.get(), [] { return std::this_thread::get_id(); }), here);
}

TEST(ThreadTeam, HasNoneWhereTheSystemGrantsTooFew) {
  if (!kHasThreads) GTEST_SKIP() << "This build has no OpenMP.";
  // OpenMP would end the process. Each thread needs room for its stack.
  const auto in_little_room = [] {
    rlimit limit{};
    getrlimit(RLIMIT_AS, &limit);
    limit.rlim_cur = rlim_t{1} << 30;
    setrlimit(RLIMIT_AS, &limit);
    const auto team = make_thread_team(kMostThreads);
    std::atomic<int> count{0};
    with_team(team.get(), [&] { for_each_part(kMostThreads, [&](Index) { ++count; }); });
    std::exit(count == kMostThreads ? 0 : 1);
  };
  EXPECT_EXIT(in_little_room(), testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace palpate::test::test_thread_team
