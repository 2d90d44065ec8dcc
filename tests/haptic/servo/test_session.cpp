// SPDX-License-Identifier: BSD-3-Clause
// How old a report is, from a device that tells its time and from one that does not.
#include <gtest/gtest.h>

#include <deque>

#include "haptic/profile/palpate_report.h"
#include "haptic/servo/session.h"

namespace palpate::test::test_session {
namespace {

using namespace std::chrono_literals;

/// Gives what it is given.
class Queue final : public Transport {
 public:
  TransportStatus read(Report& report, Duration /*timeout*/) noexcept override {
    if (reports.empty()) return TransportStatus::nothing;
    report = reports.front();
    reports.pop_front();
    return TransportStatus::data;
  }
  TransportStatus write(const Report& report) noexcept override {
    written.push_back(report);
    return TransportStatus::data;
  }
  std::string problem() const override { return {}; }

  std::deque<Report> reports;
  std::vector<Report> written;
};

/// Reports of a counter, and of nothing else.
class CounterProfile final : public Profile {
 public:
  explicit CounterProfile(Pacing pacing) : Profile(specification_of(pacing)) {}
  bool decode(const Report& report, DeviceState& state) const noexcept override {
    state.counter = report.data[0];
    return report.size == 1;
  }
  Report zero_force(const DeviceState& /*state*/) const noexcept override { return {{0}, 1}; }

 private:
  static Specification specification_of(Pacing pacing) {
    Specification specification;
    specification.pacing = pacing;
    specification.max_linear_force = 1;
    return specification;
  }
  Report do_encode(const Vec3& /*force*/, const DeviceState& /*state*/) const noexcept override {
    return {{1}, 1};
  }
};

class Session : public testing::Test {
 protected:
  void report_at(std::uint32_t device_us) {
    palpate_report::Input input;
    input.time_us = device_us;
    input.counter = counter_++;
    queue_.reports.push_back(palpate_report::encode_input(input));
  }
  /// A millisecond after the last one.
  void poll() {
    clock_.advance(1ms);
    session_.poll();
  }

  Queue queue_;
  VirtualClock clock_;
  PalpateReport profile_{palpate_report::Feature{}};
  DeviceSession session_{queue_, profile_, clock_, ServoOptions{}};
  std::uint16_t counter_ = 0;
};

TEST_F(Session, WhatWaitedAtOpenIsNotBelieved) {
  report_at(0);
  poll();
  EXPECT_FALSE(session_.fresh());
  EXPECT_FALSE(session_.known());
  report_at(1000);
  poll();
  EXPECT_TRUE(session_.fresh());
}

TEST_F(Session, AgeByTheDevicesTime) {
  poll();
  for (std::uint32_t t = 0; t < 50; ++t) {
    report_at(1000 * t);
    poll();
    EXPECT_EQ(session_.age(), 0ms);
  }
  for (int late = 1; late <= 5; ++late) {
    poll();
    EXPECT_EQ(session_.age(), late * 1ms);
    EXPECT_TRUE(session_.fresh());
  }
  poll();
  EXPECT_FALSE(session_.fresh());
  std::uint32_t limited = 0;
  EXPECT_EQ(session_.send(Vec3(1, 0, 0), 5, 5, limited), Vec3::Zero());
  EXPECT_EQ(queue_.written.back(), profile_.zero_force(session_.state()));
  // What comes now was measured then.
  report_at(50000);
  poll();
  EXPECT_GE(session_.age(), 5ms);
  EXPECT_FALSE(session_.fresh());
  report_at(56000);
  poll();
  EXPECT_TRUE(session_.fresh());
}

TEST_F(Session, ADeviceThatRestartsIsBelievedAgain) {
  poll();
  for (std::uint32_t t = 0; t < 200; ++t) {
    report_at(5'000'000 + 1000 * t);
    poll();
  }
  ASSERT_TRUE(session_.fresh());
  int until_fresh = 0;
  for (std::uint32_t t = 0; t < 300 && until_fresh == 0; ++t) {
    report_at(1000 * t);
    poll();
    if (session_.fresh()) until_fresh = static_cast<int>(t);
  }
  EXPECT_GT(until_fresh, 90);
  EXPECT_LT(until_fresh, 120);
}

TEST_F(Session, AReportThatComesAgainAndAgainIsNot) {
  poll();
  for (std::uint32_t t = 0; t < 200; ++t) {
    report_at(1000 * t);
    poll();
  }
  ASSERT_TRUE(session_.fresh());
  int fresh = 0;
  for (int i = 0; i < 1000; ++i) {
    report_at(199'000);
    poll();
    if (session_.fresh()) ++fresh;
  }
  EXPECT_LE(fresh, 5);
}

TEST_F(Session, ReportsThatAreHeldUpDoNotBecomeFresh) {
  poll();
  for (std::uint32_t t = 0; t < 200; ++t) {
    report_at(1000 * t);
    poll();
  }
  ASSERT_TRUE(session_.fresh());
  // From now on each takes 20 ms longer.
  for (int i = 0; i < 20; ++i) poll();
  for (std::uint32_t t = 200; t < 2200; ++t) {
    report_at(1000 * t);
    poll();
    ASSERT_FALSE(session_.fresh()) << t;
  }
}

TEST_F(Session, AClockIsNotLearntFromAReportThatMayHaveWaited) {
  session_.poll();
  report_at(0);
  clock_.advance(1s);
  session_.poll();
  EXPECT_FALSE(session_.fresh());
  report_at(1'001'000);
  poll();
  EXPECT_TRUE(session_.fresh());
}

TEST_F(Session, LostReportsAreCountedAcrossTheWrap) {
  poll();
  counter_ = 65530;
  for (std::uint32_t t = 0; t < 20; ++t) {
    report_at(1000 * t);
    if (t == 10) counter_ = static_cast<std::uint16_t>(counter_ + 3);
    poll();
  }
  Counters counters;
  session_.count(counters);
  EXPECT_EQ(counters.lost_reports, 3U);
  EXPECT_EQ(counters.reports, 20U);
}

TEST(SessionWithoutDeviceTime, OldAsTheQueueWasLastEmpty) {
  Queue queue;
  VirtualClock clock;
  const CounterProfile profile(Pacing::free_running);
  DeviceSession session(queue, profile, clock, ServoOptions{});
  const auto poll = [&](int reports) {
    clock.advance(1ms);
    for (int i = 0; i < reports; ++i) queue.reports.push_back({{7}, 1});
    session.poll();
  };
  poll(1);
  EXPECT_FALSE(session.fresh());
  poll(1);
  EXPECT_TRUE(session.fresh());
  EXPECT_EQ(session.age(), 1ms);
  // The host pauses; what the queue has kept is of any time since.
  clock.advance(200ms);
  poll(63);
  EXPECT_EQ(session.num_received(), 63);
  EXPECT_GT(session.age(), 200ms);
  EXPECT_FALSE(session.fresh());
  poll(1);
  EXPECT_TRUE(session.fresh());
}

TEST(SessionWithoutDeviceTime, ADeviceThatNeverFallsSilentDoesNotHoldTheLoop) {
  class Flood final : public Transport {
   public:
    TransportStatus read(Report& report, Duration) noexcept override {
      report = {{1}, 1};
      return TransportStatus::data;
    }
    TransportStatus write(const Report&) noexcept override { return TransportStatus::data; }
    std::string problem() const override { return {}; }
  };
  Flood flood;
  VirtualClock clock;
  const CounterProfile profile(Pacing::free_running);
  DeviceSession session(flood, profile, clock, ServoOptions{});
  for (int i = 0; i < 10; ++i) {
    clock.advance(1ms);
    session.poll();
    EXPECT_FALSE(session.fresh()) << "how old these are nobody knows";
  }
}

TEST(SessionOnChange, SilenceMeansThatNothingChanges) {
  Queue queue;
  VirtualClock clock;
  const CounterProfile profile(Pacing::on_change);
  DeviceSession session(queue, profile, clock, ServoOptions{});
  session.poll();
  EXPECT_FALSE(session.fresh());
  queue.reports.push_back({{7}, 1});
  session.poll();
  clock.advance(10s);
  session.poll();
  EXPECT_TRUE(session.fresh());
}

}  // namespace
}  // namespace palpate::test::test_session
