// SPDX-License-Identifier: BSD-3-Clause
// Step halving, budgets and aborting: what is left is the last equilibrium on the way.
#include <gtest/gtest.h>

#include <functional>

#include "equilibrium/equilibrium.h"
#include "interaction/bonded_patch.h"
#include "solvers/equilibrium/soundness.h"
#include "solvers/support/block.h"
#include "solvers/support/laws.h"

namespace palpate::test::test_budget {
namespace {

/// Half of the block's length: more than one step can do.
const Vec3 kHardPush(-0.05, 0, 0);

class Budget : public testing::Test {
 protected:
  Equilibrium push(const EquilibriumOptions& options, const Vec3& t = kHardPush) {
    EquilibriumSolver solver(block_.scene, options);
    solver.set_interaction(tool_);
    const Equilibrium rest = solver.rest();
    const Equilibrium state = solver.solve(t, rest);
    expect_sound(state, solver, tool_);
    if (state.outcome != Outcome::converged) {
      // On the straight way from rest to t.
      EXPECT_LT(state.t.norm(), t.norm());
      EXPECT_LT((state.t - state.t.dot(t) / t.squaredNorm() * t).norm(), 1e-12);
    }
    return state;
  }

  Block block_ = make_block(Law::neo_hookean);
  InteractionList tool_ = bond_nodes({block_.corner});
};

TEST_F(Budget, StepsAreHalvedWhereOneIsTooLong) {
  EquilibriumOptions options;
  const Equilibrium state = push(options);
  EXPECT_EQ(state.outcome, Outcome::converged) << state.summary.message;
  EXPECT_EQ(state.t, kHardPush);
  EXPECT_GT(state.summary.steps, 1);
  options.max_halvings = 0;
  options.follow_folds = false;
  const Equilibrium in_one = push(options);
  EXPECT_EQ(in_one.outcome, Outcome::not_converged);
  EXPECT_EQ(in_one.summary.steps, 1);
  EXPECT_EQ(in_one.t, Vec3::Zero());
  EXPECT_EQ(in_one.u.norm(), 0);
}

TEST_F(Budget, Iterations) {
  EquilibriumOptions options;
  options.max_iterations = 1;
  options.follow_folds = false;
  const Equilibrium state = push(options);
  EXPECT_EQ(state.outcome, Outcome::not_converged);
  EXPECT_NE(state.summary.message.find("not converged"), std::string::npos)
      << state.summary.message;
}

TEST_F(Budget, Steps) {
  EquilibriumOptions options;
  options.max_steps = 2;
  const Equilibrium state = push(options);
  EXPECT_EQ(state.outcome, Outcome::budget_used_up);
  EXPECT_EQ(state.summary.steps, 2);
  EXPECT_NE(state.summary.message.find("budget used up"), std::string::npos)
      << state.summary.message;
}

TEST_F(Budget, Seconds) {
  EquilibriumOptions options;
  options.max_seconds = 1e-9;
  const Equilibrium state = push(options);
  EXPECT_EQ(state.outcome, Outcome::budget_used_up);
  EXPECT_LE(state.summary.iterations, 1);
  options.max_seconds = 1000;
  EXPECT_EQ(push(options).outcome, Outcome::converged);
}

TEST_F(Budget, AbortEndsASolveAtOnce) {
  int calls = 0;
  EquilibriumOptions options;
  options.abort_requested = [&] { return ++calls > 0; };
  const Equilibrium state = push(options);
  EXPECT_EQ(state.outcome, Outcome::aborted);
  EXPECT_EQ(calls, 1);
  EXPECT_EQ(state.summary.iterations, 0);
  EXPECT_EQ(state.u.norm(), 0);
}

TEST_F(Budget, AbortIsAskedBeforeEachIteration) {
  int calls = 0;
  EquilibriumOptions options;
  options.abort_requested = [&] { return ++calls, false; };
  const int iterations = push(options).summary.iterations;
  EXPECT_GE(calls, iterations);
  for (int after : {1, iterations / 2, iterations - 1}) {
    calls = 0;
    options.abort_requested = [&] { return ++calls > after; };
    EXPECT_EQ(push(options).outcome, Outcome::aborted);
    EXPECT_EQ(calls, after + 1);
  }
}

TEST_F(Budget, WhatIsLeftIsAStartForTheNext) {
  EquilibriumOptions options;
  options.max_steps = 2;
  EquilibriumSolver hasty(block_.scene, options);
  hasty.set_interaction(tool_);
  Equilibrium part = hasty.solve(kHardPush, hasty.rest());
  ASSERT_EQ(part.outcome, Outcome::budget_used_up);
  ASSERT_GT(part.t.norm(), 0);
  part.outcome = Outcome::converged;  // as far as it went
  EquilibriumSolver patient(block_.scene, {});
  patient.set_interaction(tool_);
  const Equilibrium state = patient.solve(kHardPush, part);
  EXPECT_EQ(state.outcome, Outcome::converged) << state.summary.message;
  EXPECT_EQ(state.t, kHardPush);
}

TEST_F(Budget, AnInvertedStartThatWasReadAgainIsToldWithItsWorstCell) {
  EquilibriumOptions options;
  options.max_seconds = 1e-9;
  EquilibriumSolver solver(block_.scene, options);
  solver.set_interaction(tool_);
  Equilibrium start = solver.rest();
  // As a file gives it: the flag is kept, and neither the cell nor the number of cells is.
  start.flags = flags::inverted;
  start.minimum_det_f_cell = -1;
  start.num_inverted_cells = 0;
  const Equilibrium state = solver.solve(kHardPush, start);
  EXPECT_EQ(state.outcome, Outcome::budget_used_up);
  EXPECT_GE(state.minimum_det_f_cell, 0);
  EXPECT_NE(state.summary.message.find("the worst is cell "), std::string::npos)
      << state.summary.message;
}

TEST_F(Budget, AStartThatDidNotConvergeIsGivenBackWithItsReason) {
  EquilibriumOptions options;
  options.max_iterations = 1;
  options.follow_folds = false;
  EquilibriumSolver solver(block_.scene, options);
  solver.set_interaction(tool_);
  const Equilibrium failed = solver.solve(kHardPush, solver.rest());
  ASSERT_EQ(failed.outcome, Outcome::not_converged);
  const Equilibrium next = solver.solve(0.01 * kHardPush, failed);
  EXPECT_EQ(next.outcome, Outcome::not_converged);
  EXPECT_EQ(next.t, failed.t);
  EXPECT_FALSE(next.summary.message.empty());
}

}  // namespace
}  // namespace palpate::test::test_budget
