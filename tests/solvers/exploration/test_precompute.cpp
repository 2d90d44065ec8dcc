// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <string>

#include "base/error.h"
#include "equilibrium/equilibrium.h"
#include "equilibrium/tangent_solver.h"
#include "exploration/precompute.h"
#include "interaction/bonded_patch.h"
#include "solvers/exploration/equal_spaces.h"
#include "solvers/support/block.h"
#include "solvers/support/bodies.h"
#include "solvers/support/communicators.h"
#include "solvers/support/message_of.h"
#include "solvers/support/world_folder.h"
#include "storage/state_space_file.h"

namespace palpate::test::test_precompute {
namespace {

namespace fs = std::filesystem;

using test::expect_equal;

class Precompute : public testing::Test {
 protected:
  void SetUp() override {
    options_.active_nodes = {block_.corner, block_.middle};
    options_.half_width = 0.02;
    options_.resolution = 5;
    options_.history = History::flat;
    // What is kept of the fields is tested in test_keep.cpp.
    options_.keep = Keep::all;
  }

  PrecomputeResult run(Communicator& communicator) const {
    return precompute(block_.scene, options_, communicator, progress_);
  }

  std::unique_ptr<Communicator> world_ = test::make_world();
  test::WorldFolder folder_{*world_};
  std::unique_ptr<Communicator> serial_ = make_serial_communicator();
  test::Block block_ = test::make_block(Law::neo_hookean);
  PrecomputeOptions options_;
  Progress progress_;
  /// A body for many short runs.
  void make_small() {
    block_ = test::make_block(Law::neo_hookean, {ElementOrder::linear});
    options_.active_nodes = {block_.corner};
  }
};

TEST_F(Precompute, SeveralRanksGiveTheSpaceOfOneToTheBit) {
  const PrecomputeResult parallel = run(*world_);
  EXPECT_EQ(parallel.report.num_solved, 250);
  EXPECT_TRUE(parallel.report.complete);
  EXPECT_EQ(parallel.report.num_ranks, world_->size());
  if (world_->rank() == 0) {
    const PrecomputeResult serial = run(*serial_);
    EXPECT_GT(serial.space.tool_spaces[0].modes.cols(), 0);
    expect_equal(parallel.space, serial.space);
  } else {
    EXPECT_TRUE(parallel.space.tool_spaces.empty());
  }
}

// As the filter has it: factors of single precision, of which those on the way into inverted states
// are not safe, third derivatives, and levels where there are signs of them.
TEST_F(Precompute, SoTheyDoWithFactorsOfSinglePrecision) {
  block_ = test::make_block(Law::st_venant_kirchhoff, {ElementOrder::linear});
  options_.active_nodes = {block_.corner, block_.middle};
  options_.half_width = 0.06;
  options_.history = History::automatic;
  options_.equilibrium.single_precision = true;
  options_.equilibrium.third_derivatives = true;
  const PrecomputeResult parallel = run(*world_);
  EXPECT_GT(parallel.report.num_by_flag.at(flags::inverted), 0);
  if (world_->rank() == 0) expect_equal(parallel.space, run(*serial_).space);
}

TEST_F(Precompute, WithoutAFactorTheSpaceIsTheSameOnAnyNumberOfRanks) {
  constexpr double kAgreement = 1e-7;
  // With a factor, v of a configuration from which none is reached has an error of 1e-4, which k
  // has the square of and the third derivative has some of.
  constexpr double kStiffnessAgreement = 1e-6;
  constexpr double kThirdDerivativeAgreement = 2e-3;
  options_.half_width = 0.008;
  options_.equilibrium.third_derivatives = true;
  options_.linear_solver = kConjugateGradients;
  const PrecomputeResult parallel = run(*world_);
  EXPECT_TRUE(parallel.report.complete);
  EXPECT_EQ(parallel.report.num_by_outcome.at(Outcome::converged), 250);
  if (world_->rank() != 0) return;
  expect_equal(parallel.space, run(*serial_).space);
  options_.linear_solver.clear();
  const PrecomputeResult with_factor = run(*serial_);
  for (std::size_t s = 0; s < parallel.space.tool_spaces.size(); ++s) {
    const auto& found = parallel.space.tool_spaces[s].configurations;
    const auto& exact = with_factor.space.tool_spaces[s].configurations;
    ASSERT_EQ(found.size(), exact.size());
    const double largest = largest_force(exact);
    for (std::size_t i = 0; i < exact.size(); ++i) {
      EXPECT_LE((found[i].force - exact[i].force).norm(), kAgreement * largest);
      EXPECT_LE((found[i].stiffness - exact[i].stiffness).norm(),
                kStiffnessAgreement * exact[i].stiffness.norm());
      EXPECT_LE((found[i].third_derivative - exact[i].third_derivative).norm(),
                kThirdDerivativeAgreement * exact[i].third_derivative.norm());
    }
  }
}

TEST_F(Precompute, AFileGivesTheSpaceOfTheMemoryAndIsOneFile) {
  const PrecomputeResult in_memory = run(*world_);
  options_.file = folder_ / "a.palpate";
  const PrecomputeResult in_file = run(*world_);
  const PrecomputeResult again = run(*world_);
  EXPECT_EQ(again.report.num_solved, 0);
  EXPECT_EQ(again.report.num_reused, 250);
  EXPECT_EQ(again.report.work.factorisations, 0);
  if (world_->rank() == 0) {
    expect_equal(in_file.space, in_memory.space);
    expect_equal(again.space, in_memory.space);
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator()), 1);
  }
}

TEST_F(Precompute, ALargerBoxAndAHigherForceLimitKeepWhatIsThere) {
  if (test::is_repetition(*world_)) GTEST_SKIP() << "it is the same on any number of ranks";
  options_.file = folder_ / "a.palpate";
  options_.force_limit = 0.1;
  options_.half_width = 0.01;
  options_.resolution = 3;
  const std::int64_t num_small = run(*world_).report.num_solved;
  options_.half_width = 0.02;  // the same spacing
  options_.resolution = 5;
  const PrecomputeResult larger = run(*world_);
  EXPECT_EQ(larger.report.num_reused, num_small);
  options_.force_limit = 0;
  const PrecomputeResult unlimited = run(*world_);
  EXPECT_EQ(unlimited.report.num_reused, num_small + larger.report.num_solved);
  EXPECT_EQ(
      unlimited.report.num_solved + unlimited.report.num_reused + unlimited.report.num_not_reached,
      250);
  EXPECT_GT(unlimited.report.num_solved, 0);
  options_.file.clear();
  const PrecomputeResult at_once = run(*serial_);
  ASSERT_EQ(unlimited.space.tool_spaces.size(), at_once.space.tool_spaces.size());
  for (std::size_t s = 0; s < at_once.space.tool_spaces.size(); ++s) {
    const auto& grown = unlimited.space.tool_spaces[s].configurations;
    const auto& whole = at_once.space.tool_spaces[s].configurations;
    ASSERT_EQ(grown.size(), whole.size());
    for (std::size_t c = 0; c < whole.size(); ++c) {
      EXPECT_EQ(grown[c].check_point, whole[c].check_point);
      // At the border of the smaller box no tangent was factorised.
      EXPECT_EQ(grown[c].flags & ~flags::inertia_not_computed,
                whole[c].flags & ~flags::inertia_not_computed);
      EXPECT_LE((grown[c].force - whole[c].force).norm(), 1e-6 * (1e-3 + whole[c].force.norm()));
    }
  }
}

TEST_F(Precompute, TheErrorOfTheMeshIsKeptWithEachConfiguration) {
  options_.active_nodes = {block_.middle};
  options_.half_width = 0.004;
  options_.estimate_mesh_error = true;
  options_.file = folder_ / "a.palpate";
  const PrecomputeResult found = run(*world_);
  const PrecomputeResult again = run(*world_);
  EXPECT_EQ(again.report.num_solved, 0);
  if (world_->rank() != 0) return;
  expect_equal(again.space, found.space);
  options_.file.clear();
  expect_equal(run(*serial_).space, found.space);

  // Its force is minus the gradient of its energy.
  const TouchToolSpace& space = found.space.tool_spaces[0];
  std::map<CheckPoint, const ConfigurationSummary*> at;
  double largest = 0;
  for (const ConfigurationSummary& c : space.configurations) {
    ASSERT_TRUE(c.mesh_error.is_known());
    EXPECT_LE(c.mesh_error.energy, 0);
    at[c.check_point] = &c;
    largest = std::max(largest, c.mesh_error.force.norm());
  }
  EXPECT_GT(largest, 0.01 * largest_force(space.configurations));
  const double spacing = space.setup.grid.spacing();
  int num_compared = 0;
  for (const auto& [check_point, c] : at) {
    for (int a = 0; a < 3; ++a) {
      CheckPoint before = check_point;
      CheckPoint after = check_point;
      --before[a];
      ++after[a];
      if (at.count(before) == 0 || at.count(after) == 0) continue;
      const double slope =
          (at[after]->mesh_error.energy - at[before]->mesh_error.energy) / (2 * spacing);
      EXPECT_NEAR(c->mesh_error.force[a], -slope, 0.01 * largest);
      ++num_compared;
    }
  }
  EXPECT_EQ(num_compared, 3 * 75);
}

TEST_F(Precompute, RestIsACheckPointWithoutForce) {
  if (test::is_repetition(*world_)) GTEST_SKIP() << "it is the same on any number of ranks";
  const PrecomputeResult result = run(*world_);
  for (const TouchToolSpace& tool_space : result.space.tool_spaces) {
    const auto& c = tool_space.configurations[tool_space.configurations.size() / 2];
    EXPECT_EQ(c.check_point, (CheckPoint{0, 0, 0}));
    EXPECT_EQ(c.force.norm(), 0);
    EXPECT_EQ(c.energy, 0);
  }
}

TEST_F(Precompute, ConfigurationsAreThoseThatTheSolverFinds) {
  if (test::is_repetition(*world_)) GTEST_SKIP() << "it is the same on any number of ranks";
  const PrecomputeResult result = run(*world_);
  EquilibriumSolver solver(block_.scene, {});
  for (const TouchToolSpace& tool_space : result.space.tool_spaces) {
    solver.set_interaction(bond_nodes({tool_space.setup.interaction.active_node}));
    for (std::size_t i = 0; i < tool_space.configurations.size(); i += 31) {
      const ConfigurationSummary& c = tool_space.configurations[i];
      const Equilibrium straight = solver.solve(c.t, solver.rest());
      ASSERT_EQ(straight.outcome, Outcome::converged);
      // Two ways to the same equilibrium: equal to the solver's tolerance.
      EXPECT_LE((straight.reaction - c.force).norm(), 1e-7 * (1e-3 + c.force.norm()));
    }
  }
}

TEST_F(Precompute, AnAbortKeepsWhatWasFoundAndTheNextRunGoesOnOnAnotherNumberOfRanks) {
  options_.file = folder_ / "a.palpate";
  progress_ = [](const ProgressState& state) { return state.share() < 0.5; };
  const PrecomputeResult part = run(*world_);
  EXPECT_FALSE(part.report.complete);
  EXPECT_GT(part.report.num_solved, 0);
  EXPECT_LT(part.report.num_solved, 250);
  progress_ = nullptr;
  if (world_->rank() != 0) return;
  EXPECT_FALSE(part.space.tool_spaces.empty());
  const PrecomputeResult rest = run(*serial_);
  EXPECT_GE(rest.report.num_reused, part.report.num_solved);
  EXPECT_EQ(rest.report.num_solved + rest.report.num_reused, 250);
  EXPECT_TRUE(rest.report.complete);
  options_.file.clear();
  expect_equal(rest.space, run(*serial_).space);
}

TEST_F(Precompute, AnAbortOnOneRankStopsTheOthersInTheMiddleOfTheirTasks) {
  options_.active_nodes = {block_.corner};
  options_.resolution = 11;
  const int last = world_->size() - 1;
  int calls = 0;
  progress_ = [&](const ProgressState&) { return world_->rank() != last || ++calls < 200; };
  for (int again = 0; again < 2; ++again) {
    calls = 0;
    const PrecomputeResult part = run(*world_);
    EXPECT_FALSE(part.report.complete);
    // Were the others to go on to the end, it would be all but one share.
    EXPECT_LT(part.report.num_solved, 11 * 11 * 11 / 3);
  }
  options_.resolution = 3;
  progress_ = nullptr;
  EXPECT_TRUE(run(*world_).report.complete);
}

TEST_F(Precompute, ProgressGrowsToTheEnd) {
  double last = 0;
  bool told = false;
  progress_ = [&](const ProgressState& state) {
    EXPECT_GE(state.share(), 0);
    EXPECT_LE(state.share(), 1);
    EXPECT_GE(state.seconds, 0);
    last = state.share();
    told = told || (state.seconds_left > 0 && state.num_expected > state.num_done);
    return true;
  };
  (void)run(*world_);
  EXPECT_EQ(last, 1);
  EXPECT_TRUE(told || world_->rank() != 0);
}

TEST_F(Precompute, AConfigurationBeyondTheForceLimitIsKeptAndNotExpanded) {
  if (test::is_repetition(*world_)) GTEST_SKIP() << "it is the same on any number of ranks";
  const PrecomputeResult all = run(*world_);
  options_.force_limit = 0.1;
  const PrecomputeResult limited = run(*world_);
  EXPECT_LT(limited.report.num_solved, all.report.num_solved);
  EXPECT_EQ(limited.report.num_solved + limited.report.num_not_reached, 250);
  EXPECT_GT(limited.report.num_by_flag.at(flags::beyond_force_limit), 0);
  for (const TouchToolSpace& tool_space : limited.space.tool_spaces) {
    for (const ConfigurationSummary& c : tool_space.configurations) {
      EXPECT_EQ((c.flags & flags::beyond_force_limit) != 0, c.force.norm() > 0.1);
    }
  }
}

// On the way down and back each start still has its factor, and a configuration from which no other
// is reached needs none of its own; at rest all tool spaces have the same. Where a rank takes over
// what follows from a start, the factor is made there again.
TEST_F(Precompute, ASmoothSpaceCostsOneFactorisationAStart) {
  options_.half_width = 0.005;
  options_.resolution = 7;
  const PrecomputeResult result = run(*world_);
  EXPECT_EQ(result.report.num_solved, 2 * 343);
  const long factorisations = result.report.work.factorisations;
  constexpr long kStarts = 2 * 125 - 1;  // the 5 x 5 x 5 inner check-points of both tool_spaces
  if (world_->size() == 1) {
    EXPECT_EQ(factorisations, kStarts);
  } else {
    EXPECT_GE(factorisations, kStarts);
    EXPECT_LE(factorisations, kStarts + world_->size() - 1 + result.report.schedule.steals_granted);
  }
  EXPECT_EQ(result.report.num_by_flag.at(flags::inertia_not_computed), 2 * 218);
}

// Far from rest steps fail, and are tried from other starts: on whichever rank has those.
TEST_F(Precompute, FailedStepsEndTheSameOnAnyNumberOfRanks) {
  options_.active_nodes = {block_.corner};
  options_.half_width = 0.05;
  options_.resolution = 7;
  options_.equilibrium.max_halvings = 0;
  options_.equilibrium.max_iterations = 16;
  options_.equilibrium.follow_folds = false;
  const PrecomputeResult parallel = run(*world_);
  options_.file = folder_ / "a.palpate";
  const PrecomputeResult in_file = run(*world_);
  const PrecomputeResult again = run(*world_);
  const auto& outcomes = parallel.report.num_by_outcome;
  ASSERT_EQ(outcomes.count(Outcome::not_converged), 1U);
  EXPECT_GT(outcomes.at(Outcome::converged), 100);
  EXPECT_EQ(again.report.num_solved, 0);
  EXPECT_EQ(again.report.num_reused, parallel.report.num_solved);
  EXPECT_EQ(again.report.num_by_outcome, outcomes);
  EXPECT_EQ(again.report.num_not_reached, parallel.report.num_not_reached);
  if (world_->rank() != 0) return;
  options_.file.clear();
  const PrecomputeResult serial = run(*serial_);
  EXPECT_EQ(serial.report.num_by_outcome, outcomes);
  EXPECT_EQ(serial.report.iterations, parallel.report.iterations);
  expect_equal(parallel.space, serial.space);
  expect_equal(in_file.space, serial.space);
  expect_equal(again.space, serial.space);
  // Some were reached from another start than the nearest to the straight way from rest.
  int from_elsewhere = 0;
  for (const ConfigurationSummary& c : serial.space.tool_spaces.front().configurations) {
    const CheckPoint& p = c.check_point;
    const std::int32_t layer = std::max({std::abs(p[0]), std::abs(p[1]), std::abs(p[2])});
    bool nearest = true;
    for (int i = 0; i < 3; ++i) {
      nearest = nearest && 2 * std::abs(layer * c.parent[i] - (layer - 1) * p[i]) <= layer;
    }
    from_elsewhere += c.usable() && !nearest ? 1 : 0;
  }
  EXPECT_GT(from_elsewhere, 0);
}

TEST_F(Precompute, ASmoothSceneTakesNoTransitionBetweenLevels) {
  options_.history = History::automatic;
  const PrecomputeResult result = run(*world_);
  EXPECT_EQ(result.report.num_transitions, 0);
  EXPECT_EQ(result.report.num_levels, 0);
  EXPECT_EQ(result.report.num_solved, 250);
}

TEST_F(Precompute, ATipOfFiniteSizeIsAnotherTool) {
  options_.active_nodes = {block_.corner};
  options_.resolution = 3;
  options_.half_width = 0.005;
  options_.tip_radius = 0.02;
  options_.file = folder_ / "a.palpate";
  const PrecomputeResult result = run(*world_);
  const BondedPatch held = BondedPatches(block_.scene.body, 0.02).around(block_.corner);
  EquilibriumSolver solver(block_.scene, {});
  EXPECT_EQ(result.report.num_unknowns,
            solver.assembly().pattern().size - 3 * static_cast<Index>(held.points().size()));
  if (world_->rank() == 0) {
    solver.set_interaction(held);
    const TouchToolSpace& tool_space = result.space.tool_spaces.front();
    EXPECT_EQ(tool_space.setup.interaction.tip_radius, 0.02);
    for (const ConfigurationSummary& c : tool_space.configurations) {
      const Equilibrium straight = solver.solve(c.t, solver.rest());
      EXPECT_LT((c.force - straight.reaction).norm(), 1e-7 * c.stiffness.norm() * 0.005);
    }
  }
  EXPECT_EQ(run(*world_).report.num_reused, 27);
  options_.tip_radius = 0;
  try {
    (void)run(*world_);
    ADD_FAILURE() << "no error";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("tip radius 0.02"), std::string::npos) << error.what();
  }
}

TEST_F(Precompute, PressuresOfMixedCellsAreKept) {
  block_ =
      test::make_block(Law::neo_hookean, {ElementOrder::quadratic, {3, 2, 2}, 0.1, 3000, 0.499});
  options_.active_nodes = {block_.corner};
  options_.resolution = 5;
  options_.half_width = 0.01;
  options_.file = folder_ / "a.palpate";
  const PrecomputeResult in_file = run(*world_);
  EXPECT_EQ(in_file.report.num_by_outcome.at(Outcome::converged), 125);
  if (world_->size() == 1) {
    EXPECT_EQ(in_file.report.work.factorisations, 125);
  }
  if (world_->rank() != 0) return;
  const StateSpace space = StateSpaceFile::open_read_only(options_.file).read(true);
  const Index num_pressures = Assembly(block_.scene).num_pressures();
  EXPECT_GT(num_pressures, 0);
  for (const Configuration& c : space.tool_spaces.front().configurations) {
    EXPECT_EQ(c.p.size(), num_pressures);
    EXPECT_EQ(c.p_v.rows(), num_pressures);
    EXPECT_EQ(c.p_v.cols(), 3);
  }
  options_.file.clear();
  expect_equal(in_file.space, run(*serial_).space);
}

TEST_F(Precompute, ALinearSceneIsFactorisedOnceForEachRank) {
  block_ = test::make_block(Law::linear, {ElementOrder::quadratic, {4, 3, 3}});
  const auto nearest = [&](const Vec3& place) {
    return test::nearest_point(block_.scene.body.mesh, place);
  };
  options_.active_nodes = {block_.corner, block_.middle, nearest({0.06, 0, 0.025}),
                           nearest({0.06, 0.06, 0.025}), nearest({0.06, 0.03, 0.05})};
  for (const double radius : {0.0, 0.013}) {
    options_.tip_radius = radius;
    const PrecomputeResult result = run(*world_);
    EXPECT_EQ(result.report.num_solved, 5 * 125);
    EXPECT_EQ(result.report.num_by_outcome.at(Outcome::converged), 5 * 125);
    EXPECT_EQ(result.report.iterations, 0);
    const Work& work = result.report.work;
    EXPECT_GE(work.factorisations, 1);
    EXPECT_LE(work.factorisations, world_->size());
    EXPECT_EQ(work.assemblies, world_->size());
    EXPECT_LT(work.right_hand_sides, result.report.num_solved) << "configurations cost no solve";
    for (const TouchToolSpace& tool_space : result.space.tool_spaces) {
      const ConfigurationSummary& rest = tool_space.configurations[62];
      for (const ConfigurationSummary& c : tool_space.configurations) {
        EXPECT_LE((c.force - rest.stiffness * c.t).norm(), 1e-9 * rest.stiffness.norm() * 0.02);
      }
    }
  }
}

TEST_F(Precompute, WithoutActiveNodesAllTouchableOnesAreTaken) {
  options_.active_nodes.clear();
  options_.resolution = 3;
  options_.half_width = 0.001;
  std::fill(block_.scene.body.touchable.begin(), block_.scene.body.touchable.end(), 0);
  block_.scene.body.touchable[block_.corner] = 1;
  block_.scene.body.touchable[block_.middle] = 1;
  EXPECT_EQ(run(*world_).report.num_solved, 2 * 27);
  std::fill(block_.scene.body.touchable.begin(), block_.scene.body.touchable.end(), 0);
  EXPECT_THROW((void)run(*world_), InputError);
}

// Its forces would be zero, all of them, as those of a space that has converged.
TEST_F(Precompute, ABoxThatTheBodyDoesNotResolveIsRefused) {
  options_.half_width = 1e-300;
  const std::string text = test::message_of([&] { (void)run(*world_); });
  EXPECT_NE(text.find("The half-width (HalfWidth) is 1e-300 m"), std::string::npos) << text;
}

TEST_F(Precompute, AFileOfAnotherSceneIsRefusedAndStaysAsItIs) {
  options_.resolution = 3;
  options_.file = folder_ / "a.palpate";
  (void)run(*world_);
  const auto size = fs::file_size(options_.file);
  block_ = test::make_block(Law::st_venant_kirchhoff);
  EXPECT_THROW((void)run(*world_), InputError);
  EXPECT_EQ(fs::file_size(options_.file), size);
  block_ = test::make_block(Law::neo_hookean);
  EXPECT_EQ(run(*world_).report.num_reused, 54);
}

TEST_F(Precompute, WhatAKilledRunLeftOfARemovedFileIsNotTakenForIts) {
  options_.resolution = 3;
  options_.file = folder_ / "a.palpate";
  const fs::path log = options_.file.string() + "-wal";
  agree(*world_, [&] {
    if (world_->rank() != 0) return;
    // A log beside a file that somebody has moved: the new file is not to be mixed with it, and it
    // may hold what was computed last.
    std::ofstream(log) << std::string(100000, 'x');
  });
  EXPECT_THROW((void)run(*world_), InputError);
  agree(*world_, [&] {
    if (world_->rank() != 0) return;
    EXPECT_TRUE(fs::exists(log));
    EXPECT_FALSE(fs::exists(options_.file));
    fs::rename(log, folder_ / "kept");
  });
  EXPECT_EQ(run(*world_).report.num_solved, 54);
  EXPECT_EQ(run(*world_).report.num_reused, 54);
  agree(*world_, [&] {
    if (world_->rank() == 0) fs::rename(options_.file, options_.file.string() + ".rank7");
  });
  EXPECT_THROW((void)run(*world_), InputError);
  if (world_->rank() == 0) {
    EXPECT_FALSE(fs::exists(options_.file));
    EXPECT_TRUE(fs::exists(options_.file.string() + ".rank7"));
  }
}

/// Without what they have in addition.
void remove_additions(TouchSpace& space) {
  for (TouchToolSpace& tool_space : space.tool_spaces) {
    tool_space.intermediate_states.clear();
    for (ConfigurationSummary& c : tool_space.configurations) {
      c.third_derivative.setConstant(std::numeric_limits<double>::quiet_NaN());
    }
  }
}

// [P08]: five between a start and its target.
TEST_F(Precompute, IntermediateStatesLieBetweenAStartAndItsTarget) {
  if (test::is_repetition(*world_)) GTEST_SKIP() << "it is the same on any number of ranks";
  make_small();
  options_.resolution = 3;
  PrecomputeResult plain = run(*world_);
  options_.intermediate_states = 5;
  options_.equilibrium.third_derivatives = true;
  options_.force_limit = 0.1;
  PrecomputeResult result = run(*world_);
  EXPECT_EQ(result.report.num_solved, 27);
  EXPECT_EQ(result.report.num_intermediate_states, 26 * 5);
  EXPECT_EQ(result.report.num_intermediate_states_failed, 0);
  EXPECT_GT(result.report.intermediate_seconds, 0);
  EXPECT_EQ(plain.report.num_intermediate_states, 0);
  const TouchToolSpace& tool_space = result.space.tool_spaces.front();
  EXPECT_EQ(tool_space.setup.policy.intermediate_states, 5);
  EXPECT_TRUE(tool_space.setup.policy.third_derivatives);
  ASSERT_EQ(tool_space.intermediate_states.size(), 26U * 5);
  EXPECT_TRUE(
      std::is_sorted(tool_space.intermediate_states.begin(), tool_space.intermediate_states.end()));
  EquilibriumSolver solver(block_.scene, {});
  solver.set_interaction(bond_nodes({block_.corner}));
  std::size_t next = 0;
  for (const ConfigurationSummary& c : tool_space.configurations) {
    EXPECT_TRUE(c.has_third_derivative());
    if (c.check_point == CheckPoint{}) continue;
    for (int number = 1; number <= 5; ++number) {
      const IntermediateState& state = tool_space.intermediate_states[next++];
      ASSERT_EQ(state.target, c.check_point);
      ASSERT_EQ(state.number, number);
      EXPECT_LT((state.t - number / 6.0 * c.t).norm(), 1e-15);
      EXPECT_EQ((state.flags & flags::beyond_force_limit) != 0, state.force.norm() > 0.1);
      if (number != 3) continue;
      const Equilibrium exact = solver.solve(state.t, solver.rest());
      EXPECT_LT((state.force - exact.reaction).norm(), 1e-7 * exact.reaction.norm());
      EXPECT_NEAR(state.energy, exact.energy, 1e-7 * exact.energy);
      EXPECT_GT(state.energy, 0);
      EXPECT_LT(state.energy, c.energy);
    }
  }
  // The configurations are what they are without them.
  options_.intermediate_states = 0;
  options_.equilibrium.third_derivatives = false;
  PrecomputeResult without = run(*serial_);
  remove_additions(result.space);
  expect_equal(result.space, without.space);
}

TEST_F(Precompute, WhatASpaceHoldsInAdditionIsTheSameOnAnyNumberOfRanksInAFileAndResumed) {
  make_small();
  options_.intermediate_states = 1;
  options_.equilibrium.third_derivatives = true;
  options_.half_width = 0.04;
  options_.force_limit = 0.4;
  const PrecomputeResult in_memory = run(*world_);
  options_.file = folder_ / "a.palpate";
  progress_ = [](const ProgressState& state) { return state.share() < 0.4; };
  const PrecomputeResult part = run(*world_);
  EXPECT_FALSE(part.report.complete);
  progress_ = nullptr;
  if (world_->rank() == 0) {
    // No target without the states on the way to it.
    const TouchToolSpace& tool_space = part.space.tool_spaces.front();
    std::int64_t num_targets = 0;
    for (const ConfigurationSummary& c : tool_space.configurations) {
      num_targets += c.usable() && c.check_point != CheckPoint{} ? 1 : 0;
    }
    EXPECT_EQ(static_cast<std::int64_t>(tool_space.intermediate_states.size()), num_targets);
    EXPECT_GT(num_targets, 0);
  }
  agree(*world_, [] {});
  const PrecomputeResult rest = run(*world_);
  EXPECT_TRUE(rest.report.complete);
  EXPECT_EQ(rest.report.num_reused + rest.report.num_solved, in_memory.report.num_solved);
  EXPECT_LT(rest.report.num_intermediate_states, in_memory.report.num_intermediate_states);
  const PrecomputeResult again = run(*world_);
  EXPECT_EQ(again.report.num_intermediate_states, 0);
  EXPECT_EQ(again.report.num_solved, 0);
  if (world_->rank() == 0) {
    EXPECT_EQ(
        static_cast<std::int64_t>(in_memory.space.tool_spaces.front().intermediate_states.size()),
        in_memory.report.num_intermediate_states);
    expect_equal(rest.space, in_memory.space);
    expect_equal(again.space, in_memory.space);
    options_.file.clear();
    expect_equal(run(*serial_).space, in_memory.space);
    options_.file = folder_ / "a.palpate";
  }
  options_.intermediate_states = 2;
  EXPECT_THROW((void)run(*world_), InputError);
  options_.intermediate_states = 1;
  options_.equilibrium.third_derivatives = false;
  EXPECT_THROW((void)run(*world_), InputError);
}

TEST_F(Precompute, NoIntermediateStatesAreSoughtOnTheWayToATargetThatFailed) {
  if (test::is_repetition(*world_)) GTEST_SKIP() << "it is the same on any number of ranks";
  make_small();
  options_.half_width = 0.05;
  options_.resolution = 5;
  options_.intermediate_states = 1;
  options_.equilibrium.max_halvings = 0;
  options_.equilibrium.max_iterations = 14;
  const PrecomputeResult result = run(*world_);
  const auto& outcomes = result.report.num_by_outcome;
  ASSERT_EQ(outcomes.count(Outcome::not_converged), 1U);
  EXPECT_EQ(result.report.num_intermediate_states, outcomes.at(Outcome::converged) - 1);
}

TEST_F(Precompute, ASpaceThatRefinesItselfHasIntermediateStatesToo) {
  make_small();
  options_.half_width = 0.03;
  options_.tolerance = 3e-4;
  options_.intermediate_states = 1;
  const PrecomputeResult result = run(*world_);
  EXPECT_GT(result.report.num_solved, 125);
  EXPECT_EQ(result.report.num_intermediate_states,
            result.report.num_by_outcome.at(Outcome::converged) - 1);
  if (world_->rank() != 0) return;
  const TouchToolSpace& tool_space = result.space.tool_spaces.front();
  for (const IntermediateState& state : tool_space.intermediate_states) {
    const auto target =
        std::find_if(tool_space.configurations.begin(), tool_space.configurations.end(),
                     [&](const ConfigurationSummary& c) { return c.check_point == state.target; });
    const auto start = std::find_if(
        tool_space.configurations.begin(), tool_space.configurations.end(),
        [&](const ConfigurationSummary& c) { return c.check_point == target->parent; });
    EXPECT_LT((state.t - 0.5 * (start->t + target->t)).norm(), 1e-15);
  }
}

TEST_F(Precompute, BadOptionsAreOneClearError) {
  const auto message = [this] {
    try {
      (void)run(*world_);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const PrecomputeOptions good = options_;
  options_.half_width = 0;
  EXPECT_NE(message().find("half-width"), std::string::npos);
  options_ = good;
  options_.resolution = 4;
  EXPECT_NE(message().find("resolution"), std::string::npos);
  options_ = good;
  options_.resolution = 1;
  EXPECT_NE(message().find("resolution"), std::string::npos);
  options_ = good;
  options_.tip_radius = -1;
  EXPECT_NE(message().find("tip radius"), std::string::npos);
  options_ = good;
  options_.tip_radius = 0.2;
  EXPECT_NE(message().find("is fixed"), std::string::npos);
  options_ = good;
  options_.force_limit = -1;
  EXPECT_NE(message().find("force limit"), std::string::npos);
  options_ = good;
  for (const int wrong : {-1, 101}) {
    options_.intermediate_states = wrong;
    EXPECT_NE(message().find("intermediate states"), std::string::npos);
  }
  options_ = good;
  options_.touch_bound = 2;
  EXPECT_FALSE(message().empty());
  options_ = good;
  options_.equilibrium.tolerance = 0;
  EXPECT_NE(message().find("tolerance"), std::string::npos);
  options_ = good;
  options_.active_nodes = {block_.scene.body.mesh.num_points()};
  EXPECT_NE(message().find("does not exist"), std::string::npos);
  options_ = good;
  options_.active_nodes = {0};  // held at x = 0
  EXPECT_NE(message().find("fixed"), std::string::npos);
  const std::vector<char> surface = boundary_points(block_.scene.body.mesh);
  options_.active_nodes = {
      static_cast<Index>(std::find(surface.begin(), surface.end(), 0) - surface.begin())};
  EXPECT_NE(message().find("inside"), std::string::npos);
  options_ = good;
  options_.file = folder_.path() / "missing" / "a.palpate";
  EXPECT_FALSE(message().empty());
}

}  // namespace
}  // namespace palpate::test::test_precompute
