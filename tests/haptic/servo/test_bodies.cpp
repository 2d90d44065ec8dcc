// SPDX-License-Identifier: BSD-3-Clause
// A space whose active nodes are on two meshes of one organ: the hand takes hold of either.
#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cmath>
#include <memory>
#include <set>
#include <thread>
#include <vector>

#include "equilibrium/equilibrium.h"
#include "exploration/precompute.h"
#include "haptic/support/moved_tool.h"
#include "haptic/support/simulated_servo.h"
#include "haptic/touching/body_touch.h"
#include "interaction/bonded_patch.h"
#include "solvers/support/block.h"

namespace palpate::test::test_bodies {
namespace {

using namespace std::chrono_literals;

constexpr BodyId kSecond = 2;

class TwoMeshes : public testing::Test {
 protected:
  TwoMeshes() {
    PrecomputeOptions options;
    options.half_width = 0.01;
    options.resolution = 7;
    const auto communicator = make_serial_communicator();
    const std::vector<BodyOfRun> bodies = {
        {std::make_shared<const Scene>(coarse_.scene), {coarse_.corner}},
        {std::make_shared<const Scene>(fine_.scene), {fine_.middle}}};
    body_ = std::make_shared<const Touchable>(precompute(bodies, options, *communicator, {}).space);
  }

  /// The place of an active node at rest, m.
  [[nodiscard]] Vec3 place(const Block& block, Index node) const {
    return block.scene.body.mesh.points[static_cast<std::size_t>(node)];
  }

  /// From a place of the surface into the block, of unit length.
  [[nodiscard]] static Vec3 inward(const Vec3& at) {
    return (Vec3(0.05, 0.03, 0.025) - at).normalized();
  }

  Block coarse_ = make_block(Law::neo_hookean, {ElementOrder::linear, {3, 2, 2}});
  Block fine_ = make_block(Law::neo_hookean, {ElementOrder::quadratic, {3, 2, 2}});
  std::shared_ptr<const Touchable> body_;
};

TEST_F(TwoMeshes, EachAnswersWithItsOwnForce) {
  ASSERT_EQ(body_->nodes().size(), 2U);
  const auto expect_held = [&](const Block& block, Index node, BodyId number) {
    SCOPED_TRACE(number);
    ASSERT_GE(body_->find(node, number), 0);
    const Vec3 at = place(block, node);
    MovedTool tool;
    const Vec3 in = inward(at);
    (void)tool.move(body_.get(), at - 0.004 * in, {});
    // It takes hold just below the surface.
    (void)tool.move(body_.get(), at + 1e-5 * in, {});
    const Vec3 t = 0.006 * in;
    const Contact contact = tool.move(body_.get(), at + t, {});
    ASSERT_EQ(contact.status, ContactStatus::attached);
    EXPECT_EQ(contact.nodes[0], node);
    EXPECT_EQ(contact.bodies[0], number);
    EXPECT_LT((contact.displacement - t).norm(), 2e-5);
    EquilibriumSolver solver(block.scene, {});
    solver.set_interaction(BondedPatches(block.scene.body, 0).around(node));
    const Equilibrium exact = solver.solve(contact.displacement, solver.rest());
    ASSERT_EQ(exact.outcome, Outcome::converged);
    EXPECT_LT((contact.force + exact.reaction).norm(), 5e-3 * exact.reaction.norm());
  };
  expect_held(coarse_, coarse_.corner, kFirstBody);
  expect_held(fine_, fine_.middle, kSecond);
}

/// Presses at one place and then at the other, some times a second.
class Alternating final : public Motion {
 public:
  /// @param in From the places into the body, of unit length.
  Alternating(const std::array<Vec3, 2>& places, const std::array<Vec3, 2>& in)
      : places_(places), in_(in) {}
  Pose advance(Time time, const Vec3& /*force*/) noexcept override {
    const double s = 3 * seconds(time);
    const auto at = static_cast<std::size_t>(s) % 2;
    Pose pose;
    pose.position = places_[at] + (0.001 - 0.004 * std::cos(2 * M_PI * s)) * in_[at];
    return pose;
  }

 private:
  std::array<Vec3, 2> places_;
  std::array<Vec3, 2> in_;
};

TEST_F(TwoMeshes, AServoTouchesOneAfterTheOther) {
  const Vec3 first = place(coarse_, coarse_.corner);
  const Vec3 second = place(fine_, fine_.middle);
  const auto servo = test::make_simulated_servo(
      std::make_shared<Alternating>(std::array<Vec3, 2>{Vec3::Zero(), second - first},
                                    std::array<Vec3, 2>{inward(first), inward(second)}),
      first);
  servo->set_touch(make_touch(body_));
  servo->start();
  std::set<BodyId> held;
  const auto end = std::chrono::steady_clock::now() + 30s;
  while (held.size() < 2 && std::chrono::steady_clock::now() < end) {
    const Contact contact = servo->latest().contact;
    if (contact.status == ContactStatus::attached) {
      held.insert(contact.bodies[0]);
      EXPECT_EQ(contact.nodes[0], contact.bodies[0] == kFirstBody ? coarse_.corner : fine_.middle);
    }
    std::this_thread::sleep_for(1ms);
  }
  EXPECT_TRUE(servo->stop());
  EXPECT_EQ(held, (std::set<BodyId>{kFirstBody, kSecond}));
  EXPECT_EQ(servo->statistics().not_finite, 0U);
}

}  // namespace
}  // namespace palpate::test::test_bodies
