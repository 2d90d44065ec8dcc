// SPDX-License-Identifier: BSD-3-Clause
#include "threads/usable_cores.h"

#include <gtest/gtest.h>

namespace palpate::test::test_usable_cores {
namespace {

using Cores = std::vector<char>;

TEST(UsableCores, AtLeastOneIsThere) { EXPECT_GE(num_usable_cores(), 1); }

TEST(UsableCores, AProcessAloneHasAllOfItsCores) {
  EXPECT_EQ(share_of_cores({Cores(8, 1)}, 0), 8);
  EXPECT_EQ(share_of_cores({Cores{0, 1, 0, 1}}, 0), 2);
}

TEST(UsableCores, ProcessesThatMayRunAnywhereShareTheMachine) {
  const std::vector<Cores> four(4, Cores(16, 1));
  for (std::size_t i = 0; i < four.size(); ++i) EXPECT_EQ(share_of_cores(four, i), 4);
  EXPECT_EQ(share_of_cores(std::vector<Cores>(3, Cores(16, 1)), 0), 5);
  EXPECT_EQ(share_of_cores(std::vector<Cores>(32, Cores(16, 1)), 0), 1);
}

TEST(UsableCores, ProcessesThatAreBoundKeepTheirs) {
  EXPECT_EQ(share_of_cores({Cores{1, 1, 1, 1, 0, 0, 0, 0}, Cores{0, 0, 0, 0, 1, 1, 1, 1}}, 1), 4);
  EXPECT_EQ(share_of_cores({Cores{1, 0}, Cores{0, 1}}, 0), 1);
  // Of another length: the last core that may be used ends the list.
  EXPECT_EQ(share_of_cores({Cores{1, 1}, Cores{0, 0, 1, 1, 1}}, 1), 3);
}

}  // namespace
}  // namespace palpate::test::test_usable_cores
