// SPDX-License-Identifier: BSD-3-Clause
// What holds for the result of every solve, however it ended.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "equilibrium/equilibrium.h"

namespace palpate::test {

/// Numbers that are numbers; an outcome that is named and, unless all went well, explained; and
/// figures that are those of the equilibrium at `t`, also where that is not the one asked for.
inline void expect_sound(const Equilibrium& state, const EquilibriumSolver& solver,
                         const Constraint& constraint) {
  EXPECT_TRUE(state.t.allFinite());
  EXPECT_TRUE(state.u.allFinite());
  EXPECT_TRUE(state.v.allFinite());
  EXPECT_TRUE(state.reaction.allFinite());
  EXPECT_TRUE(state.stiffness.allFinite());
  EXPECT_TRUE(std::isfinite(state.energy));
  EXPECT_TRUE(std::isfinite(state.residual));
  EXPECT_TRUE(std::isfinite(state.minimum_det_f));
  EXPECT_NE(to_string(state.outcome), "unknown");
  if (state.outcome != Outcome::converged || state.flags != 0) {
    EXPECT_FALSE(state.message.empty());
  }
  EXPECT_EQ((state.flags & flags::inverted) != 0, state.minimum_det_f <= 0);
  EXPECT_EQ((state.flags & flags::unstable) != 0, state.negative_pivots > 0);
  if (state.outcome == Outcome::tangent_not_factorised) return;

  const Assembly& assembly = solver.assembly();
  NodalVector force;
  const double energy = assembly.residual(state.u, force).energy;
  EXPECT_NEAR(state.energy, energy, 1e-12 * std::abs(energy));
  Eigen::VectorXd reaction = Eigen::VectorXd::Zero(state.t.size());
  for (std::size_t i = 0; i < constraint.points.size(); ++i) {
    const Index point = constraint.points[i];
    const Index site = constraint.site_of_point[i];
    EXPECT_EQ(Vec3(state.u.segment<3>(3 * point)), Vec3(state.t.segment<3>(3 * site)));
    reaction.segment<3>(3 * site) += force.segment<3>(3 * point);
    force.segment<3>(3 * point).setZero();
  }
  double largest = 0;  // of the forces that must vanish
  for (Index p = 0; p < assembly.num_points(); ++p) {
    if (assembly.unknown_of_point()[p] >= 0) {
      largest = std::max(largest, force.segment<3>(3 * p).lpNorm<Eigen::Infinity>());
    }
  }
  EXPECT_LT((state.reaction - reaction).norm(), 1e-12 * reaction.norm() + 1e-300);
  // The tolerance is a share of stiffness × displacement, for which the largest entry of k stands;
  // the mean diagonal of the tangent exceeds it by less than a thousand times.
  EXPECT_LE(largest, 1e-7 * state.stiffness.lpNorm<Eigen::Infinity>() *
                         std::max(state.t.lpNorm<Eigen::Infinity>(), assembly.mean_edge()));
}

}  // namespace palpate::test
