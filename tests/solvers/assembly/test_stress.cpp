// SPDX-License-Identifier: BSD-3-Clause
// Stress and stretch against formulas apart from those of the program, and against what they must
// obey in any state.
#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>
#include <vector>

#include "assembly/kernels.h"
#include "assembly/stress.h"
#include "solvers/support/block.h"
#include "solvers/support/box_mesh.h"
#include "solvers/support/closed_form.h"
#include "solvers/support/laws.h"
#include "solvers/support/orders.h"
#include "solvers/support/random.h"
#include "solvers/support/tangent.h"

namespace palpate::test::test_stress {
namespace {

/// Some hundred operations, of which strains near one make little of the rounding.
constexpr double kRounding = 1e-12;
constexpr double kLength = 0.1;

constexpr Law kAllLaws[] = {Law::linear,
                            Law::st_venant_kirchhoff,
                            Law::neo_hookean,
                            Law::mooney_rivlin,
                            Law::mooney_rivlin_polynomial,
                            Law::fung,
                            Law::neo_hookean_incompressible,
                            Law::mooney_rivlin_incompressible,
                            Law::ogden};

Eigen::Matrix<double, 6, 1> components(const Mat3& m) {
  Eigen::Matrix<double, 6, 1> six;
  six << m(0, 0), m(1, 1), m(2, 2), m(0, 1), m(1, 2), m(0, 2);
  return six;
}

Mat3 tensor(const Eigen::Matrix<double, 6, 1>& s) {
  Mat3 m;
  m << s[0], s[3], s[5], s[3], s[1], s[4], s[5], s[4], s[2];
  return m;
}

/// @param x Displacement and scaled pressures.
BodyStress stress_of(const Assembly& assembly, const TetMesh& mesh, const NodalVector& x) {
  NodalVector p = x.tail(assembly.num_pressures());
  for (Eigen::Index i = 0; i < p.size(); ++i) p[i] *= assembly.pressure_scale()[i];
  return find_stress(assembly, mesh, x.head(3 * Eigen::Index{mesh.num_points()}), p);
}

using Body = std::tuple<ElementOrder, Law, Formulation>;

class Stress : public testing::TestWithParam<Body> {
 protected:
  static ElementOrder order() { return std::get<0>(GetParam()); }
  static Law law() { return std::get<1>(GetParam()); }
  static bool is_mixed() { return std::get<2>(GetParam()) == Formulation::mixed; }

  void SetUp() override {
    if (is_incompressible(law()) && !is_mixed()) GTEST_SKIP() << "it has no such formulation";
    scene_ = make_block(law(), {order(), {2, 2, 1}, kLength, 3000, is_mixed() ? 0.49 : 0.35}).scene;
    for (Material& material : scene_.organ.materials)
      material.formulation = std::get<2>(GetParam());
  }

  [[nodiscard]] NodalVector random_state(const Assembly& assembly) {
    return random_.vector(assembly.state_size(), 0.025 * kLength);
  }

  Scene scene_;
  Random random_{22};
};

std::string name_of_body(const testing::TestParamInfo<Body>& info) {
  return name_of_order({std::get<0>(info.param), 0}) + letters(to_string(std::get<1>(info.param))) +
         (std::get<2>(info.param) == Formulation::mixed ? "Mixed" : "");
}

INSTANTIATE_TEST_SUITE_P(Each, Stress,
                         testing::Combine(testing::ValuesIn(kOrders), testing::ValuesIn(kAllLaws),
                                          testing::Values(Formulation::displacement,
                                                          Formulation::mixed)),
                         name_of_body);

TEST_P(Stress, OfAUniformDeformationIsThatOfTheLaw) {
  scene_.organ.materials.resize(1);
  scene_.body.material_of_cell.clear();
  // Straight edges: a linear displacement is then one in both elements.
  scene_.body.mesh = make_box(order(), {2, 2, 1}, Vec3::Constant(kLength));
  scene_.body.fixed.assign(scene_.body.mesh.points.size(), 0);
  scene_.body.touchable = scene_.body.fixed;
  const Material& material = scene_.organ.materials[0];
  const Assembly assembly(scene_);
  Mat3 shear = Mat3::Identity();
  shear(0, 1) = 0.4;
  const double small = 1e-6;
  for (const Mat3& f :
       {Mat3(Vec3(1.4, 0.9, 0.85).asDiagonal()), Mat3(0.9 * Mat3::Identity()), shear,
        random_.deformation_gradient(1.2, 0.3), Mat3(Mat3::Identity() + small * Mat3::Random())}) {
    const double pressure = is_incompressible(law()) ? 500 : pressure_of(material, f);
    NodalVector x(assembly.state_size());
    for (Index i = 0; i < scene_.body.mesh.num_points(); ++i) {
      x.segment<3>(3 * i) = (f - Mat3::Identity()) * scene_.body.mesh.points[i];
    }
    if (is_mixed()) {
      x.tail(assembly.num_pressures()).setConstant(pressure / assembly.pressure_scale()[0]);
    }
    const BodyStress stress = stress_of(assembly, scene_.body.mesh, x);
    const Mat3 cauchy = cauchy_stress(material, f, pressure);
    const Mat3 deviator = cauchy - cauchy.trace() / 3 * Mat3::Identity();
    const Vec3 stretches = Eigen::JacobiSVD<Mat3>(f).singularValues();
    // The formulas of the test lose the digits of small strains.
    const double of_stress =
        kRounding * std::max(shear_modulus(material) * 10, 10 * std::abs(pressure));
    for (const StressField* field : {&stress.of_cells, &stress.at_points}) {
      for (Eigen::Index i = 0; i < field->von_mises.size(); ++i) {
        EXPECT_LT((field->cauchy.col(i) - components(cauchy)).norm(), of_stress);
        EXPECT_NEAR(field->von_mises[i], std::sqrt(1.5) * deviator.norm(), of_stress);
        EXPECT_LT((field->principal_stretches.col(i) - stretches).norm(), kRounding);
      }
    }
    EXPECT_EQ(stress.of_cells.von_mises.size(), scene_.body.mesh.num_cells());
    EXPECT_EQ(stress.at_points.von_mises.size(), scene_.body.mesh.num_points());
  }
}

TEST_P(Stress, TurnsWithTheBody) {
  if (law() == Law::linear) GTEST_SKIP() << "small strains know no rotation";
  const Assembly assembly(scene_);
  const NodalVector x = random_state(assembly);
  const Mat3 rotation = random_.rotation();
  NodalVector turned = x;
  for (Index i = 0; i < scene_.body.mesh.num_points(); ++i) {
    const Vec3& rest = scene_.body.mesh.points[i];
    turned.segment<3>(3 * i) = rotation * (rest + x.segment<3>(3 * i)) - rest;
  }
  const StressField before = stress_of(assembly, scene_.body.mesh, x).of_cells;
  const StressField after = stress_of(assembly, scene_.body.mesh, turned).of_cells;
  const double scale = before.cauchy.lpNorm<Eigen::Infinity>();
  for (Index c = 0; c < scene_.body.mesh.num_cells(); ++c) {
    const Mat3 expected = rotation * tensor(before.cauchy.col(c)) * rotation.transpose();
    EXPECT_LT((tensor(after.cauchy.col(c)) - expected).norm(), 100 * kRounding * scale);
    EXPECT_NEAR(after.von_mises[c], before.von_mises[c], 100 * kRounding * scale);
  }
  EXPECT_LT((after.principal_stretches - before.principal_stretches).lpNorm<Eigen::Infinity>(),
            kRounding);
}

// Σ f_a ⊗ x_a = ∫ σ dv: what the forces at the nodes do is the mean stress (the virial of the
// body).
TEST_P(Stress, BalancesTheForcesAtTheNodes) {
  const Assembly assembly(scene_);
  const NodalVector x = random_state(assembly);
  const NodalVector force = force_at(assembly, x);
  Mat3 virial = Mat3::Zero();
  for (Index i = 0; i < scene_.body.mesh.num_points(); ++i) {
    Vec3 place = scene_.body.mesh.points[i];
    if (law() != Law::linear) place += x.segment<3>(3 * i);
    virial += force.segment<3>(3 * i) * place.transpose();
  }
  const StressField field = stress_of(assembly, scene_.body.mesh, x).of_cells;
  const Eigen::MatrixXd sums = assembly.stress_sums(x);
  Mat3 whole = Mat3::Zero();
  double sum_of_norms = 0;
  for (Index c = 0; c < scene_.body.mesh.num_cells(); ++c) {
    const Mat3 of_cell = sums(StressSum::deformed_volume, c) * tensor(field.cauchy.col(c));
    whole += of_cell;
    sum_of_norms += of_cell.norm();
  }
  EXPECT_LT((whole - virial).norm(), kRounding * sum_of_norms);
  EXPECT_GT(whole.norm(), 0.01 * sum_of_norms);
}

TEST_P(Stress, AtAPointIsTheMeanOfTheCellsAround) {
  const Assembly assembly(scene_);
  const NodalVector x = random_state(assembly);
  const BodyStress stress = stress_of(assembly, scene_.body.mesh, x);
  const Eigen::MatrixXd sums = assembly.stress_sums(x);
  const TetMesh& mesh = scene_.body.mesh;
  for (Index p = 0; p < mesh.num_points(); ++p) {
    double volume = 0;
    Eigen::Matrix<double, 6, 1> cauchy = Eigen::Matrix<double, 6, 1>::Zero();
    for (Index c = 0; c < mesh.num_cells(); ++c) {
      const Index* nodes = mesh.cell(c);
      if (std::find(nodes, nodes + nodes_per_cell(mesh.order), p) ==
          nodes + nodes_per_cell(mesh.order)) {
        continue;
      }
      volume += sums(StressSum::volume, c);
      cauchy += sums(StressSum::volume, c) * stress.of_cells.cauchy.col(c);
    }
    EXPECT_LT((stress.at_points.cauchy.col(p) - cauchy / volume).norm(),
              kRounding * stress.of_cells.cauchy.lpNorm<Eigen::Infinity>());
  }
}

TEST_P(Stress, ThereIsNoneInACellThatIsInverted) {
  // A point in no cell comes last.
  scene_.body.mesh.points.push_back(Vec3::Constant(1));
  scene_.body.fixed.push_back(0);
  scene_.body.touchable.push_back(0);
  const Assembly assembly(scene_);
  const TetMesh& mesh = scene_.body.mesh;
  NodalVector x = NodalVector::Zero(assembly.state_size());
  // All nodes of a cell but the points of one face are pushed through that face.
  const Index* cell = mesh.cell(0);
  const Vec3 middle = (mesh.points[cell[1]] + mesh.points[cell[2]] + mesh.points[cell[3]]) / 3;
  x.segment<3>(3 * cell[0]) = 3 * (middle - mesh.points[cell[0]]);
  const BodyStress stress = stress_of(assembly, mesh, x);
  Index num_without = 0;
  std::vector<char> has_stress(mesh.points.size(), 0);
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    const bool inverted =
        law() != Law::linear && !(assembly.stress_sums(x)(StressSum::minimum_det_f, c) > 0);
    num_without += inverted ? 1 : 0;
    EXPECT_EQ(stress.of_cells.cauchy.col(c).hasNaN(), inverted) << c;
    EXPECT_EQ(std::isnan(stress.of_cells.von_mises[c]), inverted) << c;
    for (int a = 0; a < nodes_per_cell(mesh.order) && !inverted; ++a)
      has_stress[mesh.cell(c)[a]] = 1;
  }
  for (Index p = 0; p < mesh.num_points(); ++p) {
    EXPECT_EQ(stress.at_points.cauchy.col(p).allFinite(), has_stress[p] != 0) << p;
    EXPECT_EQ(std::isfinite(stress.at_points.von_mises[p]), has_stress[p] != 0) << p;
  }
  EXPECT_EQ(num_without > 0, law() != Law::linear);
  EXPECT_LT(num_without, mesh.num_cells());
  EXPECT_TRUE(stress.of_cells.principal_stretches.allFinite());
  const Index unused = mesh.num_points() - 1;
  EXPECT_TRUE(stress.at_points.principal_stretches.leftCols(unused).allFinite());
  EXPECT_TRUE(std::isnan(stress.at_points.von_mises[unused]));
  EXPECT_TRUE(std::isnan(stress.at_points.principal_stretches(0, unused)));
}

}  // namespace
}  // namespace palpate::test::test_stress
