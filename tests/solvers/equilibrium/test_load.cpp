// SPDX-License-Identifier: BSD-3-Clause
// A body that rests under a load, such as its weight.
#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "equilibrium/equilibrium.h"
#include "interaction/bonded_patch.h"
#include "solvers/support/block.h"
#include "solvers/support/solvable.h"

namespace palpate::test::test_load {
namespace {

const Vec3 kGravity(0, 0, -9.81);
constexpr double kDensity = 500;
/// Of the forces, N: solves end at 1e-10 of what the tool would take to be moved.
constexpr double kNoForce = 1e-7;

Scene heavy(Scene scene, const Vec3& gravity) {
  scene.organ.body_force = gravity;
  scene.organ.densities.assign(scene.organ.materials.size(), kDensity);
  return scene;
}

class Load : public testing::TestWithParam<Law> {};

TEST_P(Load, RestsUnderItAndToolsCountFromThere) {
  const test::Block block = test::make_block(GetParam());
  if (!test::is_solvable(block.scene)) GTEST_SKIP() << "no linear solver that pivots was built in";
  for (const bool has_factor : {true, false}) {
    if (is_incompressible(GetParam()) && !has_factor) continue;
    EquilibriumSolver solver(heavy(block.scene, kGravity), {},
                             has_factor ? make_linear_solver() : nullptr);
    const Equilibrium& alone = solver.settled();
    ASSERT_EQ(alone.outcome, Outcome::converged) << alone.summary.message;
    const Eigen::Index corner = 3 * Eigen::Index{block.corner};
    EXPECT_LT(alone.u[corner + 2], -0.005);

    solver.set_interaction(BondedPatch({block.corner}));
    const Equilibrium rest = solver.rest();
    ASSERT_EQ(rest.outcome, Outcome::converged) << rest.summary.message;
    EXPECT_EQ(rest.u, alone.u);
    EXPECT_EQ(rest.energy, 0);
    // Half of the work of the weight is stored, where the body is linear.
    EXPECT_LT(alone.energy, 0);
    EXPECT_LT(rest.reaction.norm(), kNoForce);

    const Vec3 t(0.004, -0.003, 0.005);
    const Equilibrium pulled = solver.solve(t, rest);
    ASSERT_EQ(pulled.outcome, Outcome::converged) << pulled.summary.message;
    EXPECT_LT((pulled.u.segment<3>(corner) - rest.u.segment<3>(corner) - t).norm(), 1e-15);
    // h is the derivative of the energy, with the part of the load.
    constexpr double step = 1e-5;
    const Equilibrium up = solver.solve(t + step * Vec3::UnitZ(), pulled);
    const Equilibrium down = solver.solve(t - step * Vec3::UnitZ(), pulled);
    EXPECT_NEAR((up.energy - down.energy) / (2 * step), pulled.reaction.z(),
                1e-5 * pulled.reaction.norm());
    // So is v that of u, where the tool holds the body too.
    const NodalVector slope = (up.u - down.u) / (2 * step);
    EXPECT_LT((slope - pulled.v.col(2)).lpNorm<Eigen::Infinity>(), 1e-4);
    EXPECT_EQ(pulled.v.middleRows<3>(corner), Mat3::Identity());
    // And back.
    EXPECT_LT(solver.solve(Vec3::Zero(), pulled).reaction.norm(), kNoForce);
  }
}

INSTANTIATE_TEST_SUITE_P(Laws, Load,
                         testing::Values(Law::linear, Law::neo_hookean,
                                         Law::neo_hookean_incompressible),
                         [](const auto& of) {
                           return std::string(is_incompressible(of.param) ? "Incompressible"
                                              : of.param == Law::linear   ? "Linear"
                                                                          : "NeoHookean");
                         });

TEST(Load, ThatIsTooLargeEndsByNameAndABadOneIsRefused) {
  const test::Block block = test::make_block(Law::st_venant_kirchhoff);
  EquilibriumSolver solver(heavy(block.scene, Vec3(-1e5, 0, 0)), {});
  const Equilibrium& end = solver.settled();
  EXPECT_EQ(end.outcome, Outcome::not_converged);
  EXPECT_NE(end.summary.message.find("finds no rest"), std::string::npos) << end.summary.message;
  EXPECT_NE(end.summary.message.find("BodyForce"), std::string::npos) << end.summary.message;
  EXPECT_THROW(require_rest(solver), InputError);
  solver.set_interaction(BondedPatch({block.corner}));
  EXPECT_EQ(solver.rest().outcome, Outcome::not_converged);
  EXPECT_TRUE(end.u.allFinite());
  // This law is defined where cells are inside out, so that it has gone on to there.
  EXPECT_LT(end.minimum_det_f, 0);
  EXPECT_EQ(end.flags & flags::inverted, flags::inverted);

  EXPECT_THROW(EquilibriumSolver(heavy(block.scene, Vec3(0, std::nan(""), 0)), {}), InputError);
  Scene weightless = heavy(block.scene, kGravity);
  weightless.organ.densities.front() = 0;
  EXPECT_THROW(EquilibriumSolver(weightless, {}), InputError);
  weightless.organ.densities.clear();
  EXPECT_THROW(EquilibriumSolver(weightless, {}), InputError);
}

}  // namespace
}  // namespace palpate::test::test_load
