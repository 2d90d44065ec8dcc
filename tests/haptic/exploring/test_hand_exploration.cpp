// SPDX-License-Identifier: BSD-3-Clause
// A space that is explored while a hand touches it: what the hand feels, what is shown of it, and
// what stays in the file.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "base/clock.h"
#include "base/error.h"
#include "exploration/precompute.h"
#include "following/begin_following.h"
#include "haptic/exploring/expected_press.h"
#include "haptic/exploring/hand_exploration.h"
#include "interpolation/body_field.h"
#include "interpolation/tool_force.h"
#include "solvers/following/ball_on_block.h"
#include "solvers/support/world_folder.h"
#include "storage/state_space_file.h"
#include "storage/stored_touch_space.h"

namespace palpate::test::test_hand_exploration {
namespace {

/// Long enough on a busy machine, s.
constexpr double kPatience = 120;

class HandExplorationTest : public testing::Test {
 protected:
  HandExplorationTest() {
    setenv("PALPATE_EXPLORE", PALPATE_EXPLORE, 1);
    options_.space = ball_.options;
    options_.space.file = folder_.path() / "space.palpate";
    options_.num_explorers = 1;
    place_ = ball_.hand().hand().place;
  }
  ~HandExplorationTest() override { unsetenv("PALPATE_EXPLORE"); }

  void begin() {
    const auto take = [this](std::shared_ptr<const Touchable> body) {
      const std::lock_guard lock(mutex_);
      body_ = std::move(body);
      if (first_body_ == nullptr) first_body_ = body_;
      ++num_bodies_;
    };
    exploration_ = std::make_unique<HandExploration>(
        ball_.scene, options_,
        [this] {
          return std::optional(HandMotion{place_, Vec3::Zero()});
        },
        take);
  }
  [[nodiscard]] std::shared_ptr<const Touchable> body() {
    const std::lock_guard lock(mutex_);
    return body_;
  }
  template <class Condition>
  [[nodiscard]] static bool until(const Condition& condition) {
    const auto begin = SteadyClock::now();
    while (!condition()) {
      if (seconds_since(begin) > kPatience) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return true;
  }
  [[nodiscard]] bool is_felt() {
    const auto body = this->body();
    return body != nullptr && body->force_on_tool()->has_cell(place_) &&
           body->force_on_tool()->evaluate(place_).support == Support::inside;
  }

  std::unique_ptr<Communicator> communicator_ = make_serial_communicator();
  WorldFolder folder_{*communicator_};
  BallOnBlock ball_;
  HandExplorationOptions options_;
  Vec3 place_;
  std::mutex mutex_;
  std::shared_ptr<const Touchable> body_;
  std::shared_ptr<const Touchable> first_body_;
  int num_bodies_ = 0;
  std::unique_ptr<HandExploration> exploration_;
};

TEST_F(HandExplorationTest, GivesTheForceAndTheShapeWhereTheHandIs) {
  begin();
  ASSERT_TRUE(until([&] { return is_felt(); })) << exploration_->figures().problem;
  const auto shown = exploration_->newest();
  ASSERT_NE(shown.force, nullptr);
  const TouchResult felt = shown.force->evaluate(place_);
  EXPECT_GT(felt.force.norm(), 0.1);

  NodalVector u;
  NodalVector p;
  const BodyField field(*shown.tool_space, shown.force->part(0).grid());
  EXPECT_EQ(field.evaluate(place_, exploration_->fields(), Keep::all, u, p), Support::inside);
  ASSERT_EQ(u.size(), 3 * Eigen::Index{ball_.scene->body.mesh.num_points()});
  // The ball is this deep in the body at rest, less its layer of contact.
  EXPECT_NEAR(u.cwiseAbs().maxCoeff(), 0.003, 0.002);
  exploration_->end();
}

TEST_F(HandExplorationTest, WhatItHasFoundIsThereAtOnceTheNextTime) {
  begin();
  ASSERT_TRUE(until([&] { return is_felt(); }));
  exploration_->end();
  exploration_.reset();
  // The body that was felt last need not have all that was found.
  const TouchSpace found =
      make_touch_space_without_modes(StateSpaceFile::open_read_only(options_.space.file));
  const TouchResult felt =
      ToolForce(found.list_pressing(), Method::energy_hermite).evaluate(place_);
  EXPECT_EQ(felt.support, Support::inside);
  first_body_.reset();
  body_.reset();
  begin();
  ASSERT_TRUE(until([&] { return body() != nullptr; }));
  const TouchResult again = first_body_->force_on_tool()->evaluate(place_);
  EXPECT_LT((again.force - felt.force).norm(), 1e-9 * felt.force.norm());
  exploration_->end();
  exploration_.reset();
  // And an exploration of the whole space goes on with it.
  const PrecomputeResult whole = precompute(*ball_.scene, options_.space, *communicator_,
                                            [](const ProgressState&) { return true; });
  EXPECT_TRUE(whole.report.complete);
  EXPECT_GE(whole.report.num_reused, 8);
}

TEST_F(HandExplorationTest, ASpaceThatIsBegunHasAPlaceWhereItsToolIs) {
  const BegunSpace begun = begin_following(ball_.scene, options_.space);
  ASSERT_EQ(begun.space.tool_spaces.size(), 1U);
  EXPECT_FALSE(begun.space.tool_spaces[0].configurations.empty());
  EXPECT_NO_THROW(Touchable{begun.space});
  const auto may = may_be_pressed(begun.space.surface, *ball_.scene, ball_.options.contact->shell);
  for (std::size_t i = 0; i < may.size(); ++i) {
    EXPECT_EQ(may[i] != 0, begun.space.surface.points[i].x() > 0.08);
  }
  // Hertz, of the moduli of the block.
  const ExpectedPress press = expected_press(*ball_.scene, begun.space.tool_spaces[0].setup);
  EXPECT_NEAR(press.pressure, 1.5 * press.force / (EIGEN_PI * 0.015 * 0.006),
              1e-9 * press.pressure);
  // Others may have the file.
  EXPECT_NO_THROW((void)StateSpaceFile::open_read_only(options_.space.file));
}

TEST(MayBePressed, AnEdgeWhoseEndsMay) {
  Block block = make_block(Law::neo_hookean, {ElementOrder::quadratic, {2, 1, 1}});
  Body& body = block.scene.body;
  for (Index c = 0; c < body.mesh.num_cells(); ++c) {
    for (int edge = 0; edge < 6; ++edge) body.touchable[body.mesh.cell(c)[4 + edge]] = 0;
  }
  const Surface surface = make_surface(body.mesh);
  const std::vector<char> may = may_be_pressed(surface, block.scene, {});
  for (const auto& [a, b, c] : surface.triangles) {
    const bool is_free = body.fixed[surface.mesh_points[a]] == 0 &&
                         body.fixed[surface.mesh_points[b]] == 0 &&
                         body.fixed[surface.mesh_points[c]] == 0;
    if (is_free && block.scene.body.mesh.points[surface.mesh_points[a]].x() > 0.06) {
      EXPECT_TRUE(may[a] != 0 && may[b] != 0 && may[c] != 0);
    }
  }
}

TEST_F(HandExplorationTest, AMissingProgramIsOneError) {
  setenv("PALPATE_EXPLORE", "/nowhere/palpate-explore", 1);
  try {
    begin();
    FAIL() << "it has begun";
  } catch (const BackendError& error) {
    EXPECT_NE(std::string(error.what()).find("/nowhere/palpate-explore"), std::string::npos);
  }
}

}  // namespace
}  // namespace palpate::test::test_hand_exploration
