// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <memory>
#include <thread>

#include "haptic/realtime/clock.h"
#include "haptic/realtime/handover.h"
#include "haptic/realtime/histogram.h"
#include "haptic/realtime/memory_lock.h"
#include "haptic/realtime/ring.h"
#include "haptic/realtime/triple_buffer.h"
#include "haptic/support/locked_memory.h"

namespace palpate::test::test_realtime {
namespace {

using namespace std::chrono_literals;

constexpr int kValues = 200000;

/// Torn if its parts differ.
struct Large {
  std::array<int, 32> parts{};
  explicit Large(int value = 0) { parts.fill(value); }
  [[nodiscard]] bool whole() const {
    for (int part : parts) {
      if (part != parts[0]) return false;
    }
    return true;
  }
};

TEST(TripleBuffer, TheNewestWholeValue) {
  TripleBuffer<Large> buffer;
  EXPECT_EQ(buffer.read().parts[0], 0);
  std::thread writer([&] {
    for (int i = 1; i <= kValues; ++i) buffer.write(Large(i));
  });
  int last = 0;
  while (last < kValues) {
    const Large& value = buffer.read();
    ASSERT_TRUE(value.whole());
    ASSERT_GE(value.parts[0], last);
    last = value.parts[0];
  }
  writer.join();
  EXPECT_EQ(buffer.read().parts[0], kValues);
}

TEST(Ring, AllInOrderOrCounted) {
  Ring<Large> ring(64);
  std::atomic<bool> done{false};
  std::thread writer([&] {
    for (int i = 1; i <= kValues; ++i) ring.push(Large(i));
    done = true;
  });
  int last = 0;
  int popped = 0;
  Large value;
  for (bool ended = false; !ended;) {
    ended = done;
    while (ring.pop(value)) {
      ASSERT_TRUE(value.whole());
      ASSERT_GT(value.parts[0], last);
      last = value.parts[0];
      ++popped;
    }
  }
  writer.join();
  EXPECT_EQ(static_cast<std::uint64_t>(popped) + ring.dropped(), std::uint64_t{kValues});
}

TEST(Ring, KeepsTheOldest) {
  Ring<int> ring(4);
  for (int i = 1; i <= 6; ++i) ring.push(i);
  EXPECT_EQ(ring.dropped(), 2U);
  int value = 0;
  for (int i = 1; i <= 4; ++i) {
    ASSERT_TRUE(ring.pop(value));
    EXPECT_EQ(value, i);
  }
  EXPECT_FALSE(ring.pop(value));
}

/// Counts the living, and in which thread they die.
class Counted {
 public:
  Counted(int number, std::thread::id owner) : number_(number), owner_(owner) { ++living; }
  ~Counted() {
    --living;
    if (std::this_thread::get_id() != owner_) died_elsewhere = true;
  }
  Counted(const Counted&) = delete;
  Counted& operator=(const Counted&) = delete;
  [[nodiscard]] int number() const { return number_; }

  static inline std::atomic<int> living{0};
  static inline std::atomic<bool> died_elsewhere{false};

 private:
  int number_;
  std::thread::id owner_;
};

TEST(Handover, TheTakerFreesNothing) {
  {
    Handover<const Counted> handover;
    EXPECT_EQ(handover.take(), nullptr);
    std::atomic<bool> stop{false};
    std::atomic<int> newest{0};
    std::thread taker([&] {
      const Counted* before = nullptr;
      while (!stop) {
        const Counted* value = handover.take();
        if (value == nullptr) continue;
        // As a tool reads the body that it lets go of.
        if (before != nullptr) {
          ASSERT_GE(value->number(), before->number());
        }
        before = value;
        newest = value->number();
      }
    });
    for (int i = 1; i <= 20000; ++i) {
      handover.offer(std::make_shared<const Counted>(i, std::this_thread::get_id()));
      ASSERT_LE(Counted::living, 5) << "a new one, and one in each of four places";
    }
    // The last one is taken once there is a place for the one before it.
    while (newest != 20000) handover.collect();
    stop = true;
    taker.join();
  }
  EXPECT_EQ(Counted::living, 0);
  EXPECT_FALSE(Counted::died_elsewhere);
}

// What is taken over is read from the one before.
TEST(Handover, TheOneBeforeLivesUntilTheNextIsTaken) {
  Handover<const int> handover;
  std::array<std::weak_ptr<const int>, 3> values;
  for (int i = 0; i < 3; ++i) {
    const auto value = std::make_shared<const int>(i);
    values[static_cast<std::size_t>(i)] = value;
    handover.offer(value);
    ASSERT_EQ(*handover.take(), i);
    handover.collect();
    if (i > 0) {
      EXPECT_FALSE(values[static_cast<std::size_t>(i) - 1].expired()) << i;
    }
  }
  ASSERT_EQ(*handover.take(), 2);
  handover.collect();
  EXPECT_TRUE(values[0].expired());
  EXPECT_TRUE(values[1].expired());
  EXPECT_FALSE(values[2].expired());
}

#ifdef PALPATE_LOCKS_MEMORY
TEST(MemoryLock, WhatItNamesAndNothingElse) {
  const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  char* const pages = static_cast<char*>(
      mmap(nullptr, 16 * page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0));
  ASSERT_NE(static_cast<void*>(pages), MAP_FAILED);
  const std::size_t before = test::locked_memory();
  {
    // Of the second page its end, all of the third, of the fourth a byte; and the tenth.
    MemoryLock lock({{pages + 2 * page - 1, page + 2}, {pages + 9 * page, page}, {pages, 0}});
    EXPECT_TRUE(lock.complete());
    EXPECT_EQ(test::locked_memory(), before + 4 * page);
    auto other = std::make_unique<MemoryLock>(
        MemoryRanges{{pages + 3 * page, 2 * page}, {pages + 3 * page, 1}});
    EXPECT_EQ(test::locked_memory(), before + 5 * page);
    other.reset();
    EXPECT_EQ(test::locked_memory(), before + 4 * page) << "the page that both had stays";
  }
  EXPECT_EQ(test::locked_memory(), before);
  munmap(pages, 16 * page);
}

TEST(MemoryLock, SaysWhereItCannot) {
  const MemoryLock lock({{nullptr, 1}});
  EXPECT_FALSE(lock.complete());
}
#endif

TEST(DurationHistogram, PercentilesAreAtMostASixteenthTooLarge) {
  DurationHistogram histogram;
  EXPECT_EQ(histogram.percentiles().largest.count(), 0);
  for (int i = 1; i <= 100000; ++i) histogram.add(std::chrono::nanoseconds(37 * i));
  const Percentiles p = histogram.percentiles();
  const auto close = [](Duration found, double exact) {
    EXPECT_GE(static_cast<double>(found.count()), exact);
    EXPECT_LE(static_cast<double>(found.count()), exact * 17 / 16 + 1);
  };
  close(p.median, 37 * 50000);
  close(p.p99, 37 * 99000);
  close(p.p999, 37 * 99900);
  EXPECT_EQ(p.largest.count(), 37 * 100000);
}

TEST(DurationHistogram, AnyDuration) {
  DurationHistogram histogram;
  histogram.add(-5ns);
  EXPECT_EQ(histogram.percentiles().largest, 0ns);
  for (int shift = 0; shift < 63; ++shift) histogram.add(Duration(std::int64_t{1} << shift));
  EXPECT_EQ(histogram.percentiles().largest.count(), std::int64_t{1} << 62);
  EXPECT_LE(histogram.percentiles().median.count(), std::int64_t{1} << 33);
}

TEST(Clock, MonotonicClockSleepsUntil) {
  MonotonicClock clock;
  const Time until = clock.now() + 3ms;
  clock.sleep_until(until);
  EXPECT_GE(clock.now(), until);
  const Time before = clock.now();
  clock.sleep_until(before - 1s);
  EXPECT_LT(clock.now() - before, 1s);
}

}  // namespace
}  // namespace palpate::test::test_realtime
