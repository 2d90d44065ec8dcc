// SPDX-License-Identifier: BSD-3-Clause
// The levels of a rigid tool's space, searched for around a hand.
#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <random>
#include <vector>

#include "exploration/precompute.h"
#include "following/follow_session.h"
#include "interpolation/tool_force.h"
#include "solvers/support/thin_plate.h"
#include "solvers/support/world_folder.h"

namespace palpate::test::test_follow_levels {
namespace {

class FollowLevels : public testing::Test {
 protected:
  [[nodiscard]] std::unique_ptr<FollowSession> begin() const {
    auto session = std::make_unique<FollowSession>(plate_.scene, options_);
    session->follow(HandPrediction({hand(), Vec3::Zero()}));
    return session;
  }
  /// It rests at the free edge, which it presses.
  [[nodiscard]] static Vec3 hand() {
    return {ThinPlate::kSize.x() + 0.007, 0.5 * ThinPlate::kSize.y() + 0.001, 0.003};
  }
  /// Explores until nothing is left, or so many were solved for.
  static void explore(FollowSession& session, std::int64_t at_most = 100'000) {
    Explorer explorer(unpack_job(pack(session.job())));
    while (session.figures().num_solved < at_most) {
      const std::optional<ExplorerTask> task = session.next();
      if (!task) return;
      ASSERT_TRUE(session.accept(unpack_result(pack(explorer.make(unpack_task(pack(*task)))))));
    }
  }
  /// Whether a force that has grown is that of the same space to the last bit.
  static void expect_same(const ToolForce& grown, const ToolForce& whole) {
    ASSERT_EQ(grown.num_branches(), whole.num_branches());
    std::mt19937 random(3);
    std::uniform_real_distribution<double> unit(0, 1);
    const Vec3 size(0.03, 0.03, 0.04);
    for (int i = 0; i < 500; ++i) {
      const Vec3 aside(unit(random) - 0.5, unit(random) - 0.5, unit(random) - 0.5);
      const Vec3 x = hand() + size.cwiseProduct(aside);
      for (int branch = 0; branch < whole.num_branches(); ++branch) {
        const TouchResult a = grown.evaluate(x, {branch});
        const TouchResult b = whole.evaluate(x, {branch});
        EXPECT_EQ(a.force, b.force);
        EXPECT_EQ(a.support, b.support);
      }
      EXPECT_EQ(grown.branch_from_outside(x), whole.branch_from_outside(x));
    }
  }

  ThinPlate plate_;
  PrecomputeOptions options_ = ThinPlate::options();
};

TEST_F(FollowLevels, FromEitherSideTheToolFeelsTheEquilibriumOfItsWay) {
  const auto session = begin();
  TouchSpace space = session->empty_space();
  std::unique_ptr<ToolForce> grown;
  std::int64_t solved = 0;
  do {
    solved = session->figures().num_solved;
    explore(*session, solved + 40);
    while (const auto chunk = session->take_chunk()) {
      take(*chunk, space);
      const std::vector<const TouchToolSpace*> rigid = space.list_pressing();
      const ToolSpaceChunk& part = chunk->tool_spaces.front();
      grown = grown == nullptr ? std::make_unique<ToolForce>(rigid, Method::energy_hermite)
                               : std::make_unique<ToolForce>(*grown, rigid, part.setup.key(),
                                                             part.check_points());
    }
  } while (session->figures().num_solved > solved);
  EXPECT_TRUE(session->figures().is_complete);
  const FeltFromBothSides felt = press_from_both_sides(plate_, *space.find_pressing(), 12);
  EXPECT_EQ(felt.num_different, 12);
  EXPECT_GT(felt.num_unmarked, 4 * felt.num_marked);
  const ToolForce whole({space.find_pressing()}, Method::energy_hermite);
  EXPECT_GT(whole.num_branches(), 1);
  expect_same(*grown, whole);
}

TEST_F(FollowLevels, LevelsUnderTheHandComeBeforeTheRestOfTheSpace) {
  const auto session = begin();
  Explorer explorer(session->job());
  std::optional<ExplorerTask> task = session->next();
  for (; task && !task->transition.finds_candidate; task = session->next()) {
    ASSERT_TRUE(session->accept(explorer.make(*task)));
  }
  ASSERT_TRUE(task);
  const ToolSpaceSetup& setup = session->job().setup;
  EXPECT_LT((setup.grid.place(task->transition.target) - hand()).norm(), 0.02);
  // One that is lost is given again, before the rest.
  session->lose(task->number);
  const Transition lost = task->transition;
  bool is_again = false;
  for (task = session->next(); task && task->transition.finds_candidate; task = session->next()) {
    is_again = is_again || (task->transition.start == lost.start &&
                            task->transition.start_level == lost.start_level &&
                            task->transition.target == lost.target);
    ASSERT_TRUE(session->accept(explorer.make(*task)));
  }
  EXPECT_TRUE(is_again);
  ASSERT_TRUE(task);
  EXPECT_GT((setup.grid.place(task->transition.target) - hand()).norm(), 0.008);
}

TEST_F(FollowLevels, GoOnInTheFileOfAnotherRun) {
  const auto world = make_serial_communicator();
  const WorldFolder folder(*world);
  options_.file = folder / "space.palpate";
  {
    const auto session = begin();
    explore(*session, 150);
    (void)session->finish();
  }
  const PrecomputeResult whole = precompute(*plate_.scene, options_, *world, nullptr);
  EXPECT_GT(whole.report.num_levels, 10);
  const auto session = begin();
  explore(*session);
  EXPECT_EQ(session->figures().num_solved, 0);
  const TouchSpace space = session->finish();
  const std::vector<ConfigurationSummary>& all = whole.space.tool_spaces.front().configurations;
  const std::vector<ConfigurationSummary>& again = space.tool_spaces.front().configurations;
  ASSERT_EQ(all.size(), again.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(all[i].check_point, again[i].check_point);
    EXPECT_EQ(all[i].level, again[i].level);
    EXPECT_EQ(all[i].reached, again[i].reached);
  }
}

}  // namespace
}  // namespace palpate::test::test_follow_levels
