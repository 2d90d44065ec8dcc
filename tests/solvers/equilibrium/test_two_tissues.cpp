// SPDX-License-Identifier: BSD-3-Clause
// A ball of one tissue in a shell of another under uniform pressure: the whole has the bulk modulus
// of a composite sphere (Hashin, The Elastic Moduli of Heterogeneous Materials, 1962). Its surface
// is moved towards one of its points in proportion, which is what a uniform pressure does to it.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "equilibrium/equilibrium.h"
#include "interaction/bonded_patch.h"
#include "solvers/equilibrium/options.h"
#include "solvers/support/block.h"
#include "solvers/support/box_mesh.h"
#include "solvers/support/laws.h"

namespace palpate::test::test_two_tissues {
namespace {

constexpr double kStrain = 1e-5;

/// Cubes within cubes become balls within balls.
TetMesh make_ball(int cubes) {
  TetMesh mesh = make_box(ElementOrder::quadratic, {cubes, cubes, cubes}, Vec3::Constant(2));
  warp_straight(mesh, [](const Vec3& place) -> Vec3 {
    const Vec3 p = place - Vec3::Ones();
    const double norm = p.norm();
    return norm == 0 ? p : Vec3(p * (p.lpNorm<Eigen::Infinity>() / norm));
  });
  return mesh;
}

double bulk_modulus_of_both(const Material& core, const Material& shell, double share) {
  const double difference = bulk_modulus(core) - bulk_modulus(shell);
  return bulk_modulus(shell) + share * difference /
                                   (1 + (1 - share) * difference /
                                            (bulk_modulus(shell) + 4.0 / 3 * shear_modulus(shell)));
}

/// Relative error of the energy. `inner` is the radius of the core; that of the ball is 1.
double error_of(int cubes, double inner, const Material& core, const Material& shell) {
  const TetMesh mesh = make_ball(cubes);
  const TetMesh box = make_box(ElementOrder::quadratic, {cubes, cubes, cubes}, Vec3::Constant(2));
  const auto level = [&](Index p) {
    return (box.points[p] - Vec3::Ones()).lpNorm<Eigen::Infinity>();
  };
  std::vector<char> fixed(mesh.points.size(), 0);
  std::vector<Index> held;
  for (Index p = 0; p < mesh.num_points(); ++p) {
    if (level(p) > 1 - 1e-9) held.push_back(p);
  }
  const Index still = held.front();
  held.erase(held.begin());
  fixed[still] = 1;
  Scene scene = make_scene(mesh, shell, fixed);
  scene.organ.materials.push_back(core);
  double volume = 0;
  double core_volume = 0;
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    const Index* cell = &mesh.cells[10 * static_cast<std::size_t>(c)];
    Mat3 edges;
    double middle = 0;
    for (int i = 0; i < 4; ++i) {
      middle = std::max(middle, level(cell[i]));
      if (i > 0) edges.col(i - 1) = mesh.points[cell[i]] - mesh.points[cell[0]];
    }
    const bool is_core = middle < inner + 1e-9;
    scene.body.material_of_cell.push_back(is_core ? 1 : 0);
    const double of_cell = std::abs(edges.determinant()) / 6;
    volume += of_cell;
    core_volume += is_core ? of_cell : 0;
  }
  Eigen::VectorXd t(3 * held.size());
  for (std::size_t i = 0; i < held.size(); ++i) {
    t.segment<3>(3 * i) = -kStrain * (mesh.points[held[i]] - mesh.points[still]);
  }
  EquilibriumSolver solver(scene, with_tolerance(1e-10));
  solver.set_interaction(bond_nodes(held));
  const Equilibrium state = solver.solve(t, solver.rest());
  EXPECT_EQ(state.outcome, Outcome::converged) << state.summary.message;
  const double bulk = bulk_modulus_of_both(core, shell, core_volume / volume);
  return state.energy / (0.5 * bulk * std::pow(3 * kStrain, 2) * volume) - 1;
}

class TwoTissues : public testing::TestWithParam<Law> {};
INSTANTIATE_TEST_SUITE_P(Each, TwoTissues,
                         testing::Values(Law::linear, Law::neo_hookean, Law::ogden), name_of_law);

TEST_P(TwoTissues, ACompositeSphereHasItsBulkModulus) {
  const Material soft = make_material(GetParam(), 3000, 0.2);
  const Material stiff = make_material(GetParam(), 12000, 0.35);
  for (bool stiff_inside : {true, false}) {
    const Material& core = stiff_inside ? stiff : soft;
    const Material& shell = stiff_inside ? soft : stiff;
    // Two tissues are far from one: the whole as if of the shell alone would be off by more.
    EXPECT_GT(std::abs(bulk_modulus_of_both(core, shell, 0.125) / bulk_modulus(shell) - 1), 0.07);
    EXPECT_LT(std::abs(error_of(4, 0.5, core, shell)), 0.01);
  }
}

// The facets of the wall are a share of its curvature off: of the square of the edge.
TEST(TwoTissues, TheErrorFallsWithTheSquareOfTheEdge) {
  const Material core = make_material(Law::linear, 12000, 0.35);
  const Material shell = make_material(Law::linear, 3000, 0.2);
  const double coarse = error_of(3, 1.0 / 3, core, shell);
  const double fine = error_of(6, 1.0 / 3, core, shell);
  EXPECT_LT(std::abs(fine), 0.35 * std::abs(coarse));
}

}  // namespace
}  // namespace palpate::test::test_two_tissues
