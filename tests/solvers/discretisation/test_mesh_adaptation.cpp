// SPDX-License-Identifier: BSD-3-Clause
#include "discretisation/mesh_adaptation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "assembly/refined_scene.h"
#include "discretisation/mesh_error_estimate.h"
#include "equilibrium/equilibrium.h"
#include "interaction/mesh_error.h"
#include "interaction/rigid_tool.h"
#include "solvers/support/block.h"
#include "solvers/support/box_mesh.h"
#include "solvers/support/laws.h"
#include "solvers/support/message_of.h"

namespace palpate::test::test_mesh_adaptation {
namespace {

const Vec3 kSize(0.1, 0.08, 0.05);
constexpr double kRadius = 0.012;

/// A block, held below, that a ball presses from above.
Scene make_pressed_block() {
  TetMesh mesh = test::make_box(ElementOrder::quadratic, {4, 3, 2}, kSize);
  warp_straight(mesh, wavy_inside(kSize));
  std::vector<char> fixed;
  for (const Vec3& x : mesh.points) fixed.push_back(x.z() < 1e-9 ? 1 : 0);
  return test::make_scene(mesh, palpate::make_isotropic(Law::neo_hookean, 3000, 0.4), fixed);
}

/// A ball that is pressed in from above at each of these places.
std::vector<TouchOnMesh> press(const Scene& scene, const std::vector<Vec3>& places, double depth) {
  // Eigen takes long for a factor of a fine mesh.
  const bool is_fine = scene.body.mesh.num_cells() > 1000;
  EquilibriumSolver solver(scene, EquilibriumOptions(), is_fine ? nullptr : make_linear_solver());
  const MeshErrorEstimator estimator(scene, solver.assembly());
  RigidTool tool;
  tool.radius = kRadius;
  const RigidContact contact = make_contact(scene.body, with_defaults(tool, scene));
  solver.set_interaction(contact);
  std::vector<TouchOnMesh> touches;
  for (const Vec3& place : places) {
    const Vec3 above(place.x(), place.y(), kSize.z() + kRadius);
    const Equilibrium state = solver.solve(above - depth * Vec3::UnitZ(),
                                           solver.rest(above + 0.3 * kRadius * Vec3::UnitZ()));
    const MeshErrorEstimate estimate = estimator.estimate(state, contact);
    touches.push_back({state.reaction,
                       estimate.force,
                       state.outcome == Outcome::converged && estimate.is_small,
                       estimate.is_reliable,
                       estimate.energy_of_cells,
                       {}});
  }
  return touches;
}

Index cells_near(const TetMesh& mesh, const Vec3& place, double distance) {
  Index count = 0;
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    if ((mesh.points[mesh.cell(c)[0]] - place).norm() < distance) ++count;
  }
  return count;
}

TEST(MeshAdaptation, ReachesTheToleranceWithFewCells) {
  const Scene scene = make_pressed_block();
  const std::vector<Vec3> places{{0.03, 0.035, kSize.z()}};
  AdaptationOptions options;
  options.tolerance = 0.08;
  const AdaptedMesh adapted = adapt_mesh(
      scene, options,
      [&](const Scene& on, const MeshHints& /*hints*/) { return press(on, places, 0.004); });
  EXPECT_EQ(adapted.end, AdaptationEnd::reached);
  ASSERT_EQ(adapted.rounds.size(), adapted.refinements.size() + 1);
  EXPECT_LE(kMostOfEstimate * adapted.rounds.back().errors[0], options.tolerance);
  EXPECT_GT(kMostOfEstimate * adapted.rounds.front().errors[0], 2 * options.tolerance);

  // The truth: all cells of the adapted mesh divided, the rest of the error estimated.
  const auto divided = [](const Scene& of) { return refined(of, refine_all(of.body.mesh)); };
  const TouchOnMesh fine = press(divided(adapted.scene), places, 0.004)[0];
  const Eigen::VectorXd truth = fine.force - fine.error;
  const auto error_of = [&](const Scene& of) {
    return (press(of, places, 0.004)[0].force - truth).norm() / truth.norm();
  };
  EXPECT_LE(error_of(adapted.scene), options.tolerance);
  // Eight times as many cells, the same everywhere, are not as good.
  const Scene uniform = divided(scene);
  EXPECT_GT(uniform.body.mesh.num_cells(), adapted.scene.body.mesh.num_cells());
  EXPECT_GT(error_of(uniform), error_of(adapted.scene));

  const TetMesh& mesh = adapted.scene.body.mesh;
  EXPECT_GT(cells_near(mesh, places[0], 0.02),
            4 * cells_near(mesh, Vec3(0.07, 0.035, kSize.z()), 0.02));
}

TEST(MeshAdaptation, IsFineAtEachPlace) {
  const std::vector<Vec3> places{{0.025, 0.04, kSize.z()}, {0.075, 0.04, kSize.z()}};
  AdaptationOptions options;
  options.tolerance = 0.2;
  const AdaptedMesh adapted = adapt_mesh(
      make_pressed_block(), options,
      [&](const Scene& on, const MeshHints& /*hints*/) { return press(on, places, 0.004); });
  EXPECT_EQ(adapted.end, AdaptationEnd::reached);
  for (const double error : adapted.rounds.back().errors) EXPECT_LE(1.5 * error, 0.2);
}

/// A touch with an error in the first cell.
TouchOnMesh made_up(const Scene& scene, double error) {
  TouchOnMesh touch;
  touch.force = Vec3(0, 0, 2);
  touch.error = Vec3(0, 0, 2 * error);
  touch.energy_of_cells.assign(static_cast<std::size_t>(scene.body.mesh.num_cells()), 0);
  touch.energy_of_cells[0] = 1;
  return touch;
}

TEST(MeshAdaptation, LeavesAMeshThatIsFineEnoughAsItIs) {
  const Scene scene = make_pressed_block();
  const AdaptedMesh adapted =
      adapt_mesh(scene, {}, [&](const Scene& on, const MeshHints& /*hints*/) {
        return std::vector<TouchOnMesh>{made_up(on, 0.01)};
      });
  EXPECT_EQ(adapted.end, AdaptationEnd::reached);
  EXPECT_TRUE(adapted.refinements.empty());
  EXPECT_EQ(hash(adapted.scene), hash(scene));
}

TEST(MeshAdaptation, AsksForMoreOfAnEstimateThatIsNotReliable) {
  const Scene scene = make_pressed_block();
  const auto is_refined = [&](double error, bool is_reliable, bool is_corrected) {
    AdaptationOptions options;
    options.tolerance = 0.05;
    options.is_corrected = is_corrected;
    options.max_cells = scene.body.mesh.num_cells();
    const auto touch = [&](const Scene& on, const MeshHints& /*hints*/) {
      TouchOnMesh told = made_up(on, error);
      told.is_reliable = is_reliable;
      return std::vector<TouchOnMesh>{told};
    };
    return adapt_mesh(scene, options, touch).end == AdaptationEnd::too_many_cells;
  };
  EXPECT_FALSE(is_refined(0.03, true, false));
  EXPECT_TRUE(is_refined(0.03, false, false));
  EXPECT_FALSE(is_refined(0.024, false, false));
  EXPECT_FALSE(is_refined(0.06, true, true));
  EXPECT_TRUE(is_refined(0.06, false, true));
  EXPECT_FALSE(is_refined(0.04, false, true));
}

TEST(MeshAdaptation, EndsBeforeThereAreTooManyCells) {
  const Scene scene = make_pressed_block();
  AdaptationOptions options;
  options.max_cells = scene.body.mesh.num_cells() + 200;
  const AdaptedMesh adapted =
      adapt_mesh(scene, options, [&](const Scene& on, const MeshHints& /*hints*/) {
        return std::vector<TouchOnMesh>{made_up(on, 0.3)};
      });
  EXPECT_EQ(adapted.end, AdaptationEnd::too_many_cells);
  EXPECT_LE(adapted.scene.body.mesh.num_cells(), options.max_cells);
  EXPECT_GE(adapted.refinements.size(), 1U);
  // Most of what is allowed is used.
  EXPECT_GT(adapted.scene.body.mesh.num_cells(), options.max_cells - 100);
}

TEST(MeshAdaptation, DividesCellsThatAreTooLargeForTheEstimateInAnyCase) {
  const Scene scene = make_pressed_block();
  const auto touch = [&](const Scene& on, const MeshHints& /*hints*/) {
    TouchOnMesh told = made_up(on, 0.001);
    // On the first mesh.
    if (on.body.mesh.num_cells() == scene.body.mesh.num_cells()) told.coarse_cells = {3, 7};
    return std::vector<TouchOnMesh>{told};
  };
  AdaptationOptions options;
  const AdaptedMesh adapted = adapt_mesh(scene, options, touch);
  EXPECT_EQ(adapted.end, AdaptationEnd::reached);
  ASSERT_EQ(adapted.chosen.size(), 1U);
  for (std::size_t c = 0; c < adapted.chosen[0].size(); ++c) {
    EXPECT_EQ(adapted.chosen[0][c] != 0, c == 3 || c == 7);
  }
  EXPECT_EQ(adapted.rounds[0].is_coarse, std::vector<char>{1});
  EXPECT_EQ(adapted.rounds[1].is_coarse, std::vector<char>{0});
  // Also where their number is limited.
  options.max_cells = scene.body.mesh.num_cells() + 1;
  EXPECT_EQ(adapt_mesh(scene, options, touch).end, AdaptationEnd::too_many_cells);
}

TEST(MeshAdaptation, EndsWhereNothingSaysWhichCellsToDivide) {
  const AdaptedMesh adapted =
      adapt_mesh(make_pressed_block(), {}, [&](const Scene& on, const MeshHints& /*hints*/) {
        TouchOnMesh touch = made_up(on, 0.3);
        touch.is_known = false;
        touch.energy_of_cells.assign(touch.energy_of_cells.size(), 0);
        return std::vector<TouchOnMesh>{touch};
      });
  EXPECT_EQ(adapted.end, AdaptationEnd::not_known);
  EXPECT_TRUE(adapted.refinements.empty());
}

TEST(MeshAdaptation, DoesNotKnowTheErrorOfAToolThatFeelsNothing) {
  AdaptationOptions options;
  options.tolerance = 0.1;
  const AdaptedMesh adapted =
      adapt_mesh(make_pressed_block(), options, [](const Scene& on, const MeshHints& /*hints*/) {
        TouchOnMesh none = made_up(on, 0);
        none.force.setZero();
        return std::vector<TouchOnMesh>{made_up(on, on.body.mesh.num_cells() > 150 ? 0.01 : 0.3),
                                        none};
      });
  EXPECT_EQ(adapted.end, AdaptationEnd::not_known);
  EXPECT_EQ(adapted.rounds.back().is_known, (std::vector<char>{1, 0}));
  EXPECT_EQ(adapted.rounds.back().is_given_up, (std::vector<char>{0, 1}));
}

TEST(MeshAdaptation, EndsWhereTheErrorStaysUnknown) {
  const double nothing = std::numeric_limits<double>::quiet_NaN();
  const AdaptedMesh adapted =
      adapt_mesh(make_pressed_block(), {}, [&](const Scene& on, const MeshHints& /*hints*/) {
        TouchOnMesh touch = made_up(on, 0.01);
        touch.is_known = false;
        touch.error.setConstant(nothing);
        touch.energy_of_cells.back() = nothing;
        return std::vector<TouchOnMesh>{touch};
      });
  EXPECT_EQ(adapted.end, AdaptationEnd::not_known);
  EXPECT_EQ(adapted.rounds.size(), 3U);
  EXPECT_EQ(adapted.rounds.back().is_known[0], 0);
}

// As where the small cells at the rim of what is held are turned inside out.
TEST(MeshAdaptation, GoesBackToTheFinestMeshOnWhichTheErrorIsKnown) {
  int meshes = 0;
  std::vector<Index> cells;
  const AdaptedMesh adapted =
      adapt_mesh(make_pressed_block(), {}, [&](const Scene& on, const MeshHints& /*hints*/) {
        TouchOnMesh touch = made_up(on, 0.2);
        touch.is_known = meshes++ < 3;
        cells.push_back(on.body.mesh.num_cells());
        return std::vector<TouchOnMesh>{touch};
      });
  EXPECT_EQ(adapted.end, AdaptationEnd::not_known);
  EXPECT_EQ(meshes, 5);
  ASSERT_EQ(adapted.rounds.size(), 3U);
  EXPECT_EQ(adapted.rounds.back().is_known[0], 1);
  EXPECT_EQ(adapted.scene.body.mesh.num_cells(), cells[2]);
  EXPECT_EQ(adapted.refinements.size(), 2U);
  EXPECT_EQ(adapted.chosen.size(), 2U);
  ASSERT_EQ(adapted.left.size(), 2U);
  EXPECT_EQ(adapted.left.back().num_cells, cells[4]);
}

// What the estimate does not see: a force that goes on changing.
TEST(MeshAdaptation, GoesOnWhileTheForceChanges) {
  int meshes = 0;
  const AdaptedMesh adapted =
      adapt_mesh(make_pressed_block(), {}, [&](const Scene& on, const MeshHints& /*hints*/) {
        TouchOnMesh touch = made_up(on, meshes == 0 ? 0.1 : 0.01);
        touch.force[1] = meshes < 3 ? 0.2 * meshes : 0.6;
        ++meshes;
        return std::vector<TouchOnMesh>{touch};
      });
  EXPECT_EQ(adapted.end, AdaptationEnd::reached);
  ASSERT_EQ(meshes, 5);
  EXPECT_TRUE(std::isnan(adapted.rounds.front().changes[0]));
  EXPECT_NEAR(adapted.rounds[3].changes[0], 0.2 / std::hypot(2, 0.6), 1e-12);
  EXPECT_EQ(adapted.rounds.back().changes[0], 0);
}

TEST(MeshAdaptation, StopsWhereNothingIsReturned) {
  const AdaptedMesh adapted =
      adapt_mesh(make_pressed_block(), {},
                 [](const Scene&, const MeshHints&) { return std::vector<TouchOnMesh>(); });
  EXPECT_EQ(adapted.end, AdaptationEnd::stopped);
}

TEST(MeshAdaptation, LeavesATouchThatIsExactEnoughAndOneThatIsNeverKnown) {
  int meshes = 0;
  AdaptationOptions options;
  options.touches_again = false;
  const auto touch = [&](const Scene& on, const MeshHints& hints) {
    const std::vector<char>& needed = hints.needed;
    EXPECT_EQ(hints.refinement == nullptr, meshes == 0);
    std::vector<TouchOnMesh> touches = {made_up(on, 0.01), made_up(on, meshes < 4 ? 0.2 : 0.01),
                                        made_up(on, 0.6)};
    touches[2].is_known = false;
    if (meshes == 0) {
      EXPECT_TRUE(needed.empty());
    } else {
      EXPECT_EQ(needed, (std::vector<char>{0, 1, static_cast<char>(meshes < 3 ? 1 : 0)}));
      for (std::size_t i = 0; i < needed.size(); ++i) {
        if (needed[i] == 0) touches[i] = {};
      }
    }
    ++meshes;
    return touches;
  };
  const AdaptedMesh adapted = adapt_mesh(make_pressed_block(), options, touch);
  // After the fifth mesh the force less its error has changed, so that there is one more.
  EXPECT_EQ(meshes, 6) << "the third touch does not end it";
  EXPECT_EQ(adapted.end, AdaptationEnd::not_known);
  EXPECT_EQ(adapted.rounds.back().is_given_up, (std::vector<char>{0, 0, 1}));
  EXPECT_DOUBLE_EQ(adapted.rounds.back().errors[0], adapted.rounds.front().errors[0]);
  ASSERT_EQ(adapted.chosen.size(), adapted.refinements.size());
  EXPECT_EQ(refine(adapted.refinements.front().mesh, adapted.chosen[1]).mesh.cells,
            adapted.refinements[1].mesh.cells);
}

TEST(MeshAdaptation, OfACorrectedForceAsksForWhatIsLeft) {
  AdaptationOptions options;
  options.tolerance = 0.05;
  const auto run = [&](double error) {
    return adapt_mesh(make_pressed_block(), options,
                      [&](const Scene& on, const MeshHints& /*hints*/) {
                        return std::vector<TouchOnMesh>{made_up(on, error)};
                      })
        .end;
  };
  options.max_cells = 500;
  EXPECT_EQ(run(0.09), AdaptationEnd::too_many_cells);
  options.is_corrected = true;
  EXPECT_EQ(run(0.09), AdaptationEnd::reached);
  EXPECT_EQ(run(0.11), AdaptationEnd::too_many_cells);
}

TEST(MeshAdaptation, RefusesOptionsWithoutMeaning) {
  const auto run = [](double tolerance, Index max_cells) {
    AdaptationOptions options;
    options.tolerance = tolerance;
    options.max_cells = max_cells;
    return test::message_of([&] {
      (void)adapt_mesh(make_pressed_block(), options,
                       [](const Scene&, const MeshHints&) { return std::vector<TouchOnMesh>(); });
    });
  };
  EXPECT_NE(run(0, 10).find("Give a share above 0"), std::string::npos);
  EXPECT_NE(run(std::nan(""), 10).find("Give a share above 0"), std::string::npos);
  EXPECT_NE(run(0.1, 0).find("Give at least 1"), std::string::npos);
}

}  // namespace
}  // namespace palpate::test::test_mesh_adaptation
