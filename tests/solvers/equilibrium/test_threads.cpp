// SPDX-License-Identifier: BSD-3-Clause
// A body of several parts, solved for without a factor: the same to the bit for any number of
// threads.
#include <gtest/gtest.h>

#include "base/error.h"
#include "equilibrium/equilibrium.h"
#include "equilibrium/tangent_solver.h"
#include "interaction/bonded_patch.h"
#include "solvers/support/block.h"
#include "threads/thread_team.h"

namespace palpate::test::test_threads {
namespace {

struct Solved {
  Equilibrium equilibrium;
  long iterations = 0;
};

Solved solve(const Scene& scene, Index point, int threads) {
  EquilibriumOptions options;
  options.threads = threads;
  EquilibriumSolver solver(scene, options, nullptr);
  solver.set_interaction(BondedPatch({point}));
  Solved solved;
  solved.equilibrium = solver.solve(Vec3(-0.002, 0.001, -0.002), solver.rest());
  solved.iterations = solver.work().krylov_iterations;
  return solved;
}

TEST(Threads, OfAnEquilibriumWithoutAFactor) {
  BlockOptions options;
  options.cells = {10, 10, 10};
  const Block block = make_block(Law::neo_hookean, options);
  ASSERT_GT(count_unknowns(block.scene), kUnknownsWithoutFactor);
  const Solved alone = solve(block.scene, block.corner, 1);
  ASSERT_EQ(alone.equilibrium.outcome, Outcome::converged);
  for (const int threads : {2, 3}) {
    const Solved together = solve(block.scene, block.corner, threads);
    const Equilibrium& a = alone.equilibrium;
    const Equilibrium& b = together.equilibrium;
    EXPECT_EQ(together.iterations, alone.iterations);
    EXPECT_EQ(b.outcome, a.outcome);
    EXPECT_EQ(b.u, a.u);
    EXPECT_EQ(b.v, a.v);
    EXPECT_EQ(b.reaction, a.reaction);
    EXPECT_EQ(b.stiffness, a.stiffness);
    EXPECT_EQ(b.energy, a.energy);
    EXPECT_EQ(b.lowest_eigenvalue, a.lowest_eigenvalue);
    EXPECT_EQ(b.negative_pivots, a.negative_pivots);
  }
}

TEST(Threads, AreAtMostAsManyAsCanBeAskedFor) {
  EquilibriumOptions options;
  for (const int threads : {0, 1, kMostThreads}) {
    options.threads = threads;
    EXPECT_NO_THROW(validate(options));
  }
  for (const int threads : {-1, kMostThreads + 1}) {
    options.threads = threads;
    EXPECT_THROW(validate(options), InputError);
  }
}

}  // namespace
}  // namespace palpate::test::test_threads
