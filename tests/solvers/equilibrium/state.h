// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include "equilibrium/equilibrium.h"

namespace palpate::test {

/// The state that Assembly takes: the displacement, and behind it the pressures as lengths.
inline NodalVector state_of(const Assembly& assembly, const Equilibrium& equilibrium) {
  NodalVector state(assembly.state_size());
  state.head(equilibrium.u.size()) = equilibrium.u;
  for (Index i = 0; i < assembly.num_pressures(); ++i) {
    state[equilibrium.u.size() + i] = equilibrium.p[i] / assembly.pressure_scale()[i];
  }
  return state;
}

/// Two solves have found the same, bit for bit; the times they took may differ.
inline void expect_same_bits(const Equilibrium& a, const Equilibrium& b) {
  EXPECT_EQ(a.t, b.t);
  EXPECT_EQ(a.u, b.u);
  EXPECT_EQ(a.v, b.v);
  EXPECT_EQ(a.p, b.p);
  EXPECT_EQ(a.p_v, b.p_v);
  EXPECT_EQ(a.energy, b.energy);
  EXPECT_EQ(a.reaction, b.reaction);
  EXPECT_EQ(a.stiffness, b.stiffness);
  EXPECT_EQ(a.third_derivative, b.third_derivative);
  EXPECT_EQ(a.outcome, b.outcome);
  EXPECT_EQ(a.flags, b.flags);
  EXPECT_EQ(a.summary.residual, b.summary.residual);
  EXPECT_EQ(a.displacement_error, b.displacement_error);
  EXPECT_EQ(a.minimum_det_f, b.minimum_det_f);
  EXPECT_EQ(a.minimum_det_f_cell, b.minimum_det_f_cell);
  EXPECT_EQ(a.num_inverted_cells, b.num_inverted_cells);
  EXPECT_EQ(a.negative_pivots, b.negative_pivots);
  EXPECT_EQ(a.summary.iterations, b.summary.iterations);
  EXPECT_EQ(a.summary.steps, b.summary.steps);
  EXPECT_EQ(a.summary.message, b.summary.message);
}

}  // namespace palpate::test
