// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/error.h"
#include "dynamics/viscosity.h"
#include "solvers/support/block.h"
#include "solvers/support/box_mesh.h"
#include "solvers/support/finite_difference.h"
#include "solvers/support/laws.h"
#include "solvers/support/random.h"
#include "solvers/support/tangent.h"

namespace palpate::test::test_viscosity {
namespace {

struct Case {
  Law law;
  ElementOrder order;
  Formulation formulation = Formulation::displacement;
};

Scene in_formulation(Scene scene, Formulation formulation) {
  for (Material& material : scene.organ.materials) material.formulation = formulation;
  return scene;
}

class MemoryPotential : public testing::TestWithParam<Case> {
 protected:
  NodalVector random_state(double size) {
    NodalVector x(assembly_.state_size());
    for (Eigen::Index i = 0; i < x.size(); ++i) x[i] = size * (2.0 * random_() / random_.max() - 1);
    for (std::size_t p = 0; p < block_.scene.body.fixed.size(); ++p) {
      if (block_.scene.body.fixed[p] != 0) x.segment<3>(3 * static_cast<Eigen::Index>(p)).setZero();
    }
    return x;
  }

  std::mt19937 random_{3};
  test::Block block_ = test::make_block(GetParam().law, {GetParam().order, {2, 1, 1}});
  Scene scene_ = in_formulation(block_.scene, GetParam().formulation);
  Assembly assembly_{scene_};
};

TEST_P(MemoryPotential, ForceAndTangentAreItsDerivatives) {
  Rheology rheology;
  rheology.viscous_time = 0.05;
  rheology.prony_moduli = {0.4, 0.2};
  rheology.prony_times = {0.03, 0.5};
  Viscosity viscosity(scene_, {rheology}, assembly_, random_state(1e-3));
  (void)viscosity.begin_step(0.01, Vec3(100, -100, 0));
  viscosity.end_step(0.01, Vec3(100, -100, 0), random_state(1e-3));
  (void)viscosity.begin_step(0.02, Vec3(75, -100, 25));
  const NodalVector x = random_state(1e-3);
  const NodalVector way = random_state(1e-3);
  const auto evaluate = [&](double s, NodalVector& force) {
    const double energy = assembly_.residual(x + s * way, force).energy;
    return energy + assembly_.add_memory(viscosity.memory(), x + s * way, force);
  };
  NodalVector force;
  std::vector<double> values;
  assembly_.tangent(x, force, values);
  (void)assembly_.add_memory(viscosity.memory(), x, force, &values);
  const double slope = test::derivative(
      [&](double s) {
        NodalVector unused;
        return evaluate(s, unused);
      },
      0.1);
  EXPECT_NEAR(force.dot(way), slope, 1e-8 * std::abs(slope));
  const NodalVector change = test::derivative(
      [&](double s) {
        NodalVector there;
        (void)evaluate(s, there);
        return there;
      },
      0.1);
  const auto& state = assembly_.state_of_unknown();
  Eigen::VectorXd of_way(state.size());
  Eigen::VectorXd of_change(state.size());
  for (std::size_t i = 0; i < state.size(); ++i) {
    of_way[static_cast<Eigen::Index>(i)] = way[state[i]];
    of_change[static_cast<Eigen::Index>(i)] = change[state[i]];
  }
  const Eigen::VectorXd product = test::dense(assembly_.pattern(), values) * of_way;
  EXPECT_LT((product - of_change).norm(), 1e-8 * product.norm());
}

std::string name_of(const testing::TestParamInfo<Case>& of) {
  const char* formulations[] = {"", "Mixed", "MixedFine"};
  return test::letters(to_string(of.param.law)) +
         formulations[static_cast<int>(of.param.formulation)] +
         (of.param.order == ElementOrder::linear ? "Tet4" : "Tet10");
}

INSTANTIATE_TEST_SUITE_P(
    Laws, MemoryPotential,
    testing::Values(Case{Law::linear, ElementOrder::linear},
                    Case{Law::linear, ElementOrder::quadratic},
                    Case{Law::neo_hookean, ElementOrder::linear},
                    Case{Law::neo_hookean, ElementOrder::quadratic},
                    Case{Law::fung, ElementOrder::quadratic},
                    Case{Law::ogden, ElementOrder::quadratic},
                    Case{Law::neo_hookean, ElementOrder::quadratic, Formulation::mixed},
                    Case{Law::neo_hookean, ElementOrder::quadratic, Formulation::mixed_fine},
                    Case{Law::neo_hookean, ElementOrder::linear, Formulation::mixed_fine}),
    name_of);

/// The stress that a strain history in steps leaves, beside its closed form: E = ε t, so that each
/// term is g μ ε τ (1 − exp(−t/τ)) of a linear law, to the bit of the recursion.
TEST(Viscosity, ATermOfTheSeriesIsExactForAStrainThatGrowsEvenly) {
  test::Block block = test::make_block(Law::linear, {ElementOrder::linear, {1, 1, 1}});
  Assembly assembly(block.scene);
  Rheology rheology;
  rheology.prony_moduli = {0.7};
  rheology.prony_times = {0.2};
  const auto strained = [&](double gradient) {
    NodalVector x = NodalVector::Zero(assembly.state_size());
    for (Index p = 0; p < block.scene.body.mesh.num_points(); ++p) {
      x[3 * p + 1] = gradient * block.scene.body.mesh.points[p].x();
    }
    return x;
  };
  Viscosity viscosity(block.scene, {rheology}, assembly, strained(0));
  double t = 0;
  for (const double h : {0.05, 0.01, 0.2, 0.3}) {
    (void)viscosity.begin_step(h, Vec3(1 / h, -1 / h, 0));
    t += h;
    viscosity.end_step(h, Vec3(1 / h, -1 / h, 0), strained(1e-3 * t));
    const double mu = shear_modulus(block.scene.organ.materials[0]);
    const double exact = 0.7 * mu * 1e-3 * 0.2 * (1 - std::exp(-t / 0.2));
    EXPECT_NEAR(viscosity.stress_now().stress[0][5 * 8], exact, 1e-12 * exact) << t;
  }
  EXPECT_GT(viscosity.stored(), 0);
  EXPECT_GT(viscosity.work(), viscosity.stored());
}

TEST(Rheology, ABadNumberIsRefusedByName) {
  const auto message = [](const Rheology& rheology) {
    try {
      validate(rheology);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(message({}), "");
  EXPECT_NE(message({-1, 0, {}, {}}).find("Density"), std::string::npos);
  EXPECT_NE(message({1, std::nan(""), {}, {}}).find("ViscousTime"), std::string::npos);
  EXPECT_NE(message({1, 0, {-0.1}, {1}}).find("PronyModuli"), std::string::npos);
  EXPECT_NE(message({1, 0, {0.1}, {std::numeric_limits<double>::infinity()}}).find("PronyTimes"),
            std::string::npos);
  EXPECT_NE(message({1, 0, {0.1}, {}}).find("Term 1"), std::string::npos);
  EXPECT_NE(message({1, 0, {0.1, 0.2}, {2, 1}}).find("Sort"), std::string::npos);
}

TEST(Rheology, ComesBackFromItsValues) {
  const Rheology rheology{1000, 0.01, {0.5, 0.2, 0.1, 0.3}, {0.1, 0.2, 1, 7}};
  EXPECT_EQ(make_rheology(values_of(rheology)), rheology);
  EXPECT_EQ(rheology_names().back(), "PronyTime4");
  EXPECT_EQ(values_of(rheology).back(), 7);
  EXPECT_THROW((void)make_rheology({-1}), InputError);
}

}  // namespace
}  // namespace palpate::test::test_viscosity
