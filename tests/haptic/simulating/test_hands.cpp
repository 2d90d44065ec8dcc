// SPDX-License-Identifier: BSD-3-Clause
// Two hands on a reduced body, by a virtual clock. What the boards' motors do is what counts.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <string>

#include "base/error.h"
#include "haptic/simulating/two_hands.h"
#include "solvers/support/random.h"

namespace palpate::test::test_hands {
namespace {

using namespace std::chrono_literals;
using test::pulls;
using test::rests;
using test::TwoHands;

/// Of the board, N and m.
constexpr double kForceUnit = 1e-3;
constexpr double kPositionUnit = 1e-5;

/// Where the first hand pulls to, m.
const Vec3 kPull(0.002, -0.001, 0.006);

/// The force that holds each tool when a body of which nothing moves has come to rest.
Eigen::VectorXd force_at_rest(const Eigen::VectorXd& hands, const std::vector<double>& holding,
                              const test::BlockModel& of = test::block_model()) {
  ReducedModel model = *of.model;
  model.mass.setZero();
  model.rheologies[0] = {};
  ReducedBody body(model, {});
  for (Index tool = 0; tool < 2; ++tool) body.hold(tool, holding[tool]);
  EXPECT_EQ(body.step(hands.data()).outcome, ReducedOutcome::converged);
  return body.force();
}

class Paced : public testing::TestWithParam<Duration> {};

TEST_P(Paced, TheForceIsThatOfTheBodyThroughTheCoupling) {
  ReducedBodyLoopOptions options;
  options.period = GetParam();
  SimulatedToolOptions of_tool;
  // It has no part in a force at rest.
  of_tool.coupling_damping = 0.5;
  TwoHands rig(pulls(kPull), rests(), of_tool, options);
  rig.run(3s);
  Eigen::VectorXd hands = Eigen::VectorXd::Zero(6);
  hands.head<3>() = kPull;
  const Eigen::VectorXd exact = force_at_rest(hands, {300, 0});
  EXPECT_GT(exact.head<3>().norm(), 0.3);
  // What a unit of position makes, and of force.
  EXPECT_LT((rig.hands[0]->motors() + exact.head<3>()).norm(),
            2 * (300 * kPositionUnit + kForceUnit));
  EXPECT_EQ(rig.hands[1]->motors(), Vec3::Zero());
  EXPECT_EQ(rig.hands[0]->last().contact.status, ContactStatus::attached);
  EXPECT_EQ(rig.hands[0]->last().contact.support, Support::inside);
  EXPECT_GT(rig.hands[0]->last().contact.trust, 0.1);
  EXPECT_EQ(rig.outbox.newest.read().counters.missed, 0U);
}

INSTANTIATE_TEST_SUITE_P(Hands, Paced, testing::Values(1ms, 2ms));

TEST(Hands, TheForceBeginsAtZeroWhereverTheHandTakesHold) {
  // 3 mm beside the tool.
  TwoHands rig([](Time time) {
    Motion::Pose pose;
    pose.position = Vec3(0.003, 0, 0);
    pose.buttons = time >= 50ms ? 1 : 0;
    return pose;
  });
  rig.run(300ms);
  EXPECT_EQ(rig.hands[0]->last().contact.status, ContactStatus::attached);
  EXPECT_LT(rig.hands[0]->counters().largest_force, 2 * kForceUnit);
}

// Offered anew, the same tool stays in the hand, and the energies of before count; another one is
// not held until the hand was outside of it.
TEST(Hands, ATouchOfTheSameToolGoesOn) {
  TwoHands rig(pulls(kPull));
  rig.run(250ms);
  test::Hand& hand = *rig.hands[0];
  const Tick before = hand.last();
  ASSERT_EQ(before.contact.status, ContactStatus::attached);
  ASSERT_NE(before.dissipated, 0);
  hand.inbox.touch.offer(std::make_shared<CoupledTool>(rig.tools[0]));
  rig.step();
  EXPECT_EQ(hand.last().contact.status, ContactStatus::attached);
  EXPECT_LT((hand.last().contact.force - before.contact.force).norm(), 0.1);
  EXPECT_EQ(hand.last().dissipated, before.dissipated);
  hand.inbox.touch.offer(std::make_shared<CoupledTool>(rig.tools[1]));
  rig.step();
  EXPECT_NE(hand.last().contact.status, ContactStatus::attached);
  EXPECT_EQ(hand.last().dissipated, 0);
}

TEST(Hands, UnderGravityTheBodyHangsStillUntilItIsPulled) {
  const test::BlockModel sagging =
      test::make_block_model(30000, 0.01, Law::neo_hookean, Vec3(0, 0, -9.81));
  EXPECT_LT(sagging.places[0].z(), test::block_model().places[0].z() - 2e-4);
  TwoHands rig(pulls(kPull, 500ms), rests(), {}, {}, sagging);
  rig.run(400ms);
  EXPECT_EQ(rig.hands[0]->last().contact.status, ContactStatus::attached);
  EXPECT_LT(rig.hands[0]->counters().largest_force, 2 * kForceUnit);
  // What a unit of the board's position makes is all that moves.
  EXPECT_LT(rig.outbox.newest.read().coordinates.tail<6>().lpNorm<Eigen::Infinity>(),
            2 * kPositionUnit);
  rig.run(3s);
  Eigen::VectorXd hands = Eigen::VectorXd::Zero(6);
  hands.head<3>() = kPull;
  const Eigen::VectorXd exact = force_at_rest(hands, {300, 0}, sagging);
  EXPECT_GT(exact.head<3>().norm(), 0.3);
  EXPECT_LT((rig.hands[0]->motors() + exact.head<3>()).norm(),
            2 * (300 * kPositionUnit + kForceUnit));
}

TEST(Hands, NoHandTakesHoldFromAfar) {
  TwoHands rig([](Time time) {
    Motion::Pose pose;
    pose.position = Vec3(0.012, 0, 0);
    pose.buttons = time >= 50ms ? 1 : 0;
    return pose;
  });
  rig.run(300ms);
  EXPECT_EQ(rig.hands[0]->last().contact.status, ContactStatus::free);
  EXPECT_NEAR(rig.hands[0]->last().contact.distance, 0.002, kPositionUnit);
  EXPECT_EQ(rig.hands[0]->counters().largest_force, 0);
}

TEST(Hands, WithoutAButtonTheHandHoldsWhatItHasComeTo) {
  TwoHands rig([](Time time) {
    Motion::Pose pose;
    pose.position = Vec3(0, 0, std::max(0.002, 0.015 - 0.05 * seconds(time)));
    return pose;
  });
  rig.hands[0]->settings.servo.grasp_button = -1;
  rig.hands[0]->inbox.settings.write(rig.hands[0]->settings);
  rig.run(90ms);
  EXPECT_EQ(rig.hands[0]->last().contact.status, ContactStatus::free);
  rig.run(500ms);
  EXPECT_EQ(rig.hands[0]->last().contact.status, ContactStatus::attached);
  // It came to 1 cm, and has gone on by 8 mm: the body pushes back.
  EXPECT_GT(rig.hands[0]->motors()[2], 0.3);
}

TEST(Hands, TwoHandsFeelEachOther) {
  TwoHands rig(pulls(Vec3(0, 0, 0.008), 400ms), pulls(Vec3::Zero()));
  rig.run(390ms);
  EXPECT_LT(rig.hands[1]->motors().norm(), 2 * kForceUnit);
  rig.run(2s);
  Eigen::VectorXd hands = Eigen::VectorXd::Zero(6);
  hands[2] = 0.008;
  const Eigen::VectorXd exact = force_at_rest(hands, {300, 300});
  // The second hand stands still, and is drawn along.
  EXPECT_GT(rig.hands[1]->motors()[2], 0.05);
  EXPECT_LT((rig.hands[1]->motors() + exact.tail<3>()).norm(),
            2 * (300 * kPositionUnit + kForceUnit));
}

TEST(Hands, LettingGoEndsTheForceAtOnceAndTheBodyWobblesBack) {
  TwoHands rig(pulls(Vec3(0, 0, 0.008), 100ms, 50ms, 1000ms));
  rig.run(1000ms);
  ASSERT_LT(rig.hands[0]->motors()[2], -0.3);
  const double height = rig.tool(0)[2];
  ASSERT_GT(height, 0.004);
  rig.step();
  EXPECT_EQ(rig.hands[0]->motors(), Vec3::Zero());
  rig.run(5ms);
  const ReducedState let_go = rig.loop->body().state();
  double lowest = 0;
  for (int i = 0; i < 4000; ++i) {
    rig.step();
    ASSERT_EQ(rig.hands[0]->motors(), Vec3::Zero());
    const ReducedState& state = rig.loop->body().state();
    ASSERT_LE(state.kinetic + state.elastic, (let_go.kinetic + let_go.elastic) * (1 + 1e-6));
    lowest = std::min(lowest, rig.tool(0)[2]);
  }
  EXPECT_EQ(rig.loop->body().state().work, let_go.work);
  EXPECT_LT(lowest, -0.2 * height);
  EXPECT_LT(rig.tool(0).norm(), 0.02 * height);
}

TEST(Hands, ABodyThatStandsStillIsLetGo) {
  TwoHands rig(pulls(kPull, 100ms, 50ms, 2000ms));
  rig.run(500ms);
  ASSERT_GT(rig.hands[0]->motors().norm(), 0.3);
  // Before the body began.
  const std::uint64_t trips = rig.hands[0]->counters().trips_by_body;
  rig.body_goes_on = false;
  rig.run(19ms);
  EXPECT_GT(rig.hands[0]->motors().norm(), 0.3);
  rig.run(4ms);
  EXPECT_EQ(rig.hands[0]->motors(), Vec3::Zero());
  EXPECT_EQ(rig.hands[0]->last().state, ServoState::tripped);
  EXPECT_EQ(rig.hands[0]->last().tripped, trips::body);
  EXPECT_EQ(words_for(trips::body), "the body was not stepped in time");
  // When it goes on the force does not come back where the hand is.
  rig.body_goes_on = true;
  rig.run(1s);
  EXPECT_EQ(rig.hands[0]->motors(), Vec3::Zero());
  EXPECT_EQ(rig.hands[0]->last().tripped, trips::body);
  EXPECT_EQ(rig.hands[0]->counters().trips_by_body, trips + 1);
  // Only when the button was let go.
  rig.run(600ms);
  EXPECT_EQ(rig.hands[0]->last().state, ServoState::running);
}

TEST(Hands, AHandWhoseLoopHasEndedHoldsTheBodyNoMore) {
  TwoHands rig(pulls(Vec3(0, 0, 0.008)));
  rig.run(600ms);
  const double height = rig.tool(0)[2];
  ASSERT_GT(height, 0.004);
  double lowest = height;
  for (int i = 0; i < 1000; ++i) {
    rig.hands[1]->loop->tick();
    rig.loop->step();
    rig.clock->advance(2ms);
    lowest = std::min(lowest, rig.tool(0)[2]);
  }
  EXPECT_LT(lowest, -0.2 * height);
  EXPECT_LT(rig.tool(0).norm(), 0.05 * height);
}

TEST(Hands, WhereForcesAreNotPermittedTheBodyIsLetGoToo) {
  TwoHands rig(pulls(kPull));
  rig.run(500ms);
  ASSERT_GT(rig.hands[0]->motors().norm(), 0.3);
  rig.hands[0]->settings.servo.engaged = false;
  rig.hands[0]->inbox.settings.write(rig.hands[0]->settings);
  rig.run(4ms);
  EXPECT_EQ(rig.hands[0]->motors(), Vec3::Zero());
  EXPECT_EQ(rig.loop->body().force(), Eigen::VectorXd::Zero(6));
}

TEST(Hands, TheSamplingOfTheCouplingIsAllThatMakesEnergy) {
  TwoHands rig([](Time time) {
    Motion::Pose pose;
    pose.position = 0.006 * std::sin(9 * seconds(time)) * Vec3(1, 0, 1);
    pose.buttons = time >= 50ms ? 1 : 0;
    return pose;
  });
  rig.hands[0]->settings.servo.passivity_control = false;
  rig.hands[0]->inbox.settings.write(rig.hands[0]->settings);
  double squares = 0;
  Vec3 before = Vec3::Zero();
  for (int i = 0; i < 3000; ++i) {
    rig.step();
    const Vec3& position = rig.hands[0]->last().position;
    if (i > 0) squares += (position - before).squaredNorm();
    before = position;
  }
  // ½ c Δp² in each tick, and c Δp Δd as the body knows the hand of up to two ticks ago; it moves
  // no more than the hand does.
  const double made = -rig.hands[0]->counters().least_dissipated;
  EXPECT_GT(made, 0.1 * 300 * squares);
  EXPECT_LT(made, 2.5 * 300 * squares);
}

TEST(Hands, StepsThatTakeTooLongAreCounted) {
  // Each look at it takes 3 ms.
  class SlowClock final : public Clock {
   public:
    Time now() noexcept override { return now_ += 3ms; }
    void sleep_until(Time time) noexcept override {
      least_rest = std::min(least_rest, time - now_);
      now_ = std::max(now_, time);
    }

    Duration least_rest = 1s;

   private:
    Time now_{0};
  };
  SlowClock clock;
  ReducedBodyOutbox outbox;
  ReducedBodyLoop body(*test::block_model().model, {nullptr, nullptr}, clock, {}, outbox);
  for (int i = 0; i < 10; ++i) {
    body.step();
    body.wait();
  }
  const ReducedBodyCounters counters = outbox.newest.read().counters;
  EXPECT_EQ(counters.too_long, 10U);
  EXPECT_GE(counters.missed, 9U);
  EXPECT_EQ(outbox.step_time.percentiles().largest, 3ms);
  // With real-time priority nothing else would run on its processor.
  EXPECT_GE(clock.least_rest, 200us) << "they leave time to others";
}

TEST(Hands, AnAnswerThatIsNoNumberGivesNoForce) {
  TwoHands rig(pulls(kPull));
  rig.run(500ms);
  ASSERT_GT(rig.hands[0]->motors().norm(), 0.3);
  rig.body_goes_on = false;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const int part : {0, 1, 2}) {
    ToolAnswer answer;
    answer.time = rig.clock->now();
    answer.step = 2ms;
    answer.displacement = part == 0 ? Vec3(0, nan, 0) : Vec3(kPull / 2);
    if (part == 1) answer.velocity[2] = nan;
    if (part == 2) answer.displacement[0] = std::numeric_limits<double>::infinity();
    rig.tools[0]->answer.write(answer);
    rig.run(2ms);
    EXPECT_EQ(rig.hands[0]->motors(), Vec3::Zero()) << part;
    EXPECT_NE(rig.hands[0]->last().limited & limits::not_finite, 0U) << part;
  }
}

TEST(Hands, AHandThatIsNoNumberIsLetGoByTheBody) {
  TwoHands rig(pulls(Vec3::Zero()));
  rig.run(200ms);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  rig.tools[0]->command.write({rig.clock->now(), true, Vec3(nan, 0, 0)});
  rig.loop->step();
  EXPECT_TRUE(rig.loop->body().coordinates().allFinite());
  EXPECT_EQ(rig.loop->body().force(), Eigen::VectorXd::Zero(6));
}

TEST(Hands, TheyAreToldWhereTheModelIsNotToBeTrusted) {
  // Trained as far as 1 cm.
  TwoHands rig(pulls(Vec3(0, 0, 0.035), 100ms, 50ms, 1500ms));
  rig.run(1200ms);
  const Tick& tick = rig.hands[0]->last();
  EXPECT_GT(tick.contact.trust, kLargestTrusted);
  EXPECT_EQ(tick.contact.support, Support::extrapolated);
  EXPECT_GT(rig.hands[0]->counters().untrusted_ticks, 100U);
  EXPECT_GT(rig.outbox.newest.read().counters.untrusted, 100U);
  // Back inside it is trusted again.
  rig.run(4s);
  EXPECT_LT(rig.hands[0]->last().contact.trust, 0.2);
}

struct Dance {
  const char* name;
  Law law;
  double coupling;
  /// The body stands still beyond it.
  double largest_trust;
};

class Far : public testing::TestWithParam<Dance> {};

// PALPATE_DANCE_SECONDS=600 lets it last for ten minutes.
TEST_P(Far, ARandomDanceFarBeyondTrainingIsBoundedAndMakesNoEnergy) {
  test::Random random(11);
  // Waves of up to 3 Hz and 6 cm at a block of 10 cm, and grasps of a second or so.
  const auto dance = [&](double phase) {
    const Eigen::VectorXd a = random.vector(12, 1);
    return [a, phase](Time time) {
      const double t = seconds(time);
      Motion::Pose pose;
      for (int k = 0; k < 3; ++k) {
        pose.position[k] = 0.03 * (std::sin(2 * M_PI * (0.9 + 0.3 * a[k]) * t + 7 * a[3 + k]) +
                                   std::sin(2 * M_PI * (2 + a[6 + k]) * t + 7 * a[9 + k]));
      }
      pose.buttons = std::sin(2 * M_PI * 0.4 * t + phase) > -0.6 ? 1 : 0;
      return pose;
    };
  };
  const char* length = std::getenv("PALPATE_DANCE_SECONDS");
  const double duration = length != nullptr ? std::stod(length) : 20;
  SimulatedToolOptions of_tool;
  of_tool.coupling_stiffness = GetParam().coupling;
  ReducedBodyLoopOptions options;
  options.body.largest_trust = GetParam().largest_trust;
  TwoHands rig(dance(0), dance(2), of_tool, options,
               test::make_block_model(30000, 0.01, GetParam().law));
  for (const auto& hand : rig.hands) {
    hand->inbox.settings.write([&] {
      hand->settings.servo.force_limit = 3;
      return hand->settings;
    }());
  }
  double largest_trust = 0;
  double most_lost = 0;
  double gain = 0;
  double largest_energy = 0;
  // While nobody holds it.
  bool was_free = false;
  int num_free = 0;
  double when_let_go = 0;
  double growth = 0;
  int held[2] = {0, 0};
  const auto num_ticks = static_cast<int>(1000 * duration);
  for (int i = 0; i < num_ticks; ++i) {
    rig.step();
    for (int h = 0; h < 2; ++h) {
      const Vec3 motors = rig.hands[h]->motors();
      ASSERT_TRUE(motors.allFinite());
      ASSERT_LE(motors.norm(), 3 + 2 * kForceUnit);
      ASSERT_TRUE(rig.hands[h]->last().contact.force.allFinite());
      if (touches(rig.hands[h]->last().contact.status)) ++held[h];
    }
    ASSERT_TRUE(rig.loop->body().coordinates().allFinite());
    const ReducedState& state = rig.loop->body().state();
    largest_trust = std::max(largest_trust, state.trust);
    const double energy = state.kinetic + state.elastic + state.viscous_stored + state.dissipated;
    const double mechanical = state.kinetic + state.elastic + state.viscous_stored;
    largest_energy = std::max(largest_energy, mechanical);
    if (rig.loop->body().force().isZero(0)) {
      ++num_free;
      if (was_free) growth = std::max(growth, mechanical - when_let_go);
      if (!was_free) when_let_go = mechanical;
      was_free = true;
    } else {
      was_free = false;
    }
    // What the method has lost: that the body gains nothing means that this never falls.
    const double lost = state.work - energy;
    gain = std::max(gain, most_lost - lost);
    most_lost = std::max(most_lost, lost);
  }
  EXPECT_GT(held[0], num_ticks / 10);
  EXPECT_GT(held[1], num_ticks / 10);
  EXPECT_GT(largest_trust, kLargestTrusted);
  const std::uint64_t beyond = rig.outbox.newest.read().counters.beyond_training;
  if (GetParam().largest_trust < 8) {
    EXPECT_GT(beyond, 0U);
  }
  // Where nobody holds the body there is no work at all.
  EXPECT_GT(num_free, 100);
  EXPECT_LT(growth, 1e-9 * largest_energy);
  // Else to what the trapezoidal rule of the work misses where hands take hold, let go, or meet a
  // body again that stood still.
  EXPECT_LT(gain, 0.02 * largest_energy);
  EXPECT_GT(most_lost, 0);
  // And it comes back when nobody holds it.
  for (const auto& hand : rig.hands) hand->inbox.touch.offer(nullptr);
  rig.run(5s);
  EXPECT_LT(rig.loop->body().state().trust, 0.05);
  EXPECT_EQ(rig.loop->body().state().outcome, ReducedOutcome::converged);
}

INSTANTIATE_TEST_SUITE_P(Hands, Far,
                         testing::Values(Dance{"NeoHookean", Law::neo_hookean, 300, 8},
                                         Dance{"Fung", Law::fung, 300, 8},
                                         Dance{"StiffCoupling", Law::neo_hookean, 3000, 8},
                                         Dance{"StandingStill", Law::neo_hookean, 3000, 2.5}),
                         [](const auto& of) { return std::string(of.param.name); });

TEST(Hands, TheirOptionsAreChecked) {
  const auto message = [](const auto& change) {
    SimulatedToolOptions options;
    change(options);
    try {
      validate(options);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  using O = SimulatedToolOptions;
  EXPECT_EQ(message([](O&) {}), "");
  EXPECT_NE(message([](O& o) { o.place[0] = std::nan(""); }).find("place"), std::string::npos);
  EXPECT_NE(message([](O& o) { o.reach = 0; }).find("reach"), std::string::npos);
  EXPECT_NE(message([](O& o) { o.coupling_stiffness = 0; }).find("stiffness"), std::string::npos);
  EXPECT_NE(message([](O& o) { o.coupling_damping = -1; }).find("damping"), std::string::npos);
  EXPECT_NE(message([](O& o) { o.release_after = 0ms; }).find("time"), std::string::npos);
  ReducedBodyLoopOptions options;
  options.period = 0ms;
  EXPECT_THROW(validate(options), InputError);
  options = {};
  options.release_after = 0ms;
  EXPECT_THROW(validate(options), InputError);
  VirtualClock clock;
  ReducedBodyOutbox outbox;
  EXPECT_THROW(ReducedBodyLoop(*test::block_model().model, {}, clock, {}, outbox), InputError);
}

}  // namespace
}  // namespace palpate::test::test_hands
