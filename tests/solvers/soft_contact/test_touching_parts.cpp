// SPDX-License-Identifier: BSD-3-Clause
// Equilibria of parts that touch each other.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "equilibrium/equilibrium.h"
#include "interaction/bonded_patch.h"
#include "interaction/interaction_list.h"
#include "soft_contact/soft_contact.h"
#include "solvers/support/bodies.h"
#include "solvers/support/two_blocks.h"

namespace palpate::test::test_touching_parts {
namespace {

TEST(TouchingParts, OnePressesTheOther) {
  TwoBlocksOptions options;
  options.lower_cells = {6, 6, 2};
  options.upper_cells = {4, 4, 2};
  Scene scene = make_two_blocks(options);
  const double top = options.lower_size.z() + options.upper_size.z();
  const std::vector<Index> held = points_where(
      scene.body.mesh, [&](const Vec3& p) { return p.z() > top - 1e-9; });
  for (const Index p : held) scene.body.fixed[p] = 0;
  EquilibriumOptions solve;
  EquilibriumSolver solver(scene, solve);
  solver.set_interaction(bond_as_one(held));
  Equilibrium state = solver.rest();
  std::printf("rest %s %s\n", to_string(state.outcome).c_str(), state.summary.message.c_str());
  const SoftContact contact(scene);
  long factorisations = solver.work().factorisations;
  for (int i = 1; i <= 6; ++i) {
    state = solver.solve(Vec3(0, 0, -0.0005 * i), state);
    double least = 1;
    NodalVector u = state.u;
    for (const auto& at : contact.points_in_reach(u)) least = std::min(least, at.gap);
    std::printf("%d %s steps %d it %d factors %ld h %.5f %.5f %.5f k %.2f gap %.6f %.3f s %s\n", i,
                to_string(state.outcome).c_str(), state.summary.steps, state.summary.iterations,
                static_cast<long>(solver.work().factorisations - factorisations),
                state.reaction[0], state.reaction[1], state.reaction[2], state.stiffness(2, 2),
                least, state.summary.seconds, state.summary.message.c_str());
    factorisations = solver.work().factorisations;
  }
  EXPECT_EQ(state.outcome, Outcome::converged);
}

}  // namespace
}  // namespace palpate::test::test_touching_parts
