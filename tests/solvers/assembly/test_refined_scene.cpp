// SPDX-License-Identifier: BSD-3-Clause
#include "assembly/refined_scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "assembly/assembly.h"
#include "elements/tetrahedron.h"
#include "solvers/support/block.h"
#include "solvers/support/bodies.h"
#include "solvers/support/box_mesh.h"
#include "solvers/support/laws.h"
#include "solvers/support/orders.h"

namespace palpate::test::test_refined_scene {
namespace {

const Vec3 kSize(0.1, 0.06, 0.05);
constexpr double kOnFace = 1e-12;

/// A box that is fixed at x = 0; its inside is warped.
Scene make_box_scene(ElementOrder order, Law law = Law::neo_hookean) {
  TetMesh mesh = test::make_box(order, {3, 2, 2}, kSize);
  warp_straight(mesh, wavy_inside(kSize));
  std::vector<char> fixed;
  for (const Vec3& x : mesh.points) fixed.push_back(x.x() < kOnFace ? 1 : 0);
  Scene scene = test::make_scene(mesh, test::make_material(law, 3000, 0.3), fixed);
  // As filters have it: midside nodes are not touched.
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    for (int a = 4; a < nodes_per_cell(order); ++a) scene.body.touchable[mesh.cell(c)[a]] = 0;
  }
  return scene;
}

/// A part of the cells, so that divided cells have neighbours that are not.
Scene refined_at_random(const Scene& scene) {
  std::vector<char> chosen;
  for (Index c = 0; c < scene.body.mesh.num_cells(); ++c) chosen.push_back(c % 3 == 0 ? 1 : 0);
  Scene fine = refined(scene, refine(scene.body.mesh, chosen));
  check(fine);
  return fine;
}

class RefinedSceneOfAnyOrder : public testing::TestWithParam<ElementOrder> {};
INSTANTIATE_TEST_SUITE_P(RefinedScene, RefinedSceneOfAnyOrder, testing::ValuesIn(kOrders),
                         name_of_order);

TEST_P(RefinedSceneOfAnyOrder, IsFixedOnTheSameFace) {
  const Scene fine = refined_at_random(make_box_scene(GetParam()));
  const std::vector<char> on_surface = boundary_points(fine.body.mesh);
  for (Index p = 0; p < fine.body.mesh.num_points(); ++p) {
    const Vec3& x = fine.body.mesh.points[p];
    EXPECT_EQ(fine.body.fixed[p] != 0, x.x() < kOnFace && on_surface[p] != 0) << x.transpose();
  }
}

TEST_P(RefinedSceneOfAnyOrder, MayBeTouchedAtCornersOfTheRestOfTheSurface) {
  const Scene fine = refined_at_random(make_box_scene(GetParam()));
  const TetMesh& mesh = fine.body.mesh;
  const std::vector<char> on_surface = boundary_points(mesh);
  std::vector<char> is_corner(mesh.points.size(), 0);
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    for (int a = 0; a < 4; ++a) is_corner[mesh.cell(c)[a]] = 1;
  }
  for (Index p = 0; p < mesh.num_points(); ++p) {
    const bool expected = is_corner[p] != 0 && on_surface[p] != 0 && mesh.points[p].x() > kOnFace;
    EXPECT_EQ(fine.body.touchable[p] != 0, expected) << mesh.points[p].transpose();
  }
}

TEST_P(RefinedSceneOfAnyOrder, HasTheMaterialsOfItsParents) {
  Scene scene = make_box_scene(GetParam());
  put_inside(scene, test::make_material(Law::linear, 9000, 0.2),
             [](const Vec3& x) { return x.x() > 0.05; });
  const auto volume_of_second = [](const Scene& of) {
    double sum = 0;
    for (Index c = 0; c < of.body.mesh.num_cells(); ++c) {
      if (of.body.material_of(c) == 1) {
        sum += volume(subset(of.body.mesh, [&](Index other) { return other == c; }));
      }
    }
    return sum;
  };
  EXPECT_NEAR(volume_of_second(refined_at_random(scene)), volume_of_second(scene), 1e-15);
}

TEST_P(RefinedSceneOfAnyOrder, IsHeldAlongTheSameDirections) {
  Scene scene = make_box_scene(GetParam());
  Body& body = scene.body;
  body.held_directions.assign(body.mesh.points.size(), HeldDirections::Zero());
  const auto expected = [](const Vec3& x) {
    Mat3 held = Mat3::Zero();
    if (x.y() < kOnFace) held(1, 1) = 1;
    if (x.z() < kOnFace) held(2, 2) = 1;
    return held;
  };
  for (Index p = 0; p < body.mesh.num_points(); ++p) {
    const Vec3& x = body.mesh.points[p];
    if (body.fixed[p] != 0) continue;
    if (x.y() < kOnFace) body.held_directions[p].col(0) = Vec3::UnitY();
    if (x.z() < kOnFace) body.held_directions[p].col(1) = Vec3::UnitZ();
  }
  check(scene);
  const Scene fine = refined_at_random(scene);
  const std::vector<char> on_surface = boundary_points(fine.body.mesh);
  for (Index p = 0; p < fine.body.mesh.num_points(); ++p) {
    if (fine.body.fixed[p] != 0 || on_surface[p] == 0) continue;
    const HeldDirections& held = fine.body.held_directions[p];
    EXPECT_LE((held * held.transpose() - expected(fine.body.mesh.points[p])).norm(), 1e-12);
  }
}

// The curved wall of a cylinder: the normals of neighbouring points differ.
TEST(RefinedScene, IsHeldAlongTheNormalsOfACurvedWall) {
  TetMesh mesh = test::make_box(ElementOrder::quadratic, {8, 1, 2}, {1, 0.2, 0.3});
  warp_curved(mesh, [](const Vec3& x) -> Vec3 {
    return {(1 + x.y()) * std::cos(x.x()), (1 + x.y()) * std::sin(x.x()), x.z()};
  });
  const auto normal = [](const Vec3& x) { return Vec3(x.x(), x.y(), 0).normalized(); };
  const auto is_wall = [](const Vec3& x) { return x.head<2>().norm() < 1 + 1e-9; };
  check_and_orient(mesh);
  Scene scene = test::make_scene(mesh, test::make_material(Law::neo_hookean, 3000, 0.3),
                                 std::vector<char>(mesh.points.size(), 0));
  scene.body.held_directions.assign(mesh.points.size(), HeldDirections::Zero());
  for (Index p = 0; p < mesh.num_points(); ++p) {
    scene.body.fixed[p] = mesh.points[p].z() < kOnFace ? 1 : 0;
    if (scene.body.fixed[p] == 0 && is_wall(mesh.points[p])) {
      scene.body.held_directions[p].col(0) = normal(mesh.points[p]);
    }
  }
  check(scene);
  const Scene fine = refined_at_random(scene);
  int num_held = 0;
  for (Index p = mesh.num_points(); p < fine.body.mesh.num_points(); ++p) {
    const Vec3& x = fine.body.mesh.points[p];
    // Between the nodes of the old mesh, the wall is a parabola.
    if (fine.body.fixed[p] != 0 || x.head<2>().norm() > 1 + 1e-4) continue;
    ++num_held;
    const HeldDirections& held = fine.body.held_directions[p];
    EXPECT_GT(std::fabs(held.col(0).dot(normal(x))), 0.999) << x.transpose();
    EXPECT_TRUE(held.col(1).isZero(0));
  }
  EXPECT_GT(num_held, 20);
}

// A cell that is held as a whole stays so; one that only has all of its corners on walls does not.
TEST(RefinedScene, IsHeldInsideWhereWholeCellsAre) {
  Scene scene = make_box_scene(ElementOrder::linear);
  const auto is_held = [](const Vec3& x) { return x.x() < 0.04; };
  for (Index p = 0; p < scene.body.mesh.num_points(); ++p) {
    if (is_held(scene.body.mesh.points[p])) scene.body.fixed[p] = 1;
  }
  const Scene fine = refined(scene, refine_all(scene.body.mesh));
  const auto volume_held = [](const Scene& of) {
    return volume(subset(of.body.mesh, [&](Index c) {
      const Index* cell = of.body.mesh.cell(c);
      return std::all_of(cell, cell + 4, [&](Index p) { return of.body.fixed[p] != 0; });
    }));
  };
  EXPECT_GT(volume_held(scene), 0);
  EXPECT_NEAR(volume_held(fine), volume_held(scene), 1e-15);
}

/// A displacement of the old mesh, as one of the new mesh.
NodalVector prolonged(const NodalVector& u, const TetMesh& old, const Refinement& refinement) {
  NodalVector fine = NodalVector::Zero(3 * refinement.mesh.num_points());
  fine.head(u.size()) = u;
  Index next = old.num_points();
  for (const Refinement::Place& place : refinement.new_points) {
    const Eigen::VectorXd shape = shape_values(old.order, place.barycentric.tail<3>());
    for (int a = 0; a < nodes_per_cell(old.order); ++a) {
      fine.segment<3>(3 * Eigen::Index{next}) +=
          shape[a] * u.segment<3>(3 * Eigen::Index{old.cell(place.cell)[a]});
    }
    ++next;
  }
  return fine;
}

// Spaces are nested: a displacement has the same energy on the finer mesh, with springs and loads.
// The integrals of a linear body are exact.
TEST_P(RefinedSceneOfAnyOrder, ADisplacementHasTheSameEnergy) {
  Scene scene = make_box_scene(GetParam(), Law::linear);
  Body& body = scene.body;
  const std::size_t num_points = body.mesh.points.size();
  body.support_stiffness.assign(num_points, 0);
  body.applied_pressure.assign(num_points, 0);
  body.applied_traction.assign(num_points, Vec3::Zero());
  for (std::size_t p = 0; p < num_points; ++p) {
    const Vec3& x = body.mesh.points[p];
    if (x.z() < kOnFace) body.support_stiffness[p] = 1e4 * (1 + 20 * x.y());
    if (x.y() > kSize.y() - kOnFace && x.x() > 0.03) {
      body.applied_traction[p] = Vec3(100, 50 + 1000 * x.x(), -80);
    }
  }
  // A pressure needs a surface without a rim that moves.
  for (const Index p : boundary_faces(body.mesh)) body.applied_pressure[p] = 300;
  scene.organ.densities = {1000};
  scene.organ.body_force = Vec3(0, 1, -9);
  check(scene);
  std::vector<char> chosen;
  for (Index c = 0; c < body.mesh.num_cells(); ++c) chosen.push_back(c % 3 == 0 ? 1 : 0);
  const Refinement refinement = refine(body.mesh, chosen);
  const Scene fine = refined(scene, refinement);

  NodalVector u = NodalVector::Zero(3 * body.mesh.num_points());
  for (Index p = 0; p < body.mesh.num_points(); ++p) {
    const Vec3& x = body.mesh.points[p];
    if (body.fixed[p] == 0) {
      u.segment<3>(3 * Eigen::Index{p}) =
          1e-2 * x.x() * Vec3(std::sin(30 * x.y()), std::cos(20 * x.z()), std::sin(25 * x.x()));
    }
  }
  NodalVector force;
  const double coarse_energy = Assembly(scene).residual(u, force).energy;
  const double fine_energy =
      Assembly(fine).residual(prolonged(u, body.mesh, refinement), force).energy;
  EXPECT_GT(std::fabs(coarse_energy), 1e-6);
  EXPECT_NEAR(fine_energy, coarse_energy, 1e-10 * std::fabs(coarse_energy));
}

}  // namespace
}  // namespace palpate::test::test_refined_scene
