// SPDX-License-Identifier: BSD-3-Clause
// Several ranks a solve: the space of one rank but for the order of the sums, and nobody is left
// behind, however a run ends.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <string>

#include "base/error.h"
#include "exploration/precompute.h"
#include "solvers/support/block.h"
#include "solvers/support/communicators.h"

namespace palpate::test::test_groups {
namespace {

namespace fs = std::filesystem;

/// Two ways to the same equilibrium: equal to the solver's tolerance.
constexpr double kAgreement = 1e-7;

/// Of a configuration from which no other is reached, whose sensitivity is found by iteration.
constexpr double kAgreementOfStiffness = 1e-6;

void expect_close(const TouchSpace& a, const TouchSpace& b) {
  EXPECT_EQ(a.scene_hash, b.scene_hash);
  ASSERT_EQ(a.tool_spaces.size(), b.tool_spaces.size());
  for (std::size_t s = 0; s < a.tool_spaces.size(); ++s) {
    const auto& x = a.tool_spaces[s].configurations;
    const auto& y = b.tool_spaces[s].configurations;
    ASSERT_EQ(x.size(), y.size());
    double force = 0;
    double energy = 0;
    for (const ConfigurationSummary& c : y) {
      force = std::max(force, c.force.norm());
      energy = std::max(energy, c.energy);
    }
    for (std::size_t i = 0; i < x.size(); ++i) {
      EXPECT_EQ(x[i].check_point, y[i].check_point);
      EXPECT_EQ(x[i].parent, y[i].parent);
      EXPECT_EQ(x[i].outcome, y[i].outcome);
      EXPECT_EQ(x[i].flags, y[i].flags);
      EXPECT_LE((x[i].force - y[i].force).norm(), kAgreement * force);
      EXPECT_LE(std::abs(x[i].energy - y[i].energy), kAgreement * energy);
      EXPECT_LE((x[i].stiffness - y[i].stiffness).norm(),
                kAgreementOfStiffness * y[i].stiffness.norm());
    }
  }
}

class Groups : public testing::Test {
 protected:
  void SetUp() override {
    options_.active_nodes = {block_.corner, block_.middle};
    options_.half_width = 0.01;
    options_.resolution = 3;
    options_.ranks_per_solve = 2;
  }

  PrecomputeResult run(Communicator& communicator) const {
    return precompute(block_.scene, options_, communicator, progress_);
  }

  /// Groups of two; the last of an odd number has three.
  [[nodiscard]] int num_groups() const { return world_->size() / 2; }
  [[nodiscard]] int last_leader() const { return 2 * (num_groups() - 1); }

  std::unique_ptr<Communicator> world_ = test::make_world();
  std::unique_ptr<Communicator> serial_ = make_serial_communicator();
  test::Block block_ = test::make_block(Law::neo_hookean);
  PrecomputeOptions options_;
  Progress progress_;
};

TEST_F(Groups, FindTheSpaceOfOneRank) {
  // Large enough that MUMPS gives every rank a share.
  block_ = test::make_block(Law::neo_hookean, {ElementOrder::quadratic, {6, 4, 4}});
  options_.active_nodes = {block_.corner};
  const PrecomputeResult together = run(*world_);
  EXPECT_TRUE(together.report.complete);
  EXPECT_EQ(together.report.num_solved, 27);
  EXPECT_EQ(together.report.num_ranks, world_->size());
  EXPECT_EQ(together.report.num_unknowns, 3 * (13 * 9 * 9 - 9 * 9 - 1));
  EXPECT_GT(together.report.exploration_seconds, 0);
  EXPECT_GE(together.report.work.factorisations, 1);
  if (world_->rank() == 0) {
    options_.ranks_per_solve = 1;
    expect_close(together.space, run(*serial_).space);
  } else {
    EXPECT_TRUE(together.space.tool_spaces.empty());
  }
}

TEST_F(Groups, KeepAFileThatRanksAloneGoOnWith) {
  const fs::path folder =
      fs::temp_directory_path() / ("palpate_groups_" + std::to_string(world_->size()));
  agree(*world_, [&] {
    if (world_->rank() != 0) return;
    fs::remove_all(folder);
    fs::create_directory(folder);
  });
  options_.file = folder / "a.palpate";
  progress_ = [](const ProgressState& state) { return state.share() < 0.5; };
  const PrecomputeResult part = run(*world_);
  EXPECT_FALSE(part.report.complete);
  EXPECT_GT(part.report.num_solved, 0);
  EXPECT_LT(part.report.num_solved, 2 * 27);
  progress_ = nullptr;
  options_.ranks_per_solve = 1;
  const PrecomputeResult whole = run(*world_);
  EXPECT_GE(whole.report.num_reused, part.report.num_solved);
  EXPECT_EQ(whole.report.num_solved + whole.report.num_reused, 2 * 27);
  if (world_->rank() != 0) return;
  options_.file.clear();
  expect_close(whole.space, run(*serial_).space);
  fs::remove_all(folder);
}

TEST_F(Groups, EndTogetherWhenOneIsAborted) {
  options_.resolution = 11;
  int calls = 0;
  progress_ = [&](const ProgressState&) { return world_->rank() != last_leader() || ++calls < 20; };
  const PrecomputeResult part = run(*world_);
  EXPECT_FALSE(part.report.complete);
  EXPECT_LT(part.report.num_solved, 2 * 11 * 11 * 11 / 3);
}

TEST_F(Groups, EndTogetherWhenOneFails) {
  int calls = 0;
  progress_ = [&](const ProgressState&) {
    if (world_->rank() == last_leader() && ++calls == 20) throw std::runtime_error("the end");
    return true;
  };
  try {
    (void)run(*world_);
    ADD_FAILURE() << "no error";
  } catch (const BackendError& error) {
    EXPECT_STREQ(error.what(), "the end");
  }
  progress_ = nullptr;
  EXPECT_TRUE(run(*world_).report.complete) << "and the next run is not touched";
}

TEST_F(Groups, ReportWhatIsWrongOnce) {
  const auto message = [this] {
    try {
      (void)run(*world_);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  options_.active_nodes = {block_.scene.body.mesh.num_points()};
  EXPECT_NE(message().find("does not exist"), std::string::npos);
  options_.active_nodes = {block_.corner};
  for (const int bad : {-1, 0, world_->size() + 1}) {
    options_.ranks_per_solve = bad;
    EXPECT_EQ(message(), "The ranks per solve are " + std::to_string(bad) +
                             "; they must be from 1 to the number of ranks, " +
                             std::to_string(world_->size()) + '.');
  }
  options_.ranks_per_solve = 2;
  options_.linear_solver = "Eigen LDLT";
  EXPECT_NE(message().find("Eigen LDLT"), std::string::npos);
}

}  // namespace
}  // namespace palpate::test::test_groups
