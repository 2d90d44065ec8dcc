// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <filesystem>
#include <memory>

#include "accuracy/draw.h"
#include "accuracy/exact.h"
#include "base/error.h"
#include "equilibrium/equilibrium.h"
#include "interaction/bonded_patch.h"
#include "solvers/support/block.h"
#include "solvers/support/communicators.h"
#include "solvers/support/setup.h"
#include "solvers/support/world_folder.h"
#include "storage/state_space_file.h"

namespace palpate::test::test_exact {
namespace {

namespace fs = std::filesystem;

class Exact : public testing::Test {
 protected:
  void SetUp() override {
    for (const Index node : {block_.middle, block_.corner}) {
      setups_.push_back(test::bonded_setup(node, {0.02, 7}));
    }
    options_.test_points = 60;
    options_.equilibrium.tolerance = 1e-9;
  }

  ExactResult run(Communicator& communicator) const {
    return solve_test_points({std::make_shared<const Scene>(block_.scene)}, setups_, options_,
                             communicator, progress_);
  }

  std::unique_ptr<Communicator> world_ = test::make_world();
  test::WorldFolder folder_{*world_};
  std::unique_ptr<Communicator> serial_ = make_serial_communicator();
  test::Block block_ = test::make_block(Law::neo_hookean, test::BlockOptions{ElementOrder::linear});
  std::vector<ToolSpaceSetup> setups_;
  ExactOptions options_;
  Progress progress_;
};

void expect_equal(const ExactResult& a, const ExactResult& b) {
  ASSERT_EQ(a.points.size(), b.points.size());
  for (std::size_t s = 0; s < a.points.size(); ++s) {
    ASSERT_EQ(a.points[s].size(), b.points[s].size());
    for (std::size_t i = 0; i < a.points[s].size(); ++i) {
      const TestPoint& x = a.points[s][i];
      const TestPoint& y = b.points[s][i];
      EXPECT_EQ(x.kind, y.kind);
      EXPECT_EQ(x.number, y.number);
      EXPECT_EQ(x.t, y.t);
      EXPECT_EQ(x.outcome, y.outcome);
      EXPECT_EQ(x.flags, y.flags);
      EXPECT_EQ(x.energy, y.energy);
      EXPECT_EQ(x.force, y.force);
      EXPECT_EQ(x.stiffness, y.stiffness);
      EXPECT_EQ(x.displacement, y.displacement);
    }
  }
}

TEST_F(Exact, SeveralRanksFindWhatOneFindsToTheBit) {
  const ExactResult parallel = run(*world_);
  EXPECT_TRUE(parallel.complete);
  if (world_->rank() != 0) return;
  EXPECT_EQ(parallel.num_solved, 120);
  expect_equal(parallel, run(*serial_));
}

TEST_F(Exact, PointsAreEquilibria) {
  if (test::is_repetition(*world_)) GTEST_SKIP() << "it is the same on any number of ranks";
  const ExactResult result = run(*world_);
  EquilibriumSolver solver(block_.scene, options_.equilibrium);
  for (std::size_t s = 0; s < setups_.size(); ++s) {
    solver.set_interaction(
        BondedPatches(block_.scene.body, 0).around(setups_[s].interaction.active_node));
    const Equilibrium rest = solver.rest();
    for (const TestPoint& point : result.points[s]) {
      ASSERT_EQ(point.outcome, Outcome::converged);
      if (point.number % 7 != 0) continue;  // some of each kind
      const Equilibrium found = solver.solve(point.t, rest);
      const double scale = (found.stiffness * point.t).norm();
      EXPECT_LE((found.reaction - point.force).norm(), 1e-7 * scale);
      EXPECT_LE((found.stiffness - point.stiffness).norm(), 1e-6 * found.stiffness.norm());
      const std::vector<Index> samples = sample_points(make_surface(block_.scene.body.mesh));
      ASSERT_EQ(point.displacement.size(), 3 * static_cast<Eigen::Index>(samples.size()));
    }
  }
}

TEST_F(Exact, AFileIsTakenUpAndExtended) {
  options_.file = folder_ / "points.palpate";
  options_.test_points = 30;
  const ExactResult few = run(*world_);
  options_.test_points = 60;
  const ExactResult more = run(*world_);
  const ExactResult again = run(*world_);
  options_.file.clear();
  const ExactResult in_memory = run(*world_);
  if (world_->rank() != 0) return;
  EXPECT_EQ(few.num_solved, 60);
  // Of the first 30 six are on a walk, which is made anew from rest for twelve.
  EXPECT_EQ(more.num_reused, 2 * (30 - 6));
  EXPECT_EQ(more.num_solved + more.num_reused, 120);
  EXPECT_EQ(again.num_solved, 0);
  EXPECT_EQ(again.num_reused, 120);
  expect_equal(more, in_memory);
  expect_equal(again, in_memory);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator()), 1);
}

TEST_F(Exact, AnAbortedRunGoesOn) {
  options_.file = folder_ / "points.palpate";
  progress_ = [](const ProgressState& state) { return state.num_done < 20; };
  const ExactResult aborted = run(*world_);
  EXPECT_FALSE(aborted.complete);
  progress_ = nullptr;
  const ExactResult rest = run(*world_);
  EXPECT_TRUE(rest.complete);
  options_.file.clear();
  const ExactResult in_memory = run(*world_);
  if (world_->rank() != 0) return;
  EXPECT_GT(rest.num_reused, 0);
  expect_equal(rest, in_memory);
}

TEST_F(Exact, TheFileOfASpaceHasRoomForThem) {
  if (world_->rank() != 0) return;
  options_.file = folder_ / "space.palpate";
  options_.test_points = 10;
  {
    StateSpaceFile file = StateSpaceFile::create(options_.file, block_.scene, 1e-9);
    file.add_tool_space(setups_[0]);
  }
  EXPECT_EQ(run(*serial_).num_solved, 20);
  EXPECT_EQ(StateSpaceFile::open_read_only(options_.file).read_tool_spaces().size(), 1U);
  EXPECT_EQ(run(*serial_).num_reused, 20);
}

TEST_F(Exact, WhatIsWrongIsSaid) {
  const auto message = [&] {
    try {
      (void)run(*world_);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  options_.test_points = 0;
  EXPECT_NE(message().find("test points is 0"), std::string::npos);
  options_.test_points = 10;
  setups_[0].interaction.active_node = 1 << 20;
  EXPECT_NE(message().find("1048576"), std::string::npos);
}

}  // namespace
}  // namespace palpate::test::test_exact
