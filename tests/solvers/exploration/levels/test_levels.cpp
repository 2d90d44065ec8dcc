// SPDX-License-Identifier: BSD-3-Clause
// The hinged cylindrical roof (solvers/equilibrium/test_roof.cpp), pressed at the middle of a free
// edge with a tool of 4 cm: there it snaps back in displacement, and stays stable up to both folds.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <tuple>
#include <vector>

#include "equilibrium/equilibrium.h"
#include "exploration/precompute.h"
#include "interaction/bonded_patch.h"
#include "interpolation/interpolator.h"
#include "interpolation/solution_branches.h"
#include "schedule/packing.h"
#include "solvers/support/block.h"
#include "solvers/support/bodies.h"
#include "solvers/support/communicators.h"
#include "storage/state_space_file.h"

namespace palpate::test::test_levels {
namespace {

namespace fs = std::filesystem;

/// Deflections at which the body leaves the branch of rest, and comes back to it, m.
struct Folds {
  double down = 0;
  double up = 0;
};

/// From the solver's own path: where its inner tangent loses and gains its last negative pivot.
Folds trace_folds(const Scene& scene, const BondedPatches& patches, Index node) {
  constexpr double kWay = 0.035;
  EquilibriumSolver solver(scene, {});
  solver.set_interaction(patches.around(node));
  PathOptions options;
  options.first_step = 0.01;
  const Path path = solver.trace(Vec3(0, 0, -kWay), solver.rest(), options);
  EXPECT_EQ(path.end.outcome, Outcome::converged) << path.end.summary.message;
  Folds folds;
  EXPECT_EQ(path.folds.size(), 1U);
  if (!path.folds.empty()) folds.down = kWay * path.folds.front().way;
  for (std::size_t i = 1; i < path.points.size(); ++i) {
    if (path.points[i - 1].negative_pivots > 0 && path.points[i].negative_pivots == 0) {
      folds.up = kWay * path.points[i].way;
    }
  }
  return folds;
}

auto all_of(const ConfigurationSummary& c) {
  return std::tuple(c.check_point, c.level, c.parent, c.parent_level, c.outcome, c.flags,
                    c.reached);
}

class RoofLevels : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    test::RoofOptions of_roof;
    of_roof.cells_arc = of_roof.cells_length = 2;
    test::Roof roof = test::make_roof(of_roof);
    node_ = test::nearest_point(roof.mesh, Vec3(0, of_roof.length / 2, of_roof.radius + 1));
    scene_ = std::make_unique<Scene>(
        test::make_scene(std::move(roof.mesh),
                         make_isotropic(Law::st_venant_kirchhoff, 3102.75e6, 0.3), roof.fixed));
    const auto world = test::make_world();
    if (world->rank() == 0) {
      serial_ = std::make_unique<PrecomputeResult>(run(*make_serial_communicator(), {}));
    }
    // The figures on every rank.
    Bytes mine;
    if (world->rank() == 0) {
      Packer figures;
      figures.put(serial_->report.num_solved);
      figures.put(serial_->report.num_transitions);
      figures.put(serial_->report.num_levels);
      mine = figures.take();
    }
    const std::vector<Bytes> all = world->all_gather(std::move(mine));
    Unpacker figures(all.front());
    num_solved_ = figures.take<std::int64_t>();
    num_transitions_ = figures.take<std::int64_t>();
    num_levels_ = figures.take<std::int64_t>();
  }
  static void TearDownTestSuite() {
    scene_.reset();
    serial_.reset();
  }

  static PrecomputeOptions options(const fs::path& file) {
    PrecomputeOptions options;
    options.keep = Keep::all;
    options.active_nodes = {node_};
    options.tip_radius = 0.04;
    options.half_width = 0.03;
    options.resolution = 15;
    options.force_limit = 3200;
    options.equilibrium.tolerance = 1e-9;
    options.equilibrium.single_precision = true;
    options.file = file;
    return options;
  }

  static PrecomputeResult run(Communicator& communicator, const fs::path& file,
                              const Progress& progress = nullptr) {
    return precompute(*scene_, options(file), communicator, progress);
  }

  static void expect_equal(const TouchSpace& a, const TouchSpace& b) {
    const auto& of_a = a.tool_spaces.front().configurations;
    const auto& of_b = b.tool_spaces.front().configurations;
    ASSERT_EQ(of_a.size(), of_b.size());
    for (std::size_t i = 0; i < of_a.size(); ++i) {
      EXPECT_EQ(all_of(of_a[i]), all_of(of_b[i]));
      EXPECT_EQ(of_a[i].energy, of_b[i].energy);
      EXPECT_EQ(of_a[i].force, of_b[i].force);
    }
    EXPECT_EQ(a.tool_spaces.front().coefficients, b.tool_spaces.front().coefficients);
  }

  static Index node_;
  static std::unique_ptr<Scene> scene_;
  /// On rank 0, null elsewhere.
  static std::unique_ptr<PrecomputeResult> serial_;
  static std::int64_t num_solved_;
  static std::int64_t num_transitions_;
  static std::int64_t num_levels_;
  std::unique_ptr<Communicator> world_ = test::make_world();
};

Index RoofLevels::node_ = 0;
std::unique_ptr<Scene> RoofLevels::scene_;
std::unique_ptr<PrecomputeResult> RoofLevels::serial_;
std::int64_t RoofLevels::num_solved_ = 0;
std::int64_t RoofLevels::num_transitions_ = 0;
std::int64_t RoofLevels::num_levels_ = 0;

TEST_F(RoofLevels, BothBranchesAreFoundAndTouchJumpsWhereTheBodyDoes) {
  EXPECT_GT(num_levels_, 0);
  EXPECT_GT(num_transitions_, num_levels_);
  if (world_->rank() != 0) return;
  const TouchToolSpace& tool_space = serial_->space.tool_spaces.front();
  const Folds folds = trace_folds(*scene_, BondedPatches(scene_->body, 0.04), node_);
  const double spacing = tool_space.setup.grid.spacing();

  // Between the folds both branches are there, and beyond them one is.
  for (std::int32_t k = 1; k <= tool_space.setup.grid.reach(); ++k) {
    const auto num = std::count_if(tool_space.configurations.begin(),
                                   tool_space.configurations.end(), [&](const auto& c) {
                                     return c.check_point == CheckPoint{0, 0, -k} && c.usable() &&
                                            (c.flags & flags::unstable) == 0;
                                   });
    const double deflection = k * spacing;
    EXPECT_EQ(num, deflection > folds.up && deflection < folds.down ? 2 : 1) << deflection;
  }

  const SolutionBranches branches(tool_space);
  ASSERT_EQ(branches.size(), 2);
  std::vector<std::unique_ptr<Interpolator>> on_branch;
  for (int s = 0; s < 2; ++s) {
    on_branch.push_back(make_interpolator(Method::energy_hermite,
                                          restricted(tool_space, branches.configurations(s))));
  }
  int branch = 0;
  double down = 0;
  double up = 0;
  Vec3 at = Vec3::Zero();
  const auto move_to = [&](double deflection) {
    const Vec3 next(0, 0, -deflection);
    const int before = branch;
    branch = branches.move(branch, at, next);
    at = next;
    if (branch > before) down = deflection;
    if (branch < before) up = deflection;
    EXPECT_EQ(on_branch[static_cast<std::size_t>(branch)]->evaluate(at).support, Support::inside);
  };
  for (int i = 0; i <= 300; ++i) move_to(1e-4 * i);
  for (int i = 300; i >= 0; --i) move_to(1e-4 * i);
  EXPECT_NEAR(down, folds.down, spacing);
  EXPECT_NEAR(up, folds.up, spacing);
  EXPECT_EQ(branch, 0);
}

TEST_F(RoofLevels, SeveralRanksGiveTheSpaceOfOne) {
  if (world_->size() == 1) GTEST_SKIP() << "on one rank";
  const PrecomputeResult parallel = run(*world_, {});
  EXPECT_EQ(parallel.report.num_transitions, num_transitions_);
  EXPECT_EQ(parallel.report.num_levels, num_levels_);
  EXPECT_EQ(parallel.report.num_solved, num_solved_);
  if (world_->rank() == 0) expect_equal(parallel.space, serial_->space);
}

TEST_F(RoofLevels, AnAbortedRunGoesOnAndMakesNoTransitionTwice) {
  const fs::path folder =
      fs::temp_directory_path() / ("palpate_levels_" + std::to_string(world_->size()));
  if (world_->rank() == 0) {
    fs::remove_all(folder);
    fs::create_directory(folder);
  }
  agree(*world_, [] {});
  const fs::path file = folder / "roof.palpate";
  // Among the transitions between levels, and so early that rank 0, which hears twice a second of
  // the others, does not come too late on a busy machine.
  const std::int64_t enough = 4 * num_solved_ / 5;
  const PrecomputeResult aborted = run(*world_, file, [&](const ProgressState& state) {
    return world_->rank() != 0 || state.num_done < enough;
  });
  EXPECT_FALSE(aborted.report.complete);
  const PrecomputeResult resumed = run(*world_, file);
  EXPECT_TRUE(resumed.report.complete);
  // Of the last ones before the abort the owners had not heard, but they were kept.
  EXPECT_LE(aborted.report.num_transitions + resumed.report.num_transitions, num_transitions_);
  EXPECT_GT(aborted.report.num_transitions, 0);
  const PrecomputeResult again = run(*world_, file);
  EXPECT_EQ(again.report.num_solved, 0);
  EXPECT_EQ(again.report.num_transitions, 0);
  if (world_->rank() == 0) {
    expect_equal(resumed.space, serial_->space);
    expect_equal(again.space, serial_->space);
    EXPECT_TRUE(StateSpaceFile::open_read_only(file).read_candidates({node_}).empty());
  }
  agree(*world_, [] {});
  if (world_->rank() == 0) fs::remove_all(folder);
}

}  // namespace
}  // namespace palpate::test::test_levels
