// SPDX-License-Identifier: BSD-3-Clause
// Whether what is touched is equal to the bit; the times are not compared.
#pragma once

#include <gtest/gtest.h>

#include <cstring>

#include "state_space/touch_space.h"

namespace palpate::test {

inline bool same_bits(const double* a, const double* b, std::size_t count) {
  return std::memcmp(a, b, count * sizeof(double)) == 0;
}

inline void expect_equal(const TouchToolSpace& x, const TouchToolSpace& y) {
  EXPECT_EQ(x.modes, y.modes);
  EXPECT_EQ(x.coefficients, y.coefficients);
  EXPECT_EQ(x.coefficient_gradients, y.coefficient_gradients);
  ASSERT_EQ(x.configurations.size(), y.configurations.size());
  for (std::size_t i = 0; i < x.configurations.size(); ++i) {
    const ConfigurationSummary& c = x.configurations[i];
    const ConfigurationSummary& d = y.configurations[i];
    EXPECT_EQ(c.check_point, d.check_point);
    EXPECT_EQ(c.parent, d.parent);
    EXPECT_EQ(c.outcome, d.outcome);
    EXPECT_EQ(c.flags, d.flags);
    EXPECT_EQ(c.iterations, d.iterations);
    EXPECT_TRUE(same_bits(c.force.data(), d.force.data(), 3));
    EXPECT_TRUE(same_bits(c.stiffness.data(), d.stiffness.data(), 9));
    EXPECT_TRUE(same_bits(&c.energy, &d.energy, 1));
    EXPECT_EQ(c.mesh_error.is_known(), d.mesh_error.is_known());
    if (c.mesh_error.is_known()) {
      EXPECT_TRUE(same_bits(&c.mesh_error.energy, &d.mesh_error.energy, 1));
      EXPECT_TRUE(same_bits(c.mesh_error.force.data(), d.mesh_error.force.data(), 3));
      EXPECT_EQ(c.mesh_error.is_reliable, d.mesh_error.is_reliable);
    }
    EXPECT_EQ(c.of_turns, d.of_turns);
    EXPECT_EQ(c.has_third_derivative(), d.has_third_derivative());
    if (c.has_third_derivative()) {
      EXPECT_TRUE(same_bits(c.third_derivative.data(), d.third_derivative.data(), 10));
    }
  }
  ASSERT_EQ(x.intermediate_states.size(), y.intermediate_states.size());
  for (std::size_t i = 0; i < x.intermediate_states.size(); ++i) {
    const IntermediateState& c = x.intermediate_states[i];
    const IntermediateState& d = y.intermediate_states[i];
    EXPECT_EQ(c.target, d.target);
    EXPECT_EQ(c.number, d.number);
    EXPECT_EQ(c.outcome, d.outcome);
    EXPECT_EQ(c.flags, d.flags);
    EXPECT_TRUE(same_bits(c.t.data(), d.t.data(), 3));
    EXPECT_TRUE(same_bits(c.force.data(), d.force.data(), 3));
    EXPECT_TRUE(same_bits(&c.energy, &d.energy, 1));
  }
}

inline void expect_equal(const TouchSpace& a, const TouchSpace& b) {
  EXPECT_EQ(a.scene_hash, b.scene_hash);
  ASSERT_EQ(a.tool_spaces.size(), b.tool_spaces.size());
  for (std::size_t s = 0; s < a.tool_spaces.size(); ++s) {
    expect_equal(a.tool_spaces[s], b.tool_spaces[s]);
  }
}

}  // namespace palpate::test
