// SPDX-License-Identifier: BSD-3-Clause
// Incompressible bodies: [A B; Bᵀ −C] with a small C or none. One negative pivot for each pressure,
// whatever the order of elimination, the contrast and the unit of the pressures.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include "linear/linear_solver.h"
#include "solvers/linear/systems.h"
#include "solvers/support/random.h"

namespace palpate::test::test_saddle_point {
namespace {

using Where = std::function<bool(const Vec3&)>;

Scene make_cube(const Where& held, double contrast = 1) {
  Scene scene;
  scene.body.mesh = make_box(ElementOrder::quadratic, {2, 2, 2}, Vec3(1, 1, 1));
  for (const Vec3& p : scene.body.mesh.points) scene.body.fixed.push_back(held(p) ? 1 : 0);
  scene.body.touchable.assign(scene.body.fixed.size(), 0);
  scene.organ.materials = {make_isotropic(Law::linear, 1000, 0),
                           make_isotropic(Law::linear, 1000 * contrast, 0)};
  for (Index c = 0; c < scene.body.mesh.num_cells(); ++c) {
    scene.body.material_of_cell.push_back(
        scene.body.mesh.points[scene.body.mesh.cell(c)[0]].z() < 0.5 ? 0 : 1);
  }
  return scene;
}

constexpr int kPressures = 27;

bool at_bottom(const Vec3& p) { return p.z() == 0; }
bool at_a_corner(const Vec3& p) { return p == Vec3(0, 0, 0); }
bool nowhere(const Vec3&) { return false; }
bool on_the_surface(const Vec3& p) { return p.minCoeff() == 0 || p.maxCoeff() == 1; }

class SaddlePoint : public testing::Test {
 protected:
  void SetUp() override {
    if (!solver_->pivots()) GTEST_SKIP() << solver_->name() << " does not pivot";
  }

  FactorStatus factorise(const System& system) {
    solver_->analyse(system.pattern);
    return solver_->factorise(system.values);
  }

  std::unique_ptr<LinearSolver> solver_ = make_linear_solver();
  Random random_{52};
};

TEST_F(SaddlePoint, Solves) {
  for (double softness : {0.0, 1e-9, 1e-3}) {
    const System system = incompressible(make_cube(at_bottom), softness, 1);
    ASSERT_EQ(factorise(system), FactorStatus::ok) << softness;
    EXPECT_EQ(solver_->negative_pivots(), kPressures) << softness;
    const Eigen::VectorXd x = random_.vector(system.pattern.size, 1);
    Eigen::VectorXd column = system.matrix() * x;
    solver_->solve(column);
    // ε times the condition number, below 1e4.
    EXPECT_LT((column - x).norm(), 1e-10 * x.norm()) << softness;
  }
}

TEST_F(SaddlePoint, ContrastAndUnitOfThePressureHaveNoPart) {
  for (double contrast : {1.0, 1e6, 1e9}) {
    for (double unit : {1e-6, 1.0, 1e6}) {
      const System system = incompressible(make_cube(at_bottom, contrast), 0, unit);
      ASSERT_EQ(factorise(system), FactorStatus::ok) << contrast << ' ' << unit;
      EXPECT_EQ(solver_->negative_pivots(), kPressures) << contrast << ' ' << unit;
      const Eigen::VectorXd b = random_.vector(system.pattern.size, 1);
      Eigen::VectorXd x = b;
      solver_->solve(x);
      // Backward stable, row by row.
      const Eigen::VectorXd residual = system.matrix() * x - b;
      const Eigen::VectorXd size = system.matrix().cwiseAbs() * x.cwiseAbs() + b.cwiseAbs();
      EXPECT_LT((residual.array() / size.array()).abs().maxCoeff(), 1e-11)
          << contrast << ' ' << unit;
    }
  }
}

TEST_F(SaddlePoint, PowersOfTwoScaleExactly) {
  const System system = incompressible(make_cube(at_bottom), 0, 1);
  const Eigen::VectorXd b = random_.vector(system.pattern.size, 1);
  ASSERT_EQ(factorise(system), FactorStatus::ok);
  Eigen::VectorXd x = b;
  solver_->solve(x);
  for (int exponent : {1, 7, -20}) {
    std::vector<double> values = system.values;
    for (double& value : values) value = std::ldexp(value, exponent);
    ASSERT_EQ(solver_->factorise(values), FactorStatus::ok);
    Eigen::VectorXd column = b;
    solver_->solve(column);
    for (double& value : column) value = std::ldexp(value, exponent);
    EXPECT_EQ(column, x) << exponent;
  }
}

TEST_F(SaddlePoint, RigidMotionsAreSingular) {
  for (double contrast : {1.0, 1e9}) {
    EXPECT_EQ(factorise(incompressible(make_cube(nowhere, contrast), 0, 1)),
              FactorStatus::singular);
    EXPECT_EQ(factorise(incompressible(make_cube(at_a_corner, contrast), 0, 1)),
              FactorStatus::singular);
  }
}

// With the whole surface held nothing says how large the pressure is on the whole; the bodies of a
// small compressibility do.
TEST_F(SaddlePoint, AConstantPressureThatNothingDeterminesIsSingular) {
  // Cells of the box have all their nodes on the surface: with two bricks a side, many pressures.
  EXPECT_EQ(factorise(incompressible(make_cube(on_the_surface), 0, 1)), FactorStatus::singular);
  EXPECT_EQ(factorise(incompressible(make_cube(on_the_surface), 1e-3, 1)), FactorStatus::ok);
  EXPECT_EQ(solver_->negative_pivots(), kPressures);
}

// The elements of the program, which have a pressure where a body is nearly incompressible.
TEST_F(SaddlePoint, OfNearlyIncompressibleBodies) {
  for (ElementOrder order : {ElementOrder::linear, ElementOrder::quadratic}) {
    for (double nu : {0.4999, 0.499999}) {
      SCOPED_TRACE(std::to_string(nodes_per_cell(order)) + " nodes, " + std::to_string(nu));
      Scene scene = make_cube(at_bottom);
      scene.body.mesh = make_box(order, {2, 2, 2}, Vec3(1, 1, 1));
      scene.body.fixed.resize(scene.body.mesh.num_points());
      scene.body.touchable.resize(scene.body.mesh.num_points());
      scene.organ.materials = {
          with_formulation(make_isotropic(Law::linear, 1000, nu), Formulation::mixed)};
      scene.body.material_of_cell.clear();
      ASSERT_EQ(factorise(body(scene)), FactorStatus::ok);
      EXPECT_EQ(solver_->negative_pivots(), kPressures);
      std::fill(scene.body.fixed.begin(), scene.body.fixed.end(), 0);
      EXPECT_EQ(factorise(body(scene)), FactorStatus::singular);
    }
  }
}

TEST_F(SaddlePoint, SmallOnes) {
  const System system = sparse((Eigen::Matrix3d() << 2, 0, 1, 0, 3, 1, 1, 1, 0).finished());
  ASSERT_EQ(factorise(system), FactorStatus::ok);
  EXPECT_EQ(solver_->negative_pivots(), 1);
  const System swap = sparse((Eigen::Matrix2d() << 0, 1, 1, 0).finished());
  ASSERT_EQ(factorise(swap), FactorStatus::ok);
  EXPECT_EQ(solver_->negative_pivots(), 1);
  Eigen::VectorXd column = Eigen::Vector2d(3, 5);
  solver_->solve(column);
  EXPECT_EQ(column, Eigen::VectorXd(Eigen::Vector2d(5, 3)));
  // Two multipliers for one unknown.
  const System twice = sparse((Eigen::Matrix3d() << 2, 1, 1, 1, 0, 0, 1, 0, 0).finished());
  EXPECT_EQ(factorise(twice), FactorStatus::singular);
}

}  // namespace
}  // namespace palpate::test::test_saddle_point
