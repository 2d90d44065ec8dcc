// SPDX-License-Identifier: BSD-3-Clause
// A step of a reduced body allocates nothing.
#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "reduced/reduced_body.h"
#include "solvers/reduced/whole_model.h"
#include "solvers/support/allocations.h"
#include "solvers/support/block.h"

namespace palpate::test::test_realtime {
namespace {

TEST(Realtime, AStepAllocatesNothing) {
  const test::Block block = test::make_block(Law::fung, {ElementOrder::linear, {3, 2, 2}});
  InteractionList tools;
  tools.add(BondedPatch({block.corner}));
  tools.add(BondedPatch({block.middle}));
  Rheology rheology;
  rheology.density = 1000;
  rheology.viscous_time = 0.01;
  rheology.prony_moduli = {0.3};
  rheology.prony_times = {0.1};
  const test::WholeModel whole =
      test::make_whole_model(block.scene, {rheology}, tools, 0.01, Vec3(0, 0, -2));
  ReducedBody body(whole.model, {});
  static_assert(noexcept(body.step(std::declval<const double*>())));
  static_assert(noexcept(body.rest()));
  const long before = test::num_allocations();
  ASSERT_EQ(before > 0, test::kCountsAllocations);
  int num_converged = 0;
  int num_failed = 0;
  for (int i = 1; i <= 300; ++i) {
    // From step 200 on it is torn beyond all bounds.
    const double size = i < 200 ? 0.01 * std::sin(0.05 * i) : 1e4 * (i % 2);
    const double d[6] = {size, 0.3 * size, 0, -size, 0, 0.5 * size};
    const ReducedOutcome outcome = body.step(d).outcome;
    ++(outcome == ReducedOutcome::converged ? num_converged : num_failed);
  }
  body.rest();
  // Held by springs, and let go.
  static_assert(noexcept(body.hold(0, 0.0)));
  for (int i = 1; i <= 100; ++i) {
    if (i == 1) body.hold(0, 50);
    if (i == 30) body.hold(1, 0);
    if (i == 60) body.hold(0, 0);
    const double size = 0.01 * std::sin(0.05 * i);
    const double d[6] = {size, 0.3 * size, 0, -size, 0, 0.5 * size};
    EXPECT_EQ(body.step(d).outcome, ReducedOutcome::converged) << i;
  }
  EXPECT_EQ(test::num_allocations(), before);
  // Both ways through a step were gone.
  EXPECT_GE(num_converged, 199);
  EXPECT_GE(num_failed, 40);
  if (!test::kCountsAllocations) GTEST_SKIP() << "allocations cannot be counted here";
}

}  // namespace
}  // namespace palpate::test::test_realtime
