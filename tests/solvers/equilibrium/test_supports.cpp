// SPDX-License-Identifier: BSD-3-Clause
// Bodies that planes of symmetry, springs, pressures and tractions hold and load.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "equilibrium/equilibrium.h"
#include "interaction/bonded_patch.h"
#include "solvers/equilibrium/options.h"
#include "solvers/support/bodies.h"
#include "solvers/support/box_mesh.h"
#include "solvers/support/laws.h"
#include "solvers/support/message_of.h"
#include "solvers/support/orders.h"
#include "solvers/support/sectors.h"
#include "solvers/support/solvable.h"

namespace palpate::test::test_supports {
namespace {

const Vec3 kSize(0.05, 0.04, 0.04);

class Supports : public testing::TestWithParam<ElementOrder> {};
INSTANTIATE_TEST_SUITE_P(Each, Supports, testing::ValuesIn(kOrders), name_of_order);

void push(Scene& scene) {
  for (const Vec3& p : scene.body.mesh.points) {
    const bool is_above = p.z() > kSize.z() - 1e-9;
    scene.body.applied_traction.push_back(is_above ? Vec3(0, 60, -90) : Vec3::Zero());
    scene.body.support_stiffness.push_back(p.y() < 1e-9 ? 2e4 : 0);
  }
}

std::vector<char> fixed_below(const TetMesh& mesh) {
  std::vector<char> fixed;
  for (const Vec3& p : mesh.points) fixed.push_back(p.z() == 0 ? 1 : 0);
  return fixed;
}

/// Half of a body that is its own mirror image in x = 0, held along x there.
Scene half_body(ElementOrder order) {
  TetMesh mesh = make_box(order, {2, 2, 2}, kSize);
  const std::vector<char> fixed = fixed_below(mesh);
  Scene scene = make_scene(mesh, make_material(Law::neo_hookean, 3000, 0.35), fixed);
  push(scene);
  hold_plane(scene, Vec3::UnitX(), 0);
  return scene;
}

/// The whole body, see with_mirror_image().
Scene whole_body(const Scene& half, std::vector<Index>& twin) {
  TetMesh mesh = with_mirror_image(half.body.mesh, twin);
  const std::vector<char> fixed = fixed_below(mesh);
  Scene scene = make_scene(std::move(mesh), half.organ.materials.front(), fixed);
  push(scene);
  return scene;
}

TEST_P(Supports, HalfOfASymmetricBodyIsAsTheWhole) {
  // Both are as near to the equilibrium as rounding allows.
  constexpr double kRounding = 1e-9;
  const Scene half = half_body(GetParam());
  std::vector<Index> twin;
  const Scene whole = whole_body(half, twin);
  const Index node = nearest_point(half.body.mesh, kSize);
  const Vec3 t(0.002, 0.001, -0.003);
  const Eigen::DiagonalMatrix<double, 3> mirror(-1, 1, 1);

  InteractionList both;
  both.add(BondedPatch({node}));
  both.add(BondedPatch({twin[node]}));
  Eigen::VectorXd of_both(6);
  of_both << t, mirror * t;
  EquilibriumSolver of_whole(whole, with_tolerance(1e-12));
  of_whole.set_interaction(both);
  const Equilibrium expected = of_whole.solve(of_both, of_whole.rest());
  ASSERT_EQ(expected.outcome, Outcome::converged) << expected.summary.message;

  // Along x, and along any other axis when all is turned; without a factor too.
  const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, -1).normalized()).toRotationMatrix();
  for (const Mat3& r : {Mat3(Mat3::Identity()), turn}) {
    Scene turned = half;
    for (Vec3& p : turned.body.mesh.points) p = r * p;
    for (Vec3& traction : turned.body.applied_traction) traction = r * traction;
    for (HeldDirections& held : turned.body.held_directions) held = r * held;
    for (const bool has_factor : {true, false}) {
      EquilibriumSolver solver(turned, with_tolerance(has_factor ? 1e-12 : 1e-11),
                               has_factor ? make_linear_solver() : nullptr);
      ASSERT_EQ(solver.settled().outcome, Outcome::converged) << solver.settled().summary.message;
      const NodalVector& rest = of_whole.settled().u;
      for (Index p = 0; p < half.body.mesh.num_points(); ++p) {
        const Eigen::Index at = 3 * Eigen::Index{p};
        ASSERT_LT((solver.settled().u.segment<3>(at) - r * rest.segment<3>(at)).norm(),
                  kRounding * kSize.norm());
      }
      solver.set_interaction(BondedPatch({node}));
      const Equilibrium found = solver.solve(r * t, solver.rest());
      ASSERT_EQ(found.outcome, Outcome::converged) << found.summary.message;
      for (Index p = 0; p < half.body.mesh.num_points(); ++p) {
        const Eigen::Index at = 3 * Eigen::Index{p};
        ASSERT_LT((found.u.segment<3>(at) - r * expected.u.segment<3>(at)).norm(),
                  kRounding * kSize.norm());
        if (half.body.mesh.points[p].x() == 0) {
          ASSERT_LT(std::abs((r.transpose() * found.u.segment<3>(at)).x()), 1e-16);
        }
      }
      EXPECT_LT((found.reaction - r * expected.reaction.head<3>()).norm(),
                1e-7 * expected.reaction.norm());
      EXPECT_NEAR(2 * found.energy, expected.energy, 1e-7 * expected.energy);
      // What each tool feels of itself and of the other that moves as its mirror image.
      const Mat3 stiffness = expected.stiffness.topLeftCorner<3, 3>() +
                             expected.stiffness.topRightCorner<3, 3>() * mirror;
      EXPECT_LT((found.stiffness - r * stiffness * r.transpose()).norm(), 1e-5 * stiffness.norm());
      EXPECT_EQ(found.negative_pivots, 0);
    }
  }
}

TEST_P(Supports, DerivativesAreThoseOfTheEnergy) {
  EquilibriumOptions options = with_tolerance(1e-12);
  options.third_derivatives = true;
  EquilibriumSolver solver(half_body(GetParam()), options);
  solver.set_interaction(BondedPatch({nearest_point(half_body(GetParam()).body.mesh, kSize)}));
  const Vec3 t(0.002, -0.001, -0.002);
  const Equilibrium here = solver.solve(t, solver.rest());
  ASSERT_EQ(here.outcome, Outcome::converged) << here.summary.message;
  constexpr double kStep = 1e-5;
  const Equilibrium up = solver.solve(t + kStep * Vec3::UnitX(), here);
  const Equilibrium down = solver.solve(t - kStep * Vec3::UnitX(), here);
  EXPECT_NEAR((up.energy - down.energy) / (2 * kStep), here.reaction.x(),
              1e-6 * here.reaction.norm());
  EXPECT_LT(((up.reaction - down.reaction) / (2 * kStep) - here.stiffness.col(0)).norm(),
            1e-5 * here.stiffness.norm());
  EXPECT_LT(((up.u - down.u) / (2 * kStep) - here.v.col(0)).lpNorm<Eigen::Infinity>(), 1e-5);
  const double bend = (up.stiffness(0, 0) - down.stiffness(0, 0)) / (2 * kStep);
  EXPECT_NEAR(here.third_derivative[0], bend, 1e-3 * std::abs(bend));
}

TEST(Supports, ATipThatHoldsAPointOfAPlaneIsRefusedByName) {
  const Scene scene = half_body(ElementOrder::linear);
  EquilibriumSolver solver(scene, {});
  const Index node = nearest_point(scene.body.mesh, Vec3(0, kSize.y(), kSize.z()));
  const std::string message = message_of([&] { solver.set_interaction(BondedPatch({node})); });
  EXPECT_NE(message.find("HeldDirection"), std::string::npos) << message;
  EXPECT_NE(message.find("node " + std::to_string(node)), std::string::npos) << message;
}

/// Two boxes apart, of which springs below hold the first.
Scene two_pieces(ElementOrder order) {
  TetMesh mesh = make_box(order, {2, 2, 2}, kSize);
  const Index num_first = mesh.num_points();
  add_copy(mesh, {0, 0, 0.1});
  const auto n = static_cast<std::size_t>(mesh.num_points());
  Scene scene = make_scene(std::move(mesh), make_material(Law::neo_hookean, 3000, 0.35),
                           std::vector<char>(n, 0));
  scene.body.support_stiffness.assign(n, 0);
  for (Index p = 0; p < num_first; ++p) {
    if (scene.body.mesh.points[p].z() == 0) scene.body.support_stiffness[p] = 2e4;
  }
  return scene;
}

TEST_P(Supports, APieceWithoutAnyIsNamedBesideOneOnSprings) {
  Scene scene = two_pieces(GetParam());
  const std::string second = "48 cells, 8e-05 m³, around (0.025, 0.02, 0.12) m";
  const Index node = nearest_point(scene.body.mesh, kSize + Vec3(0, 0, 0.1));
  const auto rest_with = [&](Index held) {
    EquilibriumSolver solver(scene, {});
    solver.set_interaction(BondedPatch({held}));
    return solver.rest();
  };
  const Equilibrium loose = rest_with(nearest_point(scene.body.mesh, kSize));
  EXPECT_NE(loose.outcome, Outcome::converged);
  EXPECT_NE(loose.summary.message.find(second), std::string::npos) << loose.summary.message;
  // A tip that holds it at one point alone lets it turn.
  const Equilibrium turns = rest_with(node);
  EXPECT_NE(turns.outcome, Outcome::converged);
  EXPECT_NE(turns.summary.message.find("about which it turns"), std::string::npos)
      << turns.summary.message;
  // What acts before a tool comes needs each to be held.
  Scene loaded = scene;
  loaded.body.applied_traction.assign(loaded.body.fixed.size(), Vec3(0, 0, 1));
  const EquilibriumSolver of_loaded(loaded, {});
  EXPECT_NE(of_loaded.settled().outcome, Outcome::converged);
  EXPECT_NE(of_loaded.settled().summary.message.find(second), std::string::npos)
      << of_loaded.settled().summary.message;
  // One that slides in its plane is told before anything is solved for.
  scene.body.held_directions.assign(scene.body.fixed.size(), HeldDirections::Zero());
  for (std::size_t p = scene.body.fixed.size() / 2; p < scene.body.fixed.size(); ++p) {
    scene.body.held_directions[p].col(0) = Vec3::UnitZ();
  }
  const std::string slides = message_of([&] { (void)rest_with(node); });
  EXPECT_NE(slides.find(second + " moves freely along ("), std::string::npos) << slides;
}

TEST_P(Supports, ARigidBlockSinksIntoItsBedByItsWeight) {
  constexpr double kBed = 1e5;
  constexpr double kDensity = 1000;
  // The block is as much stiffer than its bed as this is below one.
  constexpr double kRigid = 1e-4;
  Scene scene = make_scene(make_box(GetParam(), {2, 2, 2}, kSize),
                           make_material(Law::neo_hookean, 1e8, 0.3), {});
  scene.body.fixed.assign(scene.body.mesh.points.size(), 0);
  scene.body.touchable = boundary_points(scene.body.mesh);
  for (const Vec3& p : scene.body.mesh.points) {
    scene.body.support_stiffness.push_back(p.z() == 0 ? kBed : 0);
  }
  scene.organ.body_force = Vec3(1, 0, -9.81);
  scene.organ.densities = {kDensity};
  for (const bool has_factor : {true, false}) {
    EquilibriumSolver solver(scene, {}, has_factor ? make_linear_solver() : nullptr);
    const Equilibrium& rest = solver.settled();
    ASSERT_EQ(rest.outcome, Outcome::converged) << rest.summary.message;
    const double sinks = kDensity * 9.81 * kSize.z() / kBed;
    double mean = 0;
    for (Index p = 0; p < scene.body.mesh.num_points(); ++p) mean += rest.u[3 * p + 2];
    mean /= scene.body.mesh.num_points();
    // It tilts too, about the middle.
    EXPECT_NEAR(mean, -sinks, 2e-2 * sinks);
    Vec3 bed = Vec3::Zero();
    Index corners = 0;
    for (Index p = 0; p < scene.body.mesh.num_points(); ++p) {
      const Vec3& x = scene.body.mesh.points[p];
      const bool is_corner =
          x.z() == 0 && (x.x() == 0 || x.x() == kSize.x()) && (x.y() == 0 || x.y() == kSize.y());
      if (!is_corner) continue;
      bed += rest.u.segment<3>(3 * Eigen::Index{p});
      ++corners;
    }
    EXPECT_NEAR(bed.z() / corners, -sinks, kRigid * sinks);
    EXPECT_NEAR(bed.x() / corners, sinks / 9.81, 2 * kRigid * sinks);
  }
}

TEST(Pressure, AnArteryOf120mmHgWidensByItsClosedForm) {
  const Shell artery;  // 3 mm and 4 mm
  const Scene scene = make_tube(artery, {2, 4, 1});
  if (!is_solvable(scene)) GTEST_SKIP() << "no linear solver that pivots was built in";
  EquilibriumSolver solver(scene, {});
  const Equilibrium& rest = solver.settled();
  ASSERT_EQ(rest.outcome, Outcome::converged) << rest.summary.message;
  const double expected = inflated_radius(artery, 1) - artery.inner;
  EXPECT_GT(expected, 0.05 * artery.inner);
  for (Index p = 0; p < scene.body.mesh.num_points(); ++p) {
    const Vec3& x = scene.body.mesh.points[p];
    if (scene.body.applied_pressure[p] == 0) continue;
    const double found = (x + rest.u.segment<3>(3 * Eigen::Index{p})).head<2>().norm();
    ASSERT_NEAR(found - artery.inner, expected, 0.01 * expected);
  }
  // The work of the pressure is more than what is stored: it has less energy than at rest.
  EXPECT_LT(rest.energy, 0);
}

TEST(Pressure, ASphereWidensByItsClosedForm) {
  Shell sphere;
  sphere.inner = 0.01;
  sphere.outer = 0.02;
  sphere.pressure = 2e4;
  sphere.youngs_modulus = 1e5;
  const Scene scene = make_sphere_sector(sphere, {3, 2, 2});
  if (!is_solvable(scene)) GTEST_SKIP() << "no linear solver that pivots was built in";
  EquilibriumSolver solver(scene, {});
  const Equilibrium& rest = solver.settled();
  ASSERT_EQ(rest.outcome, Outcome::converged) << rest.summary.message;
  const double expected = inflated_radius(sphere, 2) - sphere.inner;
  EXPECT_GT(expected, 0.1 * sphere.inner);
  for (Index p = 0; p < scene.body.mesh.num_points(); ++p) {
    if (scene.body.applied_pressure[p] == 0) continue;
    const double found =
        (scene.body.mesh.points[p] + rest.u.segment<3>(3 * Eigen::Index{p})).norm() - sphere.inner;
    ASSERT_NEAR(found, expected, 0.01 * expected);
  }
}

TEST(Pressure, ThatIsTooLargeEndsByName) {
  Shell sphere;
  sphere.pressure = 1e9;
  const Scene scene = make_tube(sphere, {1, 2, 1});
  if (!is_solvable(scene)) GTEST_SKIP() << "no linear solver that pivots was built in";
  EquilibriumSolver solver(scene, {});
  EXPECT_NE(solver.settled().outcome, Outcome::converged);
  EXPECT_NE(solver.settled().summary.message.find("AppliedPressure"), std::string::npos)
      << solver.settled().summary.message;
  EXPECT_TRUE(solver.settled().u.allFinite());
}

}  // namespace
}  // namespace palpate::test::test_supports
