// SPDX-License-Identifier: BSD-3-Clause
#include "equilibrium/equilibrium.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <tuple>

#include "base/error.h"
#include "interaction/bonded_patch.h"
#include "solvers/equilibrium/options.h"
#include "solvers/equilibrium/soundness.h"
#include "solvers/equilibrium/state.h"
#include "solvers/support/block.h"
#include "solvers/support/bodies.h"
#include "solvers/support/laws.h"
#include "solvers/support/orders.h"

namespace palpate::test::test_equilibrium {
namespace {

const Vec3 kPush(-0.010, 0.006, -0.005);
const Vec3 kPull(0.015, -0.004, 0.012);

template <class F>
std::string error_of(F&& f) {
  try {
    (void)f();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

class Laws : public testing::TestWithParam<Law> {};
INSTANTIATE_TEST_SUITE_P(Each, Laws, testing::ValuesIn(kLaws), name_of_law);

TEST_P(Laws, AtRestThereIsStiffnessAndNoForce) {
  const Block block = make_block(GetParam());
  EquilibriumSolver solver(block.scene, {});
  solver.set_interaction(bond_nodes({block.corner}));
  const Equilibrium rest = solver.rest();
  EXPECT_EQ(rest.outcome, Outcome::converged);
  EXPECT_EQ(rest.flags, 0);
  EXPECT_EQ(rest.t, Vec3::Zero());
  EXPECT_EQ(rest.u.norm(), 0);
  EXPECT_EQ(rest.reaction.norm(), 0);
  EXPECT_EQ(rest.energy, 0);
  EXPECT_EQ(rest.minimum_det_f, 1);
  EXPECT_EQ(rest.negative_pivots, 0);
  EXPECT_EQ(rest.stiffness, rest.stiffness.transpose());
  EXPECT_EQ(rest.stiffness.llt().info(), Eigen::Success) << "not positive definite";
  expect_sound(rest, solver, bond_nodes({block.corner}));
}

TEST_P(Laws, StayingAtRestCostsNothing) {
  const Block block = make_block(GetParam());
  EquilibriumSolver solver(block.scene, {});
  solver.set_interaction(bond_nodes({block.corner}));
  const Equilibrium state = solver.solve(Vec3::Zero(), solver.rest());
  EXPECT_EQ(state.outcome, Outcome::converged);
  EXPECT_EQ(state.summary.iterations, 0);
  EXPECT_EQ(state.u.norm(), 0);
  EXPECT_EQ(state.reaction.norm(), 0);
}

TEST_P(Laws, APushEndsInEquilibrium) {
  for (ElementOrder order : kOrders) {
    const Block block = make_block(GetParam(), {order});
    const InteractionList tool = bond_nodes({block.corner});
    EquilibriumSolver solver(block.scene, {});
    solver.set_interaction(tool);
    for (const Vec3& t : {kPush, kPull}) {
      const Equilibrium state = solver.solve(t, solver.rest());
      EXPECT_EQ(state.outcome, Outcome::converged);
      EXPECT_EQ(state.flags, 0);
      EXPECT_EQ(state.summary.message, "");
      EXPECT_EQ(state.t, t);
      EXPECT_LE(state.summary.residual, EquilibriumOptions{}.tolerance);
      EXPECT_GT(state.energy, 0);
      EXPECT_GT(state.reaction.dot(t), 0) << "the force that holds pulls where it is pulled";
      EXPECT_EQ(state.stiffness, state.stiffness.transpose());
      expect_sound(state, solver, tool);
    }
  }
}

TEST_P(Laws, TheWayThereDoesNotMatter) {
  const Block block = make_block(GetParam());
  EquilibriumSolver solver(block.scene, with_tolerance(1e-13));
  solver.set_interaction(bond_nodes({block.corner}));
  const Equilibrium rest = solver.rest();
  const Equilibrium straight = solver.solve(kPush, rest);
  Equilibrium around = solver.solve(kPull, rest);
  around = solver.solve(Vec3(0, 0.01, 0), around);
  around = solver.solve(kPush, around);
  ASSERT_EQ(around.outcome, Outcome::converged);
  // Below the fold there is one equilibrium; the tolerance is a share of the forces.
  EXPECT_LT((around.u - straight.u).norm(), 1e-9 * straight.u.norm());
  EXPECT_LT((around.reaction - straight.reaction).norm(), 1e-9 * straight.reaction.norm());
  EXPECT_NEAR(around.energy, straight.energy, 1e-10 * straight.energy);
}

class LawsAndSolvers : public testing::TestWithParam<std::tuple<Law, std::string>> {};
INSTANTIATE_TEST_SUITE_P(Each, LawsAndSolvers,
                         testing::Combine(testing::ValuesIn(kLaws),
                                          testing::ValuesIn(linear_solver_names())),
                         [](const auto& each) {
                           return letters(to_string(std::get<0>(each.param))) +
                                  letters(std::get<1>(each.param));
                         });

// Bit for bit: another number of ranks, which solves in another order, gives the same space.
TEST_P(LawsAndSolvers, WhatWasSolvedBeforeDoesNotMatter) {
  const Block block = make_block(std::get<0>(GetParam()));
  const auto make = [&] {
    EquilibriumSolver solver(block.scene, {}, make_linear_solver(std::get<1>(GetParam())));
    solver.set_interaction(bond_nodes({block.corner}));
    return solver;
  };
  EquilibriumSolver solver = make();
  const Equilibrium rest = solver.rest();
  const Equilibrium pushed = solver.solve(kPush, rest);
  const Equilibrium further = solver.solve(1.2 * kPush, pushed);

  (void)solver.solve(kPull, pushed);
  expect_same_bits(solver.solve(kPush, rest), pushed);
  expect_same_bits(solver.solve(1.2 * kPush, pushed), further);

  (void)solver.solve(-8 * kPull, rest);  // so far that it may fail
  expect_same_bits(solver.solve(kPush, rest), pushed);

  solver.set_interaction(bond_nodes({block.middle}));
  (void)solver.solve(kPull, solver.rest());
  solver.set_interaction(bond_nodes({block.corner}));
  expect_same_bits(solver.rest(), rest);
  expect_same_bits(solver.solve(kPush, rest), pushed);

  EquilibriumSolver fresh = make();
  expect_same_bits(fresh.solve(1.2 * kPush, pushed), further);
  // However many factors are kept, and however many solves.
  EXPECT_EQ(solver.work().analyses, 1);
}

TEST_P(Laws, TheLinearSolverDoesNotMatter) {
  const auto names = linear_solver_names();
  if (names.size() < 2) GTEST_SKIP() << "one solver was built in";
  for (ElementOrder order : kOrders) {
    const Block block = make_block(GetParam(), {order});
    std::vector<Equilibrium> states;
    for (const std::string& name : names) {
      EquilibriumSolver solver(block.scene, with_tolerance(1e-12), make_linear_solver(name));
      solver.set_interaction(bond_nodes({block.corner}));
      states.push_back(solver.solve(kPush, solver.rest()));
    }
    ASSERT_EQ(states[0].outcome, Outcome::converged);
    ASSERT_EQ(states[1].outcome, Outcome::converged);
    // Rounding times a condition number of some 1e4, or the tolerance.
    EXPECT_LT((states[0].u - states[1].u).norm(), 1e-9 * states[0].u.norm());
    EXPECT_LT((states[0].v - states[1].v).norm(), 1e-9 * states[0].v.norm());
    EXPECT_LT((states[0].reaction - states[1].reaction).norm(), 1e-9 * states[0].reaction.norm());
    EXPECT_LT((states[0].stiffness - states[1].stiffness).norm(),
              1e-9 * states[0].stiffness.norm());
    EXPECT_EQ(states[0].negative_pivots, states[1].negative_pivots);
  }
}

// A body of another size or modulus is the same body in other units. Powers of two scale every
// number exactly, so that nothing but an absolute tolerance could make a difference.
TEST_P(Laws, UnitsDoNotMatter) {
  const Block block = make_block(GetParam());
  EquilibriumSolver solver(block.scene, {});
  solver.set_interaction(bond_nodes({block.corner}));
  const Equilibrium expected = solver.solve(kPush, solver.rest());
  for (int size : {-10, 0, 10, 20}) {
    for (int modulus : {-20, 0, 40}) {
      Scene scene = block.scene;
      for (Vec3& p : scene.body.mesh.points) p *= std::ldexp(1.0, size);
      scene.organ.materials[0] = scaled(scene.organ.materials[0], std::ldexp(1.0, modulus));
      EquilibriumSolver other(scene, {});
      other.set_interaction(bond_nodes({block.corner}));
      const Equilibrium state = other.solve(std::ldexp(1.0, size) * kPush, other.rest());
      ASSERT_EQ(state.outcome, Outcome::converged) << "2^" << size << " m, 2^" << modulus << " Pa";
      EXPECT_EQ(state.summary.iterations, expected.summary.iterations);
      EXPECT_EQ(std::ldexp(1.0, -size) * state.u, expected.u);
      EXPECT_EQ(std::ldexp(1.0, -2 * size - modulus) * state.reaction, expected.reaction);
    }
  }
}

TEST(SetInteraction, RefusesBadTools) {
  Block block = make_block(Law::neo_hookean);
  block.scene.body.mesh.points.push_back(Vec3(1, 1, 1));  // in no cell
  block.scene.body.fixed.push_back(0);
  block.scene.body.touchable.push_back(0);
  const Index unused = block.scene.body.mesh.num_points() - 1;
  const Index fixed = static_cast<Index>(
      std::find(block.scene.body.fixed.begin(), block.scene.body.fixed.end(), 1) -
      block.scene.body.fixed.begin());
  EquilibriumSolver solver(block.scene, {});
  EXPECT_NE(error_of([&] { return solver.rest(); }), "") << "there is no tool yet";
  const auto error = [&](const std::vector<Index>& nodes) {
    return error_of([&] { return solver.set_interaction(bond_nodes(nodes)), 0; });
  };
  EXPECT_NE(error({}).find("No active node"), std::string::npos);
  EXPECT_NE(error({-1}).find("Active node -1 does not exist"), std::string::npos);
  EXPECT_NE(error({unused + 1}).find("does not exist"), std::string::npos);
  EXPECT_NE(error({unused}).find("belongs to no cell"), std::string::npos);
  EXPECT_NE(error({fixed}).find("is fixed"), std::string::npos);
  EXPECT_NE(error({block.corner, block.middle, block.corner}).find("named twice"),
            std::string::npos);
  EXPECT_EQ(error({block.corner, block.middle}), "");
}

TEST(SetInteraction, OfABadToolLeavesTheLastOne) {
  const Block block = make_block(Law::neo_hookean);
  EquilibriumSolver solver(block.scene, {});
  solver.set_interaction(bond_nodes({block.corner}));
  const Equilibrium before = solver.solve(kPush, solver.rest());
  EXPECT_THROW(solver.set_interaction(bond_nodes({-1})), InputError);
  EXPECT_THROW(solver.set_interaction(bond_nodes({block.middle, block.middle})), InputError);
  expect_same_bits(solver.solve(kPush, solver.rest()), before);
}

TEST(Solve, BadDisplacementsAreRefused) {
  const Block block = make_block(Law::neo_hookean);
  EquilibriumSolver solver(block.scene, {});
  solver.set_interaction(bond_nodes({block.corner}));
  const Equilibrium rest = solver.rest();
  EXPECT_THROW((void)solver.solve(Eigen::VectorXd::Zero(6), rest), InputError);
  EXPECT_THROW((void)solver.solve(Eigen::VectorXd::Zero(0), rest), InputError);
  for (double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW((void)solver.solve(Vec3(0, bad, 0), rest), InputError);
  }
}

TEST(EquilibriumSolver, AnInvalidSceneIsRefused) {
  Block block = make_block(Law::linear);
  std::fill(block.scene.body.fixed.begin(), block.scene.body.fixed.end(), 0);
  EXPECT_THROW(EquilibriumSolver(block.scene, {}), InputError);
}

TEST(EquilibriumOptions, AreChecked) {
  const auto error = [](auto change) {
    EquilibriumOptions options;
    change(options);
    return error_of([&] { return validate(options), 0; });
  };
  EXPECT_EQ(error([](auto&) {}), "");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (double bad : {0.0, -1.0, 1.0, nan}) {
    EXPECT_EQ(error([&](auto& o) { o.tolerance = bad; }).rfind("tolerance", 0), 0U) << bad;
  }
  for (double bad : {-0.1, 1.0, nan}) {
    EXPECT_EQ(error([&](auto& o) { o.contraction = bad; }).rfind("contraction", 0), 0U);
  }
  EXPECT_EQ(error([](auto& o) { o.contraction = 0; }), "");
  EXPECT_EQ(error([](auto& o) { o.max_iterations = 0; }).rfind("max_iterations", 0), 0U);
  EXPECT_EQ(error([](auto& o) { o.max_halvings = -1; }).rfind("max_halvings", 0), 0U);
  EXPECT_EQ(error([](auto& o) { o.max_halvings = 0; }), "");
  EXPECT_EQ(error([](auto& o) { o.max_steps = 0; }).rfind("max_steps", 0), 0U);
  for (double bad : {-1.0, nan}) {
    EXPECT_EQ(error([&](auto& o) { o.max_seconds = bad; }).rfind("max_seconds", 0), 0U);
  }
  EquilibriumOptions bad;
  bad.max_steps = 0;
  EXPECT_THROW(EquilibriumSolver(make_block(Law::linear).scene, bad), InputError);
}

TEST(Work, AddsUpAndGivesTheFloor) {
  Work work;
  EXPECT_EQ(work.floor_seconds(), 0);
  work.assemblies = 2;
  work.assembly_seconds = 1;
  work.factorisations = 4;
  work.factorisation_seconds = 8;
  work.right_hand_sides = 6;
  work.solve_seconds = 0.6;
  work.residuals = work.analyses = 1;
  work.residual_seconds = work.analysis_seconds = 100;
  EXPECT_NEAR(work.floor_seconds(), 0.5 + 2 + 0.3, 1e-15);
  Work twice = work;
  twice += work;
  EXPECT_EQ(twice.assemblies, 4);
  EXPECT_EQ(twice.residuals, 2);
  EXPECT_EQ(twice.analyses, 2);
  EXPECT_EQ(twice.factorisations, 8);
  EXPECT_EQ(twice.right_hand_sides, 12);
  EXPECT_EQ(twice.residual_seconds, 200);
  EXPECT_EQ(twice.analysis_seconds, 200);
  EXPECT_NEAR(twice.floor_seconds(), work.floor_seconds(), 1e-15);
}

}  // namespace
}  // namespace palpate::test::test_equilibrium
