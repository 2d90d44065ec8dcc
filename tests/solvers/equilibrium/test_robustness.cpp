// SPDX-License-Identifier: BSD-3-Clause
// Scenes and displacements at the limits end in an equilibrium or with a reason, never in numbers
// that are none.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "equilibrium/equilibrium.h"
#include "interaction/bonded_patch.h"
#include "solvers/equilibrium/options.h"
#include "solvers/equilibrium/soundness.h"
#include "solvers/support/block.h"
#include "solvers/support/laws.h"
#include "solvers/support/orders.h"
#include "solvers/support/random.h"

namespace palpate::test::test_robustness {
namespace {

class Robustness : public testing::TestWithParam<Law> {
 protected:
  /// Solves to t and returns a state that is sound.
  static Equilibrium solve(const Scene& scene, Index node, const Vec3& t,
                           const EquilibriumOptions& options = {}) {
    const InteractionList tool = bond_nodes({node});
    EquilibriumSolver solver(scene, options);
    solver.set_interaction(tool);
    const Equilibrium state = solver.solve(t, solver.rest());
    expect_sound(state, solver, tool);
    return state;
  }
};
INSTANTIATE_TEST_SUITE_P(Each, Robustness, testing::ValuesIn(kLaws), name_of_law);

TEST_P(Robustness, CellsAMillionTimesStiffer) {
  for (ElementOrder order : kOrders) {
    Block block = make_block(GetParam(), {order});
    Scene& scene = block.scene;
    scene.organ.materials.push_back(make_material(GetParam(), 3e9, 0.3));
    for (Index c = 0; c < scene.body.mesh.num_cells(); ++c) {
      scene.body.material_of_cell.push_back(c % 5 == 0 ? 1 : 0);
    }
    for (Index node : {block.corner, block.middle}) {
      const Equilibrium state = solve(scene, node, Vec3(0.002, -0.001, 0.003));
      EXPECT_EQ(state.outcome, Outcome::converged) << state.summary.message;
      EXPECT_GT(state.reaction.norm(), 0);
    }
  }
}

TEST_P(Robustness, NearlyIncompressible) {
  for (ElementOrder order : kOrders) {
    const Block block = make_block(GetParam(), {order, {3, 2, 2}, 0.1, 3000, 0.499});
    for (const Vec3& t : {Vec3(-0.006, 0.004, 0), Vec3(0.01, 0.005, -0.01)}) {
      const Equilibrium state = solve(block.scene, block.corner, t);
      EXPECT_EQ(state.outcome, Outcome::converged) << state.summary.message;
    }
  }
}

TEST_P(Robustness, ATinyDisplacementIsLinear) {
  const Block block = make_block(GetParam());
  const Equilibrium rest = solve(block.scene, block.corner, Vec3::Zero());
  Random random(81);
  for (double size : {1e-6, 1e-9, 1e-12, 1e-100}) {
    const Vec3 t = random.vector(3, size);
    const Equilibrium state = solve(block.scene, block.corner, t);
    ASSERT_EQ(state.outcome, Outcome::converged) << state.summary.message;
    const Vec3 linear = rest.stiffness * t;
    // What the law adds to the linear force is |t| over the size of a cell, some times.
    const double nonlinear = 1000 * size / 0.03;
    EXPECT_LT((state.reaction - linear).norm(), (nonlinear + 1e-10) * linear.norm()) << size;
    EXPECT_NEAR(state.energy, linear.dot(t) / 2, (nonlinear + 1e-10) * linear.norm() * t.norm());
  }
}

TEST_P(Robustness, ATinyStepFromAnEquilibriumFollowsItsStiffness) {
  const Block block = make_block(GetParam());
  EquilibriumSolver solver(block.scene, with_tolerance(1e-13));
  solver.set_interaction(bond_nodes({block.corner}));
  const Equilibrium state = solver.solve(Vec3(-0.008, 0.005, 0.004), solver.rest());
  const Vec3 step(1e-9, -2e-9, 1e-9);
  const Equilibrium next = solver.solve(state.t + step, state);
  ASSERT_EQ(next.outcome, Outcome::converged);
  EXPECT_LT((next.reaction - state.reaction - state.stiffness * step).norm(),
            1e-4 * (state.stiffness * step).norm());
}

TEST_P(Robustness, HugeDisplacementsEndWithAnOutcome) {
  EquilibriumOptions options;
  options.max_steps = 40;
  for (ElementOrder order : kOrders) {
    const Block block = make_block(GetParam(), {order});
    for (double size : {0.1, 1.0, 100.0, 1e6}) {
      for (const Vec3& direction : {Vec3(-1, 0.3, 0.2), Vec3(0.2, 1, -0.5)}) {
        const Equilibrium state = solve(block.scene, block.corner, size * direction, options);
        if (GetParam() == Law::linear) {
          EXPECT_EQ(state.outcome, Outcome::converged);
        }
      }
    }
  }
}

// It softens under compression and knows no barrier: it converges happily, and is told.
TEST(StVenantKirchhoff, AHardPushInvertsItAndIsFlagged) {
  for (ElementOrder order : kOrders) {
    const Block block = make_block(Law::st_venant_kirchhoff, {order});
    EquilibriumSolver solver(block.scene, {});
    solver.set_interaction(bond_nodes({block.middle}));
    const Equilibrium state = solver.solve(Vec3(-0.05, 0, 0), solver.rest());
    EXPECT_EQ(state.outcome, Outcome::converged);
    EXPECT_NE(state.flags & flags::inverted, 0);
    EXPECT_LE(state.minimum_det_f, 0);
    EXPECT_GE(state.num_inverted_cells, 1);
    EXPECT_NE(state.summary.message.find("inverted"), std::string::npos) << state.summary.message;
    EXPECT_NE(state.summary.message.find("cell " + std::to_string(state.minimum_det_f_cell)),
              std::string::npos)
        << state.summary.message;
    expect_sound(state, solver, bond_nodes({block.middle}));
  }
}

TEST_P(Robustness, AWalkOfRandomStepsStaysSound) {
  const Block block = make_block(GetParam());
  const InteractionList tool = bond_nodes({block.corner});
  EquilibriumSolver solver(block.scene, {});
  solver.set_interaction(tool);
  Random random(82);
  Equilibrium state = solver.rest();
  int failures = 0;
  for (int i = 0; i < 40; ++i) {
    const Equilibrium next = solver.solve(random.vector(3, 0.02), state);
    expect_sound(next, solver, tool);
    if (next.outcome == Outcome::converged) {
      state = next;
    } else {
      ++failures;
    }
  }
  EXPECT_EQ(failures, 0);
}

// One tetrahedron, of which one corner is free: three unknowns, and all of them held.
TEST_P(Robustness, OneFreePoint) {
  TetMesh mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.cells = {0, 1, 2, 3};
  const Scene scene = make_scene(mesh, make_material(GetParam(), 1000, 0.3), {1, 1, 1, 0});
  EXPECT_EQ(solve(scene, 3, Vec3(0.1, 0.05, -0.2)).outcome, Outcome::converged);
}

}  // namespace
}  // namespace palpate::test::test_robustness
