// SPDX-License-Identifier: BSD-3-Clause
// The mixed formulation: pressures at the corners beside the displacement.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>

#include "assembly/assembly.h"
#include "solvers/support/block.h"
#include "solvers/support/box_mesh.h"
#include "solvers/support/finite_difference.h"
#include "solvers/support/laws.h"
#include "solvers/support/orders.h"
#include "solvers/support/random.h"
#include "solvers/support/tangent.h"

namespace palpate::test::test_mixed {
namespace {

constexpr double kRounding = 1e-12;
/// Differences over a tenth of the random displacement below, extrapolated to O(h⁶).
constexpr double kDifference = 1e-8;
constexpr double kLength = 0.1;
constexpr double kSpacing = kLength / 2;

constexpr Law kAllLaws[] = {Law::linear,
                            Law::st_venant_kirchhoff,
                            Law::neo_hookean,
                            Law::mooney_rivlin,
                            Law::mooney_rivlin_polynomial,
                            Law::fung,
                            Law::neo_hookean_incompressible,
                            Law::mooney_rivlin_incompressible,
                            Law::ogden};

using Cells = std::tuple<ElementOrder, Law, Formulation>;

class Mixed : public testing::TestWithParam<Cells> {
 protected:
  Mixed() {
    Block block = make_block(law(), {order(), {2, 2, 1}, kLength, 3000, 0.49});
    warp_curved(block.scene.body.mesh, wavy(Vec3::Constant(kLength)));
    scene_ = std::move(block.scene);
    for (Material& material : scene_.organ.materials)
      material.formulation = std::get<2>(GetParam());
  }

  static ElementOrder order() { return std::get<0>(GetParam()); }
  static Law law() { return std::get<1>(GetParam()); }

  /// Large strains, without inversion, and pressures that do as much as they.
  NodalVector random_state(const Assembly& assembly) {
    return random_.vector(assembly.state_size(), 0.05 * kSpacing);
  }

  Scene scene_;
  Random random_{22};
};

std::string name_of_body(const testing::TestParamInfo<Cells>& info) {
  return name_of_order({std::get<0>(info.param), 0}) + letters(to_string(std::get<1>(info.param)));
}

INSTANTIATE_TEST_SUITE_P(Each, Mixed,
                         testing::Combine(testing::ValuesIn(kOrders), testing::ValuesIn(kAllLaws),
                                          testing::Values(Formulation::mixed)),
                         name_of_body);
INSTANTIATE_TEST_SUITE_P(FineQuadrature, Mixed,
                         testing::Combine(testing::ValuesIn(kOrders),
                                          testing::Values(Law::neo_hookean,
                                                          Law::mooney_rivlin_incompressible),
                                          testing::Values(Formulation::mixed_fine)),
                         name_of_body);

// A Tet4 has a constant strain; in a Tet10 the rules differ where the strain does.
TEST_P(Mixed, AnotherRuleOfQuadratureIsAnotherBodyForTet10Alone) {
  const Assembly assembly(scene_);
  EXPECT_EQ(assembly.takes_finer_quadrature(),
            order() == ElementOrder::quadratic && std::get<2>(GetParam()) == Formulation::mixed);
  Scene other = scene_;
  for (Material& material : other.organ.materials) {
    material.formulation =
        material.formulation == Formulation::mixed ? Formulation::mixed_fine : Formulation::mixed;
  }
  EXPECT_NE(hash(other), hash(scene_));
  const NodalVector x = random_state(assembly);
  NodalVector force;
  const double energy = assembly.residual(x, force).energy;
  const double of_other = Assembly(other).residual(x, force).energy;
  if (order() == ElementOrder::linear) {
    EXPECT_EQ(of_other, energy);
  } else {
    EXPECT_GT(std::abs(of_other - energy), 1e-6 * std::abs(energy));
  }
}

TEST_P(Mixed, AtRestThereIsNeitherEnergyNorForce) {
  const Assembly assembly(scene_);
  NodalVector force;
  const auto result = assembly.residual(NodalVector::Zero(assembly.state_size()), force);
  EXPECT_EQ(result.energy, 0);
  EXPECT_EQ(force.norm(), 0);
}

TEST_P(Mixed, ForceIsTheDerivativeOfTheEnergyByDisplacementAndPressure) {
  const Assembly assembly(scene_);
  ASSERT_GT(assembly.num_pressures(), 0);
  const NodalVector x = random_state(assembly);
  const NodalVector force = force_at(assembly, x);
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const double expected = derivative(
        [&](double s) {
          NodalVector unused;
          return assembly.residual(x + s * NodalVector::Unit(x.size(), i), unused).energy;
        },
        1e-3 * kSpacing);
    EXPECT_NEAR(force[i], expected, kDifference * force.lpNorm<Eigen::Infinity>()) << i;
  }
}

TEST_P(Mixed, TangentIsTheDerivativeOfTheForce) {
  const Assembly assembly(scene_);
  const NodalVector x = random_state(assembly);
  const Eigen::MatrixXd k = tangent_at(assembly, x);
  const auto& state_of_unknown = assembly.state_of_unknown();
  for (Index j = 0; j < assembly.pattern().size; ++j) {
    const NodalVector expected = derivative(
        [&](double s) {
          return force_at(assembly, x + s * NodalVector::Unit(x.size(), state_of_unknown[j]));
        },
        1e-3 * kSpacing);
    for (Index i = 0; i < assembly.pattern().size; ++i) {
      ASSERT_NEAR(k(i, j), expected[state_of_unknown[i]], kDifference * k.lpNorm<Eigen::Infinity>())
          << i << ' ' << j;
    }
  }
}

TEST_P(Mixed, WithTheRightPressureAUniformStrainHasTheEnergyOfTheLaw) {
  if (is_incompressible(law())) GTEST_SKIP() << "there is no energy of a change of volume";
  // Straight edges: the displacement of a uniform strain is in the space of both elements.
  scene_.body.mesh = make_box(order(), {2, 2, 1}, Vec3::Constant(kLength));
  scene_.body.material_of_cell.clear();
  scene_.body.fixed.assign(scene_.body.mesh.points.size(), 0);
  scene_.body.touchable = scene_.body.fixed;
  Mat3 h;
  h << 0.05, 0.02, -0.01, 0.03, -0.02, 0.04, 0.01, -0.03, 0.06;
  const Assembly mixed(scene_);
  for (Material& material : scene_.organ.materials)
    material.formulation = Formulation::displacement;
  const Assembly plain(scene_);

  const Mat3 f = Mat3::Identity() + h;
  double g = f.determinant() - 1;
  if (law() == Law::linear) g = h.trace();
  if (law() == Law::st_venant_kirchhoff) g = 0.5 * (f.transpose() * f - Mat3::Identity()).trace();
  if (law() == Law::neo_hookean) g = std::log(f.determinant());
  const double p = g / volumetric_compliance(scene_.organ.materials[0]) / mixed.pressure_scale()[0];
  NodalVector x = NodalVector::Constant(mixed.state_size(), p);
  for (Index i = 0; i < scene_.body.mesh.num_points(); ++i) {
    x.segment<3>(3 * i) = h * scene_.body.mesh.points[i];
  }
  NodalVector force;
  NodalVector force_of_plain;
  const double energy = mixed.residual(x, force).energy;
  const double expected = plain.residual(x.head(plain.state_size()), force_of_plain).energy;
  EXPECT_NEAR(energy, expected, kRounding * expected);
  const double scale = force_of_plain.lpNorm<Eigen::Infinity>();
  EXPECT_LT((force.head(plain.state_size()) - force_of_plain).lpNorm<Eigen::Infinity>(),
            kRounding * scale * 10);
  EXPECT_LT(force.tail(mixed.num_pressures()).lpNorm<Eigen::Infinity>(), kRounding * scale * 10);
}

class Pressures : public testing::TestWithParam<ElementOrder> {
 protected:
  Pressures() : block_(make_block(Law::neo_hookean, {GetParam(), {4, 2, 2}})) {
    block_.scene.body.material_of_cell.assign(block_.scene.body.mesh.num_cells(), 0);
  }

  /// Cells of the far half of the body get a material of their own.
  void give_far_half(const Material& material) {
    Scene& scene = block_.scene;
    scene.organ.materials.push_back(material);
    for (Index c = 0; c < scene.body.mesh.num_cells(); ++c) {
      double x = 0;
      for (int a = 0; a < 4; ++a) x += scene.body.mesh.points[scene.body.mesh.cell(c)[a]].x() / 4;
      if (x > 0.05) scene.body.material_of_cell[c] = 1;
    }
  }

  /// Corners of cells where `chosen` holds of their material.
  template <class F>
  [[nodiscard]] Index count_corners(const F& chosen) const {
    const Scene& scene = block_.scene;
    std::vector<char> is_corner(scene.body.mesh.points.size(), 0);
    for (Index c = 0; c < scene.body.mesh.num_cells(); ++c) {
      if (!chosen(scene.body.material_of_cell[c])) continue;
      for (int a = 0; a < 4; ++a) is_corner[scene.body.mesh.cell(c)[a]] = 1;
    }
    return static_cast<Index>(std::count(is_corner.begin(), is_corner.end(), 1));
  }

  Block block_;
};

INSTANTIATE_TEST_SUITE_P(Each, Pressures, testing::ValuesIn(kOrders), name_of_order);

TEST_P(Pressures, ACompressibleBodyHasNone) {
  const Assembly assembly(block_.scene);
  EXPECT_EQ(assembly.num_pressures(), 0);
  EXPECT_EQ(assembly.num_unknown_pressures(), 0);
  EXPECT_EQ(assembly.state_size(), 3 * assembly.num_points());
  EXPECT_TRUE(assembly.pressure_scale().empty());
}

TEST_P(Pressures, ThereAreSomeWhereTheMaterialIsMixedAndNowhereElse) {
  give_far_half(make_material(Law::neo_hookean, 3000, 0.499));
  const Assembly assembly(block_.scene);
  EXPECT_EQ(assembly.num_pressures(), count_corners([](Index material) { return material == 1; }));
  EXPECT_TRUE(assembly.multipliers().empty());
}

TEST_P(Pressures, AreSharedByMaterialsThatAreAlike) {
  block_.scene.organ.materials[0] = make_material(Law::neo_hookean, 3000, 0.49);
  give_far_half(make_material(Law::neo_hookean, 6000, 0.499));
  const Assembly assembly(block_.scene);
  EXPECT_EQ(assembly.num_pressures(), count_corners([](Index) { return true; }));
}

TEST_P(Pressures, JumpBetweenMaterialsOfVeryDifferentStiffness) {
  block_.scene.organ.materials[0] = make_material(Law::neo_hookean, 3000, 0.49);
  give_far_half(make_material(Law::neo_hookean, 3e6, 0.49));
  const Assembly assembly(block_.scene);
  EXPECT_EQ(assembly.num_pressures(),
            count_corners([](Index material) { return material == 0; }) +
                count_corners([](Index material) { return material == 1; }));
}

TEST_P(Pressures, OfIncompressibleMaterialsAreMultipliers) {
  block_.scene.organ.materials[0] = make_material(Law::neo_hookean_incompressible, 3000, 0.5);
  const Assembly assembly(block_.scene);
  EXPECT_EQ(static_cast<Index>(assembly.multipliers().size()), assembly.num_unknown_pressures());
  EXPECT_EQ(assembly.has_stabilised_pressures(), GetParam() == ElementOrder::linear);
  EXPECT_GT(assembly.num_unknown_pressures(), 0);
}

}  // namespace
}  // namespace palpate::test::test_mixed
