// SPDX-License-Identifier: BSD-3-Clause
// A matrix is singular when a body can move freely, and not when it is merely stiff here and soft
// there: the same bodies, held and not.
#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "linear/linear_solver.h"
#include "solvers/linear/systems.h"

namespace palpate::test::test_singular {
namespace {

const Vec3 kSize(1, 1, 1);

using Where = std::function<bool(const Vec3&)>;

bool at_bottom(const Vec3& p) { return p.z() == 0; }
bool at_a_corner(const Vec3& p) { return p == Vec3(0, 0, 0); }
bool at_two_corners(const Vec3& p) { return p == Vec3(0, 0, 0) || p == kSize; }
bool at_three_corners(const Vec3& p) { return at_two_corners(p) || p == Vec3(1, 0, 0); }
bool nowhere(const Vec3&) { return false; }

/// A unit cube that is held where `held` says and stiffer by `contrast` where `stiff` says.
struct Cube {
  ElementOrder order = ElementOrder::linear;
  double poissons_ratio = 0.3;
  double contrast = 1;
  Where stiff = nowhere;
  /// Squeezes a layer of bricks to this thickness.
  double layer = 0;
};

Scene make_cube(const Cube& cube, const Where& held) {
  Scene scene;
  scene.body.mesh = make_box(cube.order, {4, 4, 4}, kSize);
  for (const Vec3& p : scene.body.mesh.points) scene.body.fixed.push_back(held(p) ? 1 : 0);
  scene.body.touchable.assign(scene.body.fixed.size(), 0);
  for (double youngs_modulus : {1000.0, 1000 * cube.contrast}) {
    scene.organ.materials.push_back(
        with_formulation(make_isotropic(Law::linear, youngs_modulus, cube.poissons_ratio),
                         Formulation::displacement));
  }
  for (Index c = 0; c < scene.body.mesh.num_cells(); ++c) {
    Vec3 centre = Vec3::Zero();
    for (int i = 0; i < 4; ++i) centre += scene.body.mesh.points[scene.body.mesh.cell(c)[i]] / 4;
    scene.body.material_of_cell.push_back(cube.stiff(centre) ? 1 : 0);
  }
  if (cube.layer > 0) {
    warp_straight(scene.body.mesh, [&](const Vec3& p) -> Vec3 {
      return p.z() == 0.75 ? Vec3(p.x(), p.y(), 0.5 + cube.layer) : p;
    });
  }
  return scene;
}

class Singular : public testing::TestWithParam<std::string> {
 protected:
  /// Whether the factorisation of the cube, held there, succeeds.
  bool is_regular(const Cube& cube, const Where& held) {
    const System system = body(make_cube(cube, held));
    const auto solver = make_linear_solver(GetParam());
    solver->analyse(system.pattern);
    const bool ok = solver->factorise(system.values) == FactorStatus::ok;
    if (ok) {
      EXPECT_EQ(solver->negative_pivots(), 0);
    }
    return ok;
  }

  void check(Cube cube) {
    for (ElementOrder order : {ElementOrder::linear, ElementOrder::quadratic}) {
      cube.order = order;
      SCOPED_TRACE(std::to_string(nodes_per_cell(order)) + " nodes");
      EXPECT_TRUE(is_regular(cube, at_bottom));
      EXPECT_TRUE(is_regular(cube, at_three_corners));
      EXPECT_FALSE(is_regular(cube, at_two_corners)) << "turns about a line";
      EXPECT_FALSE(is_regular(cube, at_a_corner)) << "turns about a point";
      EXPECT_FALSE(is_regular(cube, nowhere)) << "floats";
    }
  }
};

INSTANTIATE_TEST_SUITE_P(Each, Singular, testing::ValuesIn(linear_solver_names()),
                         [](const auto& each) { return letters(each.param); });

TEST_P(Singular, OneMaterial) { check({}); }

TEST_P(Singular, StiffInclusion) {
  Cube cube;
  cube.stiff = [](const Vec3& p) { return (p - kSize / 2).lpNorm<Eigen::Infinity>() < 0.25; };
  for (double contrast : {1e3, 1e6, 1e9}) {
    SCOPED_TRACE(contrast);
    cube.contrast = contrast;
    check(cube);
  }
}

TEST_P(Singular, StiffBlockOnASoftLayer) {
  Cube cube;
  cube.stiff = [](const Vec3& p) { return p.z() > 0.25; };
  for (double contrast : {1e6, 1e9}) {
    SCOPED_TRACE(contrast);
    cube.contrast = contrast;
    EXPECT_TRUE(is_regular(cube, at_bottom));
    EXPECT_FALSE(is_regular(cube, nowhere));
  }
}

TEST_P(Singular, StiffShellAroundASoftCore) {
  Cube cube;
  cube.stiff = [](const Vec3& p) { return p.minCoeff() < 0.25 || p.maxCoeff() > 0.75; };
  for (double contrast : {1e6, 1e9}) {
    SCOPED_TRACE(contrast);
    cube.contrast = contrast;
    check(cube);
  }
}

TEST_P(Singular, NearlyIncompressible) {
  Cube cube;
  for (double nu : {0.4999, 0.499999}) {
    SCOPED_TRACE(nu);
    cube.poissons_ratio = nu;
    check(cube);
  }
}

TEST_P(Singular, Slivers) {
  Cube cube;
  for (double thickness : {1e-3, 1e-5}) {
    SCOPED_TRACE(thickness);
    cube.layer = thickness;
    check(cube);
  }
}

TEST_P(Singular, OnePartOfTwoFloats) {
  Scene scene = make_cube({}, at_bottom);
  const TetMesh whole = scene.body.mesh;
  scene.body.mesh = subset(whole, [&](Index c) {
    const double z = whole.points[whole.cell(c)[0]].z() + whole.points[whole.cell(c)[1]].z() +
                     whole.points[whole.cell(c)[2]].z() + whole.points[whole.cell(c)[3]].z();
    return z < 1 || z > 2;  // not the second layer of four
  });
  scene.body.material_of_cell.resize(scene.body.mesh.num_cells());
  const System system = body(scene);
  const auto solver = make_linear_solver(GetParam());
  solver->analyse(system.pattern);
  EXPECT_EQ(solver->factorise(system.values), FactorStatus::singular);
}

// Springs in a row whose stiffness falls by nine decades from one end to the other: regular when
// either end is held, and singular when neither is.
TEST_P(Singular, ChainOfSprings) {
  constexpr int kSprings = 30;
  for (bool stiff_first : {true, false}) {
    for (bool held : {true, false}) {
      Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(kSprings + 1, kSprings + 1);
      for (int i = 0; i < kSprings; ++i) {
        const int rank = stiff_first ? i : kSprings - 1 - i;
        const double stiffness = 0.7 * std::pow(10.0, -9.0 * rank / (kSprings - 1));
        matrix.block<2, 2>(i, i) += stiffness * (Eigen::Matrix2d() << 1, -1, -1, 1).finished();
      }
      const Eigen::MatrixXd rest = matrix.topLeftCorner(kSprings, kSprings);
      const System system = sparse(held ? rest : matrix);
      const auto solver = make_linear_solver(GetParam());
      solver->analyse(system.pattern);
      EXPECT_EQ(solver->factorise(system.values), held ? FactorStatus::ok : FactorStatus::singular)
          << "stiff first " << stiff_first << ", held " << held;
    }
  }
}

// What the lowest mode is known to does not depend on what was factorised before.
TEST_P(Singular, TheVerdictHasNoMemory) {
  Cube cube;
  cube.contrast = 1e9;
  cube.stiff = [](const Vec3& p) { return p.z() > 0.25; };
  const System held = body(make_cube(cube, at_bottom));
  const auto solver = make_linear_solver(GetParam());
  solver->analyse(held.pattern);
  const std::vector<double> nothing(held.values.size(), 0.0);
  Eigen::VectorXd first = Eigen::VectorXd::Ones(held.pattern.size);
  ASSERT_EQ(solver->factorise(held.values), FactorStatus::ok);
  solver->solve(first);
  EXPECT_EQ(solver->factorise(nothing), FactorStatus::singular);
  ASSERT_EQ(solver->factorise(held.values), FactorStatus::ok);
  Eigen::VectorXd second = Eigen::VectorXd::Ones(held.pattern.size);
  solver->solve(second);
  EXPECT_EQ(first, second);
}

}  // namespace
}  // namespace palpate::test::test_singular
