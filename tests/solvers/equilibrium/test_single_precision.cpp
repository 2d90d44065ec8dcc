// SPDX-License-Identifier: BSD-3-Clause
// Factors in single precision change what is found in the last digits alone.
#include <gtest/gtest.h>

#include <memory>

#include "equilibrium/equilibrium.h"
#include "linear/linear_solver.h"
#include "solvers/support/block.h"
#include "solvers/support/bodies.h"

namespace palpate {
namespace {


struct Both {
  Equilibrium full;
  Equilibrium single;
};

/// A way in two steps, the second to a state from which no other starts.
Both solve(const Scene& scene, Index node, const Vec3& t) {
  Both both;
  for (const bool single : {false, true}) {
    EquilibriumOptions options;
    options.single_precision = single;
    EquilibriumSolver solver(scene, options);
    solver.hold(hold_nodes({node}));
    const Equilibrium middle = solver.solve(0.5 * t, solver.rest());
    EXPECT_EQ(middle.outcome, Outcome::converged) << middle.message;
    (single ? both.single : both.full) = solver.solve(t, middle, Tangent::iterated);
  }
  return both;
}

void expect_same(const Both& both) {
  const auto& [full, single] = both;
  ASSERT_EQ(full.outcome, Outcome::converged) << full.message;
  ASSERT_EQ(single.outcome, Outcome::converged) << single.message;
  EXPECT_LE((full.u - single.u).lpNorm<Eigen::Infinity>(),
            2e-8 * full.u.lpNorm<Eigen::Infinity>());
  EXPECT_LE((full.v - single.v).norm(), 3e-4 * full.v.norm());
  EXPECT_LE((full.reaction - single.reaction).norm(), 1e-7 * full.reaction.norm());
  EXPECT_LE((full.stiffness - single.stiffness).norm(), 1e-6 * full.stiffness.norm());
  EXPECT_NEAR(full.energy, single.energy, 1e-10 * full.energy);
}

TEST(SinglePrecision, FindsTheSame) {
  for (const Law law : {Law::linear, Law::st_venant_kirchhoff, Law::neo_hookean,
                        Law::mooney_rivlin, Law::fung}) {
    const test::Block block = test::make_block(law);
    expect_same(solve(block.scene, block.corner, Vec3(0.015, -0.01, 0.008)));
  }
}

TEST(SinglePrecision, SensitivityOfAStartIsRefined) {
  const test::Block block = test::make_block(Law::neo_hookean);
  EquilibriumOptions options;
  std::vector<Equilibrium> states;
  for (const bool single : {false, true}) {
    options.single_precision = single;
    EquilibriumSolver solver(block.scene, options);
    solver.hold(hold_nodes({block.corner}));
    states.push_back(solver.solve(Vec3(0.01, 0.004, 0), solver.rest()));
  }
  EXPECT_LE((states[0].v - states[1].v).norm(), 1e-7 * states[0].v.norm());
  EXPECT_LE((states[0].stiffness - states[1].stiffness).norm(),
            1e-8 * states[0].stiffness.norm());
  EXPECT_EQ(states[0].negative_pivots, states[1].negative_pivots);
}

// Where single precision is not enough, or no scene for it, factors are of full precision.
TEST(SinglePrecision, IsLeftAsideWhereItIsNotSafe) {
  test::Block block = test::make_block(Law::neo_hookean);
  block.scene.materials.push_back(make_isotropic(Law::neo_hookean, 3e12, 0.35));
  block.scene.material_of_cell.assign(block.scene.mesh.num_cells(), 0);
  block.scene.material_of_cell[block.scene.mesh.num_cells() / 2] = 1;
  expect_same(solve(block.scene, block.corner, Vec3(0.004, -0.002, 0.003)));

  const test::Block mixed = test::make_block(
      Law::neo_hookean, {ElementOrder::linear, {3, 2, 2}, 0.1, 3000, 0.499});
  expect_same(solve(mixed.scene, mixed.corner, Vec3(0.01, -0.002, 0.003)));
}

// The unit has no part.
TEST(SinglePrecision, ScalesByPowersOfTwo) {
  std::vector<Equilibrium> states;
  for (const double unit : {1.0, 0x1p20}) {
    const test::Block block = test::make_block(
        Law::neo_hookean, {ElementOrder::quadratic, {3, 2, 2}, 0.1, 3000 * unit, 0.35});
    EquilibriumOptions options;
    options.single_precision = true;
    EquilibriumSolver solver(block.scene, options);
    solver.hold(hold_nodes({block.corner}));
    states.push_back(solver.solve(Vec3(0.01, 0.004, 0), solver.rest()));
  }
  EXPECT_EQ(states[0].u, states[1].u);
  EXPECT_EQ(0x1p20 * states[0].reaction, states[1].reaction);
}

}  // namespace
}  // namespace palpate
