// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "assembly/mass.h"
#include "solvers/support/block.h"
#include "solvers/support/box_mesh.h"
#include "solvers/support/tangent.h"

namespace palpate::test::test_mass {
namespace {

constexpr double kDensity = 1050;

class Mass : public testing::TestWithParam<ElementOrder> {
 protected:
  TetMesh mesh_ = test::make_box(GetParam(), {2, 2, 2}, Vec3(0.1, 0.06, 0.05));
};

Scene scene_of(const TetMesh& mesh) {
  std::vector<char> fixed(mesh.points.size(), 0);
  for (std::size_t p = 0; p < fixed.size(); ++p) fixed[p] = mesh.points[p].x() == 0 ? 1 : 0;
  return test::make_scene(mesh, make_isotropic(Law::neo_hookean, 3000, 0.4), fixed);
}

TEST_P(Mass, OfRigidAndLinearVelocitiesIsTheirIntegral) {
  const Scene scene = scene_of(mesh_);
  const Assembly assembly(scene);
  const MassMatrix mass(scene.body, {kDensity}, assembly);
  const double volume = 0.1 * 0.06 * 0.05;
  EXPECT_NEAR(mass.total(), kDensity * volume, 1e-12 * kDensity * volume);
  // u = (x, 0, 0): ∫ ρ x² dV.
  NodalVector stretch = NodalVector::Zero(assembly.state_size());
  for (Index p = 0; p < mesh_.num_points(); ++p) stretch[3 * p] = mesh_.points[p].x();
  EXPECT_NEAR(stretch.dot(mass.times(stretch)), kDensity * volume * 0.01 / 3, 1e-15);
}

TEST_P(Mass, OfAQuadraticVelocityIsExactForTet10) {
  if (GetParam() != ElementOrder::quadratic) GTEST_SKIP() << "Tet4 has no such field";
  const Scene scene = scene_of(mesh_);
  const Assembly assembly(scene);
  const MassMatrix mass(scene.body, {kDensity}, assembly);
  NodalVector bend = NodalVector::Zero(assembly.state_size());
  for (Index p = 0; p < mesh_.num_points(); ++p) {
    bend[3 * p + 1] = mesh_.points[p].x() * mesh_.points[p].x();
  }
  const double integral = kDensity * 0.06 * 0.05 * std::pow(0.1, 5) / 5;
  EXPECT_NEAR(bend.dot(mass.times(bend)), integral, 1e-12 * integral);
}

TEST_P(Mass, IsAddedToTheTangentAsItIsMultiplied) {
  test::warp_curved(mesh_, test::wavy(Vec3(0.1, 0.06, 0.05)));
  const Scene scene = scene_of(mesh_);
  const Assembly assembly(scene);
  const MassMatrix mass(scene.body, {kDensity}, assembly);
  std::vector<double> values(assembly.pattern().num_values(), 0.0);
  mass.add_to(2, values);
  const Eigen::MatrixXd matrix = test::dense(assembly.pattern(), values);
  const auto& state = assembly.state_of_unknown();
  for (const Index unknown : {0, 7, 20}) {
    NodalVector unit = NodalVector::Zero(assembly.state_size());
    unit[state[unknown]] = 1;
    const NodalVector column = mass.times(unit);
    for (Index i = 0; i < matrix.rows(); ++i) {
      EXPECT_NEAR(matrix(i, unknown), 2 * column[state[i]], 1e-15) << i;
    }
  }
}

TEST_P(Mass, WeightIsThatOfTheBody) {
  const Scene scene = scene_of(mesh_);
  const Assembly assembly(scene);
  const MassMatrix mass(scene.body, {kDensity}, assembly);
  const NodalVector weight = mass.weight(Vec3(0, 0, -9.81));
  double sum = 0;
  for (Eigen::Index i = 2; i < weight.size(); i += 3) sum += weight[i];
  EXPECT_NEAR(sum, -9.81 * mass.total(), 1e-12);
}

TEST_P(Mass, AForceGivesTheAccelerationOfWhichItIsTheProduct) {
  const Scene scene = scene_of(mesh_);
  const Assembly assembly(scene);
  const MassMatrix mass(scene.body, {kDensity}, assembly);
  std::vector<char> free(scene.body.fixed.size());
  NodalVector acceleration = NodalVector::Zero(assembly.state_size());
  for (std::size_t p = 0; p < free.size(); ++p) {
    free[p] = scene.body.fixed[p] == 0 ? 1 : 0;
    if (free[p] != 0) acceleration[3 * static_cast<Eigen::Index>(p) + p % 3] = 1.0 + 0.1 * p;
  }
  const NodalVector found = mass.acceleration(mass.times(acceleration), free);
  EXPECT_LT((found - acceleration).norm(), 1e-11 * acceleration.norm());
}

INSTANTIATE_TEST_SUITE_P(Orders, Mass,
                         testing::Values(ElementOrder::linear, ElementOrder::quadratic));

}  // namespace
}  // namespace palpate::test::test_mass
