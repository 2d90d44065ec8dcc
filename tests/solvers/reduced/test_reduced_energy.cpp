// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "assembly/assembly.h"
#include "assembly/mass.h"
#include "reduced/point_memory.h"
#include "reduced/reduced_energy.h"
#include "solvers/reduced/whole_model.h"
#include "solvers/support/block.h"
#include "solvers/support/finite_difference.h"
#include "solvers/support/laws.h"
#include "solvers/support/random.h"

namespace palpate::test::test_reduced_energy {
namespace {

struct Case {
  Law law;
  ElementOrder order;
};

class OfEachLaw : public testing::TestWithParam<Case> {
 protected:
  OfEachLaw() {
    tools_.add(BondedPatch({block_.corner}));
    tools_.add(BondedPatch({block_.middle}));
    Rheology rheology;
    rheology.density = 1000;
    rheology.viscous_time = 0.05;
    rheology.prony_moduli = {0.4, 0.2};
    rheology.prony_times = {0.03, 0.5};
    whole_ = test::make_whole_model(block_.scene, {rheology}, tools_);
    sagging_ = test::make_whole_model(block_.scene, {rheology}, tools_, 0.01, gravity_);
  }

  void expect_derivatives(const test::WholeModel& whole);

  test::Random random_{5};
  test::Block block_ = test::make_block(GetParam().law, {GetParam().order, {1, 1, 1}});
  InteractionList tools_;
  const Vec3 gravity_{1, -2, -9};
  test::WholeModel whole_;
  /// Under gravity.
  test::WholeModel sagging_;
};

TEST_P(OfEachLaw, EnergyAndForceAreThoseOfTheWholeBody) {
  const Assembly assembly(block_.scene);
  ReducedEnergy energy(whole_.model.points, whole_.model.materials);
  const Eigen::VectorXd y = random_.vector(whole_.basis.cols(), 1e-3);
  const NodalVector u = whole_.basis * y;
  NodalVector force;
  const Assembly::Result whole = assembly.residual(u, force);
  const ReducedSums sums = energy.evaluate(y.data());
  EXPECT_NEAR(sums.potential, whole.energy, 1e-12 * whole.energy);
  EXPECT_EQ(sums.elastic, sums.potential);
  EXPECT_NEAR(sums.minimum_det_f, whole.minimum_det_f, 1e-12);
  const Eigen::VectorXd expected = whole_.basis.transpose() * force;
  EXPECT_LT((energy.force() - expected).norm(), 1e-11 * expected.norm());
}

TEST_P(OfEachLaw, UnderGravityTheyCountFromTheRest) {
  const Assembly assembly(block_.scene);
  ReducedEnergy energy(sagging_.model.points, sagging_.model.materials);
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(sagging_.basis.cols());
  EXPECT_EQ(energy.evaluate(zero.data()).elastic, 0);
  EXPECT_EQ(energy.force(), zero);
  EXPECT_GT(sagging_.rest.lpNorm<Eigen::Infinity>(), 1e-4);
  const NodalVector weight =
      weight_of(with_gravity(block_.scene, sagging_.model.rheologies, gravity_), assembly);
  const Eigen::VectorXd y = random_.vector(zero.size(), 1e-3);
  const NodalVector way = sagging_.basis * y;
  NodalVector force;
  const double at_rest = assembly.residual(sagging_.rest, force).energy;
  const Assembly::Result whole = assembly.residual(sagging_.rest + way, force);
  const ReducedSums sums = energy.evaluate(y.data());
  // The whole body's rest has a residual of its own.
  EXPECT_NEAR(sums.elastic, whole.energy - at_rest - weight.dot(way), 1e-8 * whole.energy);
  EXPECT_NEAR(sums.minimum_det_f, whole.minimum_det_f, 1e-12);
  const Eigen::VectorXd expected = sagging_.basis.transpose() * (force - weight);
  EXPECT_LT((energy.force() - expected).norm(), 1e-8 * expected.norm());
}

TEST_P(OfEachLaw, ForceAndTangentAreDerivatives) { expect_derivatives(whole_); }
TEST_P(OfEachLaw, UnderGravityForceAndTangentAreDerivatives) { expect_derivatives(sagging_); }

void OfEachLaw::expect_derivatives(const test::WholeModel& whole) {
  ReducedEnergy energy(whole.model.points, whole.model.materials);
  PointMemory memory(whole.model);
  energy.set_memory({memory.factors().data(), memory.stress().data(), memory.moduli().data()});
  const Eigen::Index n = whole.basis.cols();
  memory.begin_step(0.01, Vec3(100, -100, 0));
  (void)energy.evaluate(random_.vector(n, 1e-3).eval().data());
  memory.end_step(energy.law_stress().data(), energy.strain().data());
  memory.begin_step(0.02, Vec3(75, -100, 25));
  const Eigen::VectorXd y = random_.vector(n, 1e-3);
  const Eigen::VectorXd way = random_.vector(n, 1e-3);
  const auto at = [&](double s) { return (y + s * way).eval(); };
  (void)energy.linearise(y.data());
  const Eigen::VectorXd force = energy.force();
  const Eigen::MatrixXd tangent = energy.tangent().selfadjointView<Eigen::Lower>();
  const double slope =
      test::derivative([&](double s) { return energy.evaluate(at(s).data()).potential; }, 0.1);
  EXPECT_NEAR(force.dot(way), slope, 1e-8 * std::abs(slope));
  const Eigen::VectorXd change = test::derivative(
      [&](double s) {
        (void)energy.evaluate(at(s).data());
        return Eigen::VectorXd(energy.force());
      },
      0.1);
  // The tangent is of single precision.
  EXPECT_LT((tangent * way - change).norm(), 1e-5 * change.norm());
}

INSTANTIATE_TEST_SUITE_P(Laws, OfEachLaw,
                         testing::Values(Case{Law::linear, ElementOrder::linear},
                                         Case{Law::linear, ElementOrder::quadratic},
                                         Case{Law::st_venant_kirchhoff, ElementOrder::linear},
                                         Case{Law::neo_hookean, ElementOrder::linear},
                                         Case{Law::neo_hookean, ElementOrder::quadratic},
                                         Case{Law::mooney_rivlin, ElementOrder::linear},
                                         Case{Law::mooney_rivlin_polynomial, ElementOrder::linear},
                                         Case{Law::fung, ElementOrder::linear},
                                         Case{Law::ogden, ElementOrder::linear}),
                         [](const auto& of) {
                           return test::letters(to_string(of.param.law)) +
                                  (of.param.order == ElementOrder::linear ? "Tet4" : "Tet10");
                         });

TEST(ReducedEnergy, OfABodyOfSeveralLawsIsThatOfTheWholeBody) {
  test::Block block = test::make_block(Law::neo_hookean, {ElementOrder::quadratic, {2, 1, 1}});
  Scene& scene = block.scene;
  scene.organ.materials = {test::make_material(Law::neo_hookean, 3000, 0.3),
                           test::make_material(Law::fung, 9000, 0.4),
                           test::make_material(Law::neo_hookean, 20000, 0.2)};
  for (Index c = 0; c < scene.body.mesh.num_cells(); ++c)
    scene.body.material_of_cell.push_back(c % 3);
  InteractionList tools;
  tools.add(BondedPatch({block.corner}));
  std::vector<Rheology> rheologies(3);
  rheologies[0].density = 1000;
  rheologies[2].density = 2000;
  const test::WholeModel whole = test::make_whole_model(scene, rheologies, tools);
  ASSERT_EQ(whole.model.points.groups.size(), 2u);
  EXPECT_EQ(whole.model.points.num_points(), 4 * scene.body.mesh.num_cells());
  const Assembly assembly(scene);
  ReducedEnergy energy(whole.model.points, whole.model.materials);
  test::Random random(8);
  const Eigen::VectorXd y = random.vector(whole.basis.cols(), 1e-3);
  NodalVector force;
  const Assembly::Result expected = assembly.residual(whole.basis * y, force);
  const ReducedSums sums = energy.evaluate(y.data());
  EXPECT_NEAR(sums.potential, expected.energy, 1e-12 * expected.energy);
  EXPECT_NEAR(sums.minimum_det_f, expected.minimum_det_f, 1e-12);
  const Eigen::VectorXd of_basis = whole.basis.transpose() * force;
  EXPECT_LT((energy.force() - of_basis).norm(), 1e-11 * of_basis.norm());
  const MassMatrix mass(scene.body, {1000, 0, 2000}, assembly);
  const NodalVector of_mass = mass.times(whole.basis * y).head(whole.basis.rows());
  EXPECT_NEAR(y.dot(whole.model.mass * y), (whole.basis * y).dot(of_mass),
              1e-12 * y.dot(whole.model.mass * y));
}

}  // namespace
}  // namespace palpate::test::test_reduced_energy
