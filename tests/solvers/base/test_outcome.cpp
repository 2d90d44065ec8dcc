// SPDX-License-Identifier: BSD-3-Clause
#include "base/outcome.h"

#include <gtest/gtest.h>

#include <set>

namespace palpate::test::test_outcome {
namespace {

// They are stored in files and shown in data arrays.
TEST(Outcome, NumbersAreKept) {
  EXPECT_EQ(static_cast<int>(Outcome::converged), 0);
  EXPECT_EQ(static_cast<int>(Outcome::not_converged), 1);
  EXPECT_EQ(static_cast<int>(Outcome::tangent_not_factorised), 2);
  EXPECT_EQ(static_cast<int>(Outcome::budget_used_up), 3);
  EXPECT_EQ(static_cast<int>(Outcome::aborted), 4);
  EXPECT_EQ(static_cast<int>(Outcome::invalid_scene), 5);
  EXPECT_EQ(static_cast<int>(Outcome::tangent_not_solved), 6);
  EXPECT_EQ(static_cast<int>(Outcome::tool_inside), 7);
  EXPECT_EQ(flags::inverted, 1);
  EXPECT_EQ(flags::unstable, 2);
  EXPECT_EQ(flags::beyond_force_limit, 4);
  EXPECT_EQ(flags::near_fold, 8);
  EXPECT_EQ(flags::inertia_not_computed, 16);
  EXPECT_EQ(flags::inaccurate, 32);
  EXPECT_EQ(flags::touches_nothing, 64);
  EXPECT_EQ(flags::all, 127);
}

TEST(Outcome, HasANameOfItsOwn) {
  std::set<std::string> names;
  for (int i = 0; i <= 7; ++i) names.insert(to_string(static_cast<Outcome>(i)));
  EXPECT_EQ(names.size(), 8U);
  EXPECT_EQ(names.count("unknown"), 0U);
  EXPECT_EQ(to_string(static_cast<Outcome>(77)), "unknown");
}

TEST(Flags, AreListed) {
  EXPECT_EQ(flags_to_string(0), "");
  EXPECT_EQ(flags_to_string(flags::inverted), "inverted");
  EXPECT_EQ(flags_to_string(flags::inverted | flags::unstable), "inverted, unstable");
  EXPECT_EQ(flags_to_string(flags::all),
            "inverted, unstable, beyond the force limit, near a fold, inertia not computed, "
            "inaccurate, touches nothing");
}

}  // namespace
}  // namespace palpate::test::test_outcome
