// SPDX-License-Identifier: BSD-3-Clause
// Patch test: an affine displacement of the surface is affine inside, and the stress is uniform.
#include <gtest/gtest.h>

#include <tuple>
#include <utility>
#include <vector>

#include "equilibrium/equilibrium.h"
#include "interaction/bonded_patch.h"
#include "solvers/equilibrium/options.h"
#include "solvers/materials/point.h"
#include "solvers/support/block.h"
#include "solvers/support/box_mesh.h"
#include "solvers/support/laws.h"
#include "solvers/support/orders.h"
#include "solvers/support/random.h"

namespace palpate::test::test_patch {
namespace {

/// The solver's tolerance is 1e-13 of the forces; the condition number adds some digits.
constexpr double kTolerance = 1e-13;
constexpr double kAccuracy = 1e-10;

class Patch : public testing::TestWithParam<std::tuple<ElementOrder, Law>> {};
INSTANTIATE_TEST_SUITE_P(Each, Patch,
                         testing::Combine(testing::ValuesIn(kOrders), testing::ValuesIn(kLaws)),
                         [](const testing::TestParamInfo<std::tuple<ElementOrder, Law>>& each) {
                           return name_of_order({std::get<0>(each.param), 0}) +
                                  letters(to_string(std::get<1>(each.param)));
                         });

TEST_P(Patch, AnAffineSurfaceGivesAnAffineBody) {
  const auto [order, law] = GetParam();
  const bool quadratic = order == ElementOrder::quadratic;
  const std::array<int, 3> cells = quadratic ? std::array{2, 2, 2} : std::array{3, 3, 3};
  TetMesh mesh = make_box(order, cells, Vec3(1, 1, 1));
  const auto on_boundary = boundary_points(mesh);
  warp_straight(mesh, wavy(Vec3(1, 1, 1)));
  // The scene wants a fixed point: the first corner stays, the others of the surface are moved.
  std::vector<char> fixed(mesh.points.size(), 0);
  fixed[0] = 1;
  std::vector<Index> surface;
  for (Index p = 1; p < mesh.num_points(); ++p) {
    if (on_boundary[p] != 0) surface.push_back(p);
  }
  ASSERT_GT(mesh.num_points(), static_cast<Index>(surface.size()) + 1) << "nothing is inside";
  const Material material = make_material(law, 1000, 0.3);
  const Scene scene = make_scene(mesh, material, fixed);
  EquilibriumSolver solver(scene, with_tolerance(kTolerance));
  solver.set_interaction(bond_nodes(surface));

  Random random(71);
  const Mat3 h = random.matrix(0.15);
  const auto affine = [&](Index p) -> Vec3 { return h * (mesh.points[p] - mesh.points[0]); };
  Eigen::VectorXd t(3 * surface.size());
  for (std::size_t i = 0; i < surface.size(); ++i) t.segment<3>(3 * i) = affine(surface[i]);

  // Once from rest, where the predictor is the solution, and once from elsewhere.
  const Equilibrium rest = solver.rest();
  const Equilibrium elsewhere = solver.solve(0.5 * t + random.vector(t.size(), 0.02), rest);
  ASSERT_EQ(elsewhere.outcome, Outcome::converged);
  for (const Equilibrium& start : {rest, elsewhere}) {
    const Equilibrium state = solver.solve(t, start);
    ASSERT_EQ(state.outcome, Outcome::converged) << state.summary.message;
    for (Index p = 0; p < mesh.num_points(); ++p) {
      EXPECT_LT((state.u.segment<3>(3 * p) - affine(p)).norm(), kAccuracy) << "point " << p;
    }
    const double det_f = (Mat3::Identity() + h).determinant();
    EXPECT_NEAR(state.minimum_det_f, det_f, kAccuracy);
    EXPECT_NEAR(state.energy, volume(mesh) * respond(material, h).energy, kAccuracy * state.energy);
    // ∫ P over the body is the sum of forces times places.
    Mat3 sum = Mat3::Zero();
    for (std::size_t i = 0; i < surface.size(); ++i) {
      sum +=
          state.reaction.segment<3>(3 * i) * (mesh.points[surface[i]] - mesh.points[0]).transpose();
    }
    const Mat3 expected = volume(mesh) * first_piola(material, h);
    EXPECT_LT((sum - expected).norm(), kAccuracy * expected.norm());
  }
}

}  // namespace
}  // namespace palpate::test::test_patch
