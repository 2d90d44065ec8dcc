// SPDX-License-Identifier: BSD-3-Clause
#include "discretisation/mesh_error_estimate.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "discretisation/tangent_norm.h"
#include "equilibrium/equilibrium.h"
#include "interaction/bonded_patch.h"
#include "interaction/rigid_tool.h"
#include "solvers/support/block.h"
#include "solvers/support/box_mesh.h"
#include "solvers/support/laws.h"

namespace palpate::test::test_mesh_error_estimate {
namespace {

/// Neither symmetric nor small.
Mat3 deformation() {
  Mat3 h;
  h << 0.1, -0.08, 0.03, 0.05, 0.12, -0.1, 0.04, 0.07, -0.13;
  return h;
}

Mat3 change() {
  Mat3 d;
  d << 0.4, 0.2, -0.3, -0.25, 0.1, 0.35, 0.15, -0.45, 0.5;
  return d;
}

NodalVector uniform(const TetMesh& mesh, const Mat3& h) {
  NodalVector u(3 * mesh.num_points());
  for (Index p = 0; p < mesh.num_points(); ++p) u.segment<3>(3 * p) = h * mesh.points[p];
  return u;
}

class EachLaw : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(TangentNorm, EachLaw, testing::Range(0, 2 * num_laws));

TEST_P(EachLaw, IsHalfTheSecondDerivativeOfTheEnergy) {
  const Law law = static_cast<Law>(GetParam() / 2);
  const bool mixed = GetParam() % 2 == 1;
  if (is_incompressible(law) && !mixed) GTEST_SKIP() << "it is always mixed";
  const Material material = with_formulation(
      test::make_material(law, 3000, 0.3), mixed ? Formulation::mixed : Formulation::displacement);
  const TetMesh mesh = test::make_box(ElementOrder::quadratic, {1, 1, 1}, Vec3(0.1, 0.1, 0.1));
  const Scene scene = test::make_scene(mesh, material, std::vector<char>(mesh.points.size(), 0));
  const Assembly assembly(scene);
  constexpr double pressure = 400;
  constexpr double pressure_change = 700;
  const auto energy = [&](double step) {
    NodalVector state = NodalVector::Zero(assembly.state_size());
    state.head(3 * mesh.num_points()) = uniform(mesh, deformation() + step * change());
    for (Index p = 0; p < assembly.num_pressures(); ++p) {
      state[3 * mesh.num_points() + p] =
          (pressure + step * pressure_change) / assembly.pressure_scale()[p];
    }
    NodalVector force;
    return assembly.residual(state, force).energy;
  };
  constexpr double step = 1e-3;
  const double second = (-energy(2 * step) + 16 * energy(step) - 30 * energy(0) +
                         16 * energy(-step) - energy(-2 * step)) /
                        (12 * step * step);

  const TangentNorm& norm = best_tangent_norm(law_of_energy(law), mixed);
  std::vector<double> constants, h, d;
  std::vector<double> pressures;
  const auto add = [](std::vector<double>& to, double x) { to.insert(to.end(), kPacketSize, x); };
  for (int i = 0; i < norm.num_constants; ++i) add(constants, law_constants(material)[i]);
  if (mixed) {
    for (const double x : {pressure, pressure_change, volumetric_compliance(material)}) {
      add(pressures, x);
    }
  }
  for (int m = 0; m < 9; ++m) {
    add(h, deformation()(m / 3, m % 3));
    add(d, change()(m / 3, m % 3));
  }
  std::vector<double> norms(kPacketSize);
  norm.evaluate(1, constants.data(), h.data(), d.data(), pressures.data(), norms.data());
  for (const double of_lane : norms) {
    EXPECT_NEAR(of_lane * volume(mesh), second / 2, 1e-6 * std::fabs(second));
  }
}

TEST(TangentNorm, IsNoNumberWhereThePointIsInverted) {
  const TangentNorm& norm = best_tangent_norm(Law::neo_hookean, false);
  const std::vector<double> constants(std::size_t{2} * kPacketSize, 1000);
  std::vector<double> h(std::size_t{9} * kPacketSize, 0), norms(kPacketSize);
  const std::vector<double> d(h.size(), 0.1);
  h[3] = -1.5;
  norm.evaluate(1, constants.data(), h.data(), d.data(), nullptr, norms.data());
  for (int lane = 0; lane < kPacketSize; ++lane) EXPECT_EQ(std::isnan(norms[lane]), lane == 3);
}

/// A block, held at one end, that a tool holds by the whole of the other end, or presses from above
/// by a ball.
struct Touched {
  Touched(const Material& material, std::array<int, 3> cells, bool presses,
          ElementOrder order = ElementOrder::quadratic) {
    const Vec3 size(0.1, 0.06, 0.05);
    const TetMesh mesh = test::make_box(order, cells, size);
    std::vector<char> fixed;
    for (const Vec3& x : mesh.points) fixed.push_back(x.x() < 1e-9 ? 1 : 0);
    scene = test::make_scene(mesh, material, fixed);
    // Eigen takes seconds for a factor of the finer meshes.
    const bool is_fine =
        scene.body.mesh.num_cells() > 1000 && !is_mixed(scene.material_of(0).formulation);
    solver = std::make_unique<EquilibriumSolver>(scene, EquilibriumOptions(),
                                                 is_fine ? nullptr : make_linear_solver());
    if (presses) {
      RigidTool ball;
      ball.radius = 0.02;
      tool = make_contact(scene.body, with_defaults(ball, scene)).clone();
      solver->set_interaction(*this->tool);
      from = Vec3(0.06, 0.03, 0.075);
      to = Vec3(0.061, 0.031, 0.063);
      return;
    }
    std::vector<Index> end;
    for (Index p = 0; p < mesh.num_points(); ++p) {
      if (mesh.points[p].x() > size.x() - 1e-9) end.push_back(p);
    }
    tool = BondedPatch(end).clone();
    solver->set_interaction(*tool);
    from = Vec3::Zero();
    to = Vec3(0.004, -0.003, 0.006);
  }
  [[nodiscard]] Equilibrium touch() const { return solver->solve(to, solver->rest(from)); }
  [[nodiscard]] MeshErrorEstimator estimator() const { return {scene, solver->assembly()}; }

  Scene scene;
  std::unique_ptr<EquilibriumSolver> solver;
  std::unique_ptr<Interaction> tool;
  Vec3 from;
  Vec3 to;
};

struct Case {
  const char* name;
  Law law;
  double poissons_ratio;
  bool presses;
};

class EachTouch : public testing::TestWithParam<Case> {
 protected:
  [[nodiscard]] Touched make(std::array<int, 3> cells) const {
    const Case& of = GetParam();
    return {palpate::make_isotropic(of.law, 3000, of.poissons_ratio), cells, of.presses};
  }
};
INSTANTIATE_TEST_SUITE_P(MeshError, EachTouch,
                         testing::Values(Case{"LinearHeld", Law::linear, 0.4, false},
                                         Case{"NeoHookeanHeld", Law::neo_hookean, 0.4, false},
                                         Case{"NeoHookeanPressed", Law::neo_hookean, 0.4, true},
                                         Case{"StVenantKirchhoffPressed", Law::st_venant_kirchhoff,
                                              0.3, true},
                                         Case{"MixedHeld", Law::neo_hookean, 0.49, false},
                                         Case{"MixedPressed", Law::neo_hookean, 0.49, true}),
                         [](const auto& of) { return of.param.name; });

TEST_P(EachTouch, TheErrorOfTheForceIsTheDerivativeOfThatOfTheEnergy) {
  const Touched touched = make({4, 3, 2});
  const MeshErrorEstimator estimator = touched.estimator();
  const Equilibrium at = touched.touch();
  ASSERT_EQ(at.outcome, Outcome::converged);
  const MeshErrorEstimate estimate = estimator.estimate(at, *touched.tool);
  EXPECT_EQ(estimate.is_mixed, GetParam().poissons_ratio > 0.45);
  EXPECT_EQ(estimate.is_bonded, !GetParam().presses);
  // The end of the block has twelve faces.
  EXPECT_EQ(estimate.is_bonded_to_few, estimate.is_bonded);
  EXPECT_EQ(estimate.is_reliable, GetParam().presses && !estimate.is_mixed);
  EXPECT_LT(estimate.energy, 0);
  constexpr double step = 1e-5;
  for (int c = 0; c < 3; ++c) {
    const auto energy = [&](double by) {
      const Equilibrium there = touched.solver->solve(touched.to + by * Vec3::Unit(c), at);
      EXPECT_EQ(there.outcome, Outcome::converged);
      return estimator.estimate(there, *touched.tool).energy;
    };
    const double difference = (energy(step) - energy(-step)) / (2 * step);
    EXPECT_NEAR(-difference, estimate.force[c], 1e-4 * estimate.force.norm());
  }
  double sum = 0;
  for (const double of_cell : estimate.energy_of_cells) sum += of_cell;
  EXPECT_NEAR(sum, -estimate.energy, 1e-12 * sum);
}

TEST_P(EachTouch, IsNearTheErrorAgainstAFinerMesh) {
  // A direct solver has to do for mixed cells.
  const bool is_mixed = GetParam().poissons_ratio > 0.45;
  const Touched coarse = is_mixed ? make({4, 3, 2}) : make({6, 4, 3});
  const Equilibrium at = coarse.touch();
  const MeshErrorEstimate estimate = coarse.estimator().estimate(at, *coarse.tool);
  const Eigen::VectorXd fine = (is_mixed ? make({8, 6, 4}) : make({12, 8, 6})).touch().reaction;
  const Eigen::VectorXd direction = fine.normalized();
  // The finer mesh has an error too, of a quarter to a half of this one's.
  const double error = direction.dot(at.reaction - fine) * 4 / 3;
  const double ratio = direction.dot(estimate.force) / error;
  EXPECT_GT(ratio, 0.5);
  // The estimate is not trusted with mixed cells.
  EXPECT_LT(ratio, is_mixed ? 4 : 2);
}

TEST(MeshError, OfATipIsTrustedWithEnoughFacesUnderIt) {
  for (const bool is_fine : {false, true}) {
    const Touched touched(make_isotropic(Law::neo_hookean, 3000, 0.4),
                          is_fine ? std::array<int, 3>{4, 3, 3} : std::array<int, 3>{4, 3, 2},
                          false);
    const Equilibrium at = touched.touch();
    ASSERT_EQ(at.outcome, Outcome::converged);
    const MeshErrorEstimate estimate = touched.estimator().estimate(at, *touched.tool);
    EXPECT_EQ(estimate.is_bonded_to_few, !is_fine);
    EXPECT_EQ(estimate.is_reliable, is_fine);
  }
}

TEST(MeshError, IsNotTrustedWhereItWasNotFitted) {
  const Touched touched(make_isotropic(Law::neo_hookean, 3000, 0.4), {4, 3, 2}, false,
                        ElementOrder::linear);
  const Equilibrium at = touched.touch();
  ASSERT_EQ(at.outcome, Outcome::converged);
  const MeshErrorEstimator estimator = touched.estimator();
  const MeshErrorEstimate estimate = estimator.estimate(at, *touched.tool);
  EXPECT_FALSE(estimate.is_reliable);
  EXPECT_TRUE(estimate.force.allFinite());
  // Where the tool does nothing, there is no error.
  const MeshErrorEstimate none = estimator.estimate(touched.solver->rest(), *touched.tool);
  EXPECT_EQ(none.energy, 0);
  EXPECT_LT(none.force.norm(), 1e-9);
}

TEST(MeshError, IsNotTrustedWhereTheTangentChangesWithinTheError) {
  // White matter of a brain, which stiffens steeply where it is pressed.
  const double mu = 631;
  const Touched touched(palpate::make_material(Law::ogden, {100 * mu, mu, -24, 0, 0, 0, 0}),
                        {4, 3, 2}, true);
  const Equilibrium at = touched.touch();
  ASSERT_EQ(at.outcome, Outcome::converged);
  const MeshErrorEstimate estimate = touched.estimator().estimate(at, *touched.tool);
  EXPECT_TRUE(estimate.is_small);
  EXPECT_FALSE(estimate.is_reliable);
}

}  // namespace
}  // namespace palpate::test::test_mesh_error_estimate
