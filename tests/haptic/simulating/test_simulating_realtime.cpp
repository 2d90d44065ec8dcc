// SPDX-License-Identifier: BSD-3-Clause
// Neither a step of a reduced body nor a tick that moves its tool allocates anything.
#include <gtest/gtest.h>

#include "haptic/profile/palpate_report.h"
#include "haptic/servo/loop.h"
#include "haptic/simulating/coupled_tool.h"
#include "haptic/simulating/reduced_body_loop.h"
#include "haptic/support/block_model.h"
#include "solvers/support/allocations.h"

namespace palpate::test::test_simulating_realtime {
namespace {

using namespace std::chrono_literals;

/// A board in memory that does nothing but answer. Its hand goes up and down by 6 cm, far beyond
/// what the model was trained for, and grasps for three of four seconds.
class MemoryBoard final : public Transport {
 public:
  explicit MemoryBoard(Clock& clock) : clock_(clock) {}
  TransportStatus read(Report& report, Duration) noexcept override {
    guardian_.look(clock_.now());
    const auto now = static_cast<std::uint32_t>(clock_.now() / 1us);
    if (now == last_) return TransportStatus::nothing;
    last_ = now;
    palpate_report::Input input;
    input.time_us = now;
    input.counter = static_cast<std::uint16_t>(now / 1000);
    input.position[2] = static_cast<std::int32_t>(6000 * std::sin(4e-6 * now));
    input.buttons = now / 1'000'000 % 4 > 0 ? 1 : 0;
    report = palpate_report::encode_input(input);
    return TransportStatus::data;
  }
  TransportStatus write(const Report& report) noexcept override {
    palpate_report::Output output;
    if (palpate_report::decode_output(report, output) && output.force[2] != 0) ++num_forces;
    return TransportStatus::data;
  }
  GuardianChannel* guardian() noexcept override { return &guardian_; }
  std::string problem() const override { return {}; }

  int num_forces = 0;

 private:
  Clock& clock_;
  GuardianChannel guardian_;
  std::uint32_t last_ = 0;
};

TEST(SimulatingRealtime, NeitherLoopAllocates) {
  VirtualClock clock;
  std::vector<std::shared_ptr<SimulatedTool>> tools;
  for (const Vec3& place : test::block_model().places) {
    SimulatedToolOptions options;
    options.place = place;
    tools.push_back(std::make_shared<SimulatedTool>(options));
  }
  ReducedBodyOutbox outbox;
  ReducedBodyLoop body(*test::block_model().model, tools, clock, {}, outbox);
  MemoryBoard board(clock);
  const PalpateReport profile{palpate_report::Feature{}};
  LoopInbox inbox;
  LoopOutbox of_hand;
  Loop hand(board, profile, clock, {}, inbox, of_hand);
  LoopInbox::Settings settings;
  settings.servo.workspace_centre = test::block_model().places[0];
  settings.servo.grasp_button = 0;
  inbox.settings.write(settings);
  inbox.touch.offer(std::make_shared<CoupledTool>(tools[0]));
  inbox.recording.offer(std::make_shared<TickRing>(64));
  const long before = test::num_allocations();
  ASSERT_EQ(before > 0, test::kCountsAllocations);
  static_assert(noexcept(body.step()));
  static_assert(noexcept(hand.tick()));
  for (int i = 0; i < 8000; ++i) {
    hand.tick();
    if (i % 2 == 0) {
      if (i > 0) body.wait();
      body.step();
      // Now and then somebody looks.
      if (i % 32 == 0) (void)outbox.newest.read();
    }
    hand.wait();
  }
  EXPECT_EQ(test::num_allocations(), before);
  EXPECT_GT(board.num_forces, 3000);
  const ReducedBodyCounters counters = outbox.newest.read().counters;
  EXPECT_EQ(counters.steps, 4000U);
  EXPECT_GT(counters.untrusted, 100U);
  if (!test::kCountsAllocations) GTEST_SKIP() << "allocations cannot be counted here";
}

}  // namespace
}  // namespace palpate::test::test_simulating_realtime
