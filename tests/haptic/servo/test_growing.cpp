// SPDX-License-Identifier: BSD-3-Clause
// A space that grows under the hand: an exploration is steered to where the hand is, and each chunk
// of what it finds is given to a servo loop that runs meanwhile.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <memory>
#include <optional>
#include <thread>
#include <vector>

#include "exploration/precompute.h"
#include "haptic/support/simulated_servo.h"
#include "haptic/touching/body_touch.h"
#include "solvers/support/block.h"
#include "state_space/shown_surface.h"

namespace palpate::test::test_growing {
namespace {

using namespace std::chrono_literals;

/// Down and up again, some times a second, within the box of the space.
class Pumping final : public Motion {
 public:
  Pose advance(Time time, const Vec3& /*force*/) noexcept override {
    Pose pose;
    const double s = seconds(time);
    pose.position = Vec3(0.002 * std::sin(3 * s), 0, -0.003 - 0.004 * std::cos(20 * s));
    return pose;
  }
};

struct Growing {
  Block block = make_block(Law::neo_hookean, {ElementOrder::linear});
  PrecomputeOptions options;
  std::unique_ptr<Communicator> communicator = make_serial_communicator();

  Growing() {
    options.active_nodes = {block.middle, block.corner};
    options.half_width = 0.01;
    options.resolution = 7;
  }

  [[nodiscard]] Vec3 place() const {
    return block.scene.body.mesh.points[static_cast<std::size_t>(block.middle)];
  }
  [[nodiscard]] TouchSpace empty() const {
    const std::vector<SpaceBody> bodies = {make_space_body(block.scene)};
    return make_empty_touch_space(ShownSurface(bodies));
  }
  [[nodiscard]] TouchSpace whole() const {
    return precompute(block.scene, options, *communicator, {}).space;
  }
};

/// The forces of two bodies are equal to the bit.
void expect_same_forces(const Touchable& a, const Touchable& b, double half_width) {
  ASSERT_EQ(a.nodes().size(), b.nodes().size());
  EXPECT_EQ(a.largest_stiffness(), b.largest_stiffness());
  for (std::size_t n = 0; n < a.nodes().size(); ++n) {
    EXPECT_EQ(a.nodes()[n].mesh_point, b.nodes()[n].mesh_point);
    for (int i = 0; i < 1000; ++i) {
      // Some lie outside of the box.
      const Vec3 t = 1.2 * half_width * Vec3(std::sin(i), std::sin(2.3 * i), std::cos(1.7 * i));
      const TouchResult of_a = a.nodes()[n].on_branch[0]->evaluate(t);
      const TouchResult of_b = b.nodes()[n].on_branch[0]->evaluate(t);
      EXPECT_EQ(of_a.force, of_b.force);
      EXPECT_EQ(of_a.stiffness, of_b.stiffness);
      EXPECT_EQ(of_a.energy, of_b.energy);
      EXPECT_EQ(of_a.support, of_b.support);
    }
  }
}

TEST(Growing, AServoTouchesASpaceThatIsSteeredByTheHand) {
  Growing growing;
  const auto servo = test::make_simulated_servo(std::make_shared<Pumping>(), growing.place());
  TouchSpace space = growing.empty();
  std::shared_ptr<const Touchable> body;
  int num_bodies = 0;
  const TakeChunk take_chunk = [&](const SpaceChunk& chunk) {
    take(chunk, space);
    body = body == nullptr ? std::make_shared<const Touchable>(space)
                           : std::make_shared<const Touchable>(*body, space, chunk);
    ++num_bodies;
    servo->set_touch(make_touch(body));
  };
  const auto session = begin_exploration(
      {{std::make_shared<const Scene>(growing.block.scene), growing.options.active_nodes}},
      growing.options, *growing.communicator, {}, take_chunk);
  servo->start();
  const auto steer_to_hand = [&] {
    const Vec3 hand = servo->latest().position - growing.place();
    session->steer({{{{growing.block.middle}, {hand}, {}}, {{growing.block.corner}, {}, {}}}});
  };
  const auto after_ten = [first = std::int64_t{-1}](const ProgressState& state) mutable {
    first = first < 0 ? state.num_solved : first;
    return state.num_solved >= first + 10;
  };
  do {
    steer_to_hand();
  } while (session->run(after_ten) == ExplorationSession::State::paused);
  EXPECT_EQ(session->state(), ExplorationSession::State::complete);
  EXPECT_GT(num_bodies, 20);

  // The loop goes on with the whole space.
  const std::uint64_t ticks = servo->statistics().ticks;
  while (servo->statistics().ticks < ticks + 10) std::this_thread::sleep_for(1ms);
  EXPECT_TRUE(servo->stop());
  const Statistics statistics = servo->statistics();
  EXPECT_EQ(statistics.not_finite, 0u);
  EXPECT_EQ(statistics.trips_by_body, 0u);
  EXPECT_EQ(statistics.bad_reports, 0u);

  const TouchSpace whole = growing.whole();
  expect_same_forces(*body, Touchable(whole), growing.options.half_width);
}

TEST(Growing, ABodySharesWhatAChunkLeavesAsItWas) {
  Growing growing;
  TouchSpace space = growing.empty();
  std::vector<SpaceChunk> chunks;
  const auto session = begin_exploration(
      {{std::make_shared<const Scene>(growing.block.scene), growing.options.active_nodes}},
      growing.options, *growing.communicator, {},
      [&](const SpaceChunk& chunk) { chunks.push_back(chunk); });
  // One node after the other.
  session->steer({{{{growing.block.middle}, {Vec3::Zero()}, {}}}});
  EXPECT_EQ(session->run(), ExplorationSession::State::complete);
  ASSERT_EQ(chunks.size(), 3u);
  std::optional<Touchable> body;
  for (const SpaceChunk& chunk : chunks) {
    take(chunk, space);
    std::optional<Touchable> next;
    if (body) {
      next.emplace(*body, space, chunk);
      EXPECT_EQ(&next->surface(), &body->surface());
    } else {
      next.emplace(space);
    }
    body = std::move(next);
    expect_same_forces(*body, Touchable(space), growing.options.half_width);
  }
  const Interpolator* untouched = body->nodes()[0].on_branch[0].get();
  SpaceChunk of_second;
  of_second.tool_spaces.push_back(chunks.back().tool_spaces.back());
  const Touchable again(*body, space, of_second);
  const bool is_first = of_second.tool_spaces[0].setup.id == body->nodes()[0].mesh_point;
  EXPECT_EQ(again.nodes()[0].on_branch[0].get() == untouched, !is_first);
}

}  // namespace
}  // namespace palpate::test::test_growing
