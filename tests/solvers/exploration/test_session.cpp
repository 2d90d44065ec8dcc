// SPDX-License-Identifier: BSD-3-Clause
// An exploration that is paused, published and steered finds the space of one that runs in one go.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "exploration/precompute.h"
#include "solvers/exploration/equal_spaces.h"
#include "solvers/exploration/pressed_corner.h"
#include "solvers/support/block.h"
#include "solvers/support/communicators.h"
#include "solvers/support/world_folder.h"
#include "state_space/shown_surface.h"
#include "storage/state_space_file.h"

namespace palpate::test::test_session {
namespace {

using test::expect_equal;
using test::press_corner_of_block;
using State = ExplorationSession::State;

class Session : public testing::Test {
 protected:
  void SetUp() override {
    options_.active_nodes = {block_.corner};
    options_.half_width = 0.02;
    options_.resolution = 5;
    options_.history = History::flat;
    options_.keep = Keep::all;
  }

  [[nodiscard]] std::unique_ptr<ExplorationSession> begin() {
    return begin_exploration({{std::make_shared<const Scene>(block_.scene), options_.active_nodes}},
                             options_, *world_, progress_, take_chunk_);
  }
  /// The space of a run in one go.
  [[nodiscard]] PrecomputeResult whole() const {
    PrecomputeOptions options = options_;
    options.file.clear();
    return precompute(block_.scene, options, *world_, {});
  }
  /// Pauses when a rank has found so many more.
  [[nodiscard]] static Until after(std::int64_t number) {
    return [number, first = std::int64_t{-1}](const ProgressState& state) mutable {
      if (first < 0) first = state.num_solved;
      return state.num_solved >= first + number;
    };
  }
  [[nodiscard]] Steering towards(const Vec3& goal) const {
    return {{{{options_.contact ? kContactToolSpace : ToolSpaceId{block_.corner}}, {goal}, {}}}};
  }
  /// The targets with i > 0 are withdrawn.
  [[nodiscard]] Steering without_half() const {
    return {{{{block_.corner}, {}, {{{1, -2, -2}, {2, 2, 2}}}}}};
  }

  std::unique_ptr<Communicator> world_ = test::make_world();
  test::WorldFolder folder_{*world_};
  test::Block block_ = test::make_block(Law::neo_hookean, {ElementOrder::linear});
  PrecomputeOptions options_;
  Progress progress_;
  TakeChunk take_chunk_;
  /// On rank 0: what chunks have made.
  std::vector<SpaceBody> bodies_ = {make_space_body(block_.scene)};
  TouchSpace taken_ = make_empty_touch_space(ShownSurface(bodies_));
  std::int64_t num_chunks_ = 0;

  void take_chunks() {
    take_chunk_ = [this](const SpaceChunk& chunk) {
      EXPECT_EQ(chunk.number, ++num_chunks_);
      take(chunk, taken_);
    };
  }

  /// The displacements of the surface are the same within the bound of the modes.
  void expect_same_displacements(const TouchToolSpace& a, const TouchToolSpace& b) const {
    const double most = 2 * options_.touch_bound * options_.half_width;
    const Eigen::MatrixXf difference = a.modes * a.coefficients - b.modes * b.coefficients;
    EXPECT_LE(difference.cwiseAbs().maxCoeff(), most);
  }
};

TEST_F(Session, PausesGiveTheSpaceOfOneRunToTheBit) {
  const auto session = begin();
  int num_pauses = 0;
  while (session->run(after(5)) == State::paused) ++num_pauses;
  EXPECT_EQ(session->state(), State::complete);
  EXPECT_GT(num_pauses, 3);
  const PrecomputeResult result = session->finish();
  EXPECT_TRUE(result.report.complete);
  EXPECT_EQ(result.report.num_cells, block_.scene.body.mesh.num_cells());
  expect_equal(result.space, whole().space);
}

TEST_F(Session, WhatIsPublishedMeanwhileIsInTheFile) {
  options_.file = folder_ / "a.palpate";
  const auto session = begin();
  std::size_t last = 0;
  while (session->run(after(20)) == State::paused) {
    const PrecomputeResult part = session->publish();
    if (world_->rank() != 0) continue;
    const std::size_t number = part.space.tool_spaces[0].configurations.size();
    EXPECT_GT(number, last);
    last = number;
    const TouchSpace read = make_touch_space(StateSpaceFile::open_read_only(options_.file));
    EXPECT_EQ(read.tool_spaces[0].configurations.size(), number);
  }
  EXPECT_GT(world_->rank() == 0 ? last : 1, 0u);
  expect_equal(session->finish().space, whole().space);
}

TEST_F(Session, WhatIsNearAGoalIsFoundFirst) {
  if (test::is_repetition(*world_)) GTEST_SKIP() << "the order is that of one rank";
  const auto nearest_after_20 = [&](const Vec3& goal, bool steers) {
    const auto session = begin();
    if (steers) session->steer(towards(goal));
    EXPECT_EQ(session->run(after(20)), State::paused);
    double least = goal.norm();
    for (const ConfigurationSummary& c : session->publish().space.tool_spaces[0].configurations) {
      least = std::min(least, (c.t - goal).norm());
    }
    return least;
  };
  const Vec3 one = Vec3::Constant(options_.half_width);
  const Vec3 other = -one;
  EXPECT_EQ(nearest_after_20(one, true), 0);
  EXPECT_EQ(nearest_after_20(other, true), 0);
  EXPECT_GT(nearest_after_20(one, false) + nearest_after_20(other, false), 0);
}

TEST_F(Session, SteeringWhileItRunsChangesNoBit) {
  for (const bool has_file : {false, true}) {
    if (has_file) options_.file = folder_ / "a.palpate";
    ExplorationSession* running = nullptr;
    // Each rank steers from within its solves, to another corner each time.
    int num_calls = 0;
    progress_ = [&](const ProgressState& /*state*/) {
      if (running == nullptr || ++num_calls % 7 != 0) return true;
      const int corner = num_calls + world_->rank();
      running->steer(
          towards(options_.half_width * Vec3((corner & 1) != 0 ? 1 : -1, (corner & 2) != 0 ? 1 : -1,
                                             (corner & 4) != 0 ? 1 : -1)));
      return true;
    };
    const auto session = begin();
    running = session.get();
    EXPECT_EQ(session->run(), State::complete);
    EXPECT_TRUE(any(*world_, num_calls > 7));
    running = nullptr;
    expect_equal(session->finish().space, whole().space);
  }
}

TEST_F(Session, ARigidToolIsSteeredOverTheBody) {
  press_corner_of_block(options_);
  const auto session = begin();
  Vec3 goal(0.1, 0, 0.05);
  do {
    session->steer(towards(goal));
    goal.y() += 0.02;
  } while (session->run(after(10)) == State::paused);
  EXPECT_EQ(session->state(), State::complete);
  expect_equal(session->finish().space, whole().space);
}

TEST_F(Session, WhatIsWithdrawnIsNotFoundAndMayBeAskedForAgain) {
  for (const bool has_file : {false, true}) {
    if (has_file) options_.file = folder_ / "a.palpate";
    const auto session = begin();
    // From the last rank.
    if (world_->rank() == world_->size() - 1) session->steer(without_half());
    EXPECT_EQ(session->run(), State::withdrawn);
    const PrecomputeResult half = session->publish();
    EXPECT_FALSE(half.report.complete);
    if (world_->rank() == 0) {
      const auto& found = half.space.tool_spaces[0].configurations;
      EXPECT_EQ(found.size(), 3u * 5 * 5);
      EXPECT_TRUE(std::all_of(found.begin(), found.end(), [](const ConfigurationSummary& c) {
        return c.usable() && c.check_point[0] <= 0;
      }));
    }
    if (world_->rank() == 0) session->steer({});
    EXPECT_EQ(session->run(), State::complete);
    expect_equal(session->finish().space, whole().space);
  }
}

TEST_F(Session, ALaterRunFindsWhatWasWithdrawn) {
  options_.file = folder_ / "a.palpate";
  {
    const auto session = begin();
    session->steer(without_half());
    EXPECT_EQ(session->run(), State::withdrawn);
    EXPECT_FALSE(session->finish().report.complete);
  }
  const PrecomputeResult rest = precompute(block_.scene, options_, *world_, {});
  EXPECT_EQ(rest.report.num_reused, 75);
  EXPECT_EQ(rest.report.num_solved, 50);
  EXPECT_TRUE(rest.report.complete);
  expect_equal(rest.space, whole().space);
}

TEST_F(Session, ChunksMakeTheSpace) {
  options_.intermediate_states = 1;
  take_chunks();
  const auto session = begin();
  while (session->run(after(10)) == State::paused) {
  }
  PrecomputeResult result = session->finish();
  if (world_->rank() != 0) return;
  EXPECT_GT(num_chunks_, 3);
  ASSERT_EQ(taken_.tool_spaces.size(), 1u);
  expect_same_displacements(taken_.tool_spaces[0], result.space.tool_spaces[0]);
  // Modes that were found one after the other are not those of all at once.
  TouchToolSpace& whole = result.space.tool_spaces[0];
  whole.modes = taken_.tool_spaces[0].modes;
  whole.coefficients = taken_.tool_spaces[0].coefficients;
  whole.coefficient_gradients = taken_.tool_spaces[0].coefficient_gradients;
  expect_equal(taken_, result.space);
}

TEST_F(Session, ChunksMakeTheSpaceOfARigidToolToTheBit) {
  press_corner_of_block(options_);
  options_.file = folder_ / "a.palpate";
  {
    const auto session = begin();
    EXPECT_EQ(session->run(after(10)), State::paused);
    (void)session->finish();
  }
  // What an earlier run has found comes first.
  take_chunks();
  const auto session = begin();
  while (session->run(after(10)) == State::paused) (void)session->publish();
  const TouchSpace whole = session->finish().space;
  if (world_->rank() != 0) return;
  expect_equal(taken_, whole);
  EXPECT_TRUE(taken_.tool_spaces[0].clearance);
}

TEST(Steering, TheBoxesOutsideOfOneCoverAllOthersOnce) {
  Grid grid;
  grid.half_width = 0.01;
  grid.resolution = 7;
  const CheckPointBox box{{-1, 0, 2}, {2, 1, 3}};
  const std::vector<CheckPointBox> others = outside_of(box, grid);
  for (std::int32_t i = -3; i <= 3; ++i) {
    for (std::int32_t j = -3; j <= 3; ++j) {
      for (std::int32_t k = -3; k <= 3; ++k) {
        const auto number =
            std::count_if(others.begin(), others.end(), [&](const CheckPointBox& other) {
              return other.contains({i, j, k});
            });
        EXPECT_EQ(number, box.contains({i, j, k}) ? 0 : 1);
      }
    }
  }
}

}  // namespace
}  // namespace palpate::test::test_session
