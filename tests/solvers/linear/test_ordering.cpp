// SPDX-License-Identifier: BSD-3-Clause
#include "linear/ordering.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "solvers/linear/systems.h"

namespace palpate::test::test_ordering {
namespace {

void expect_permutation(std::vector<Index> order, Index size) {
  ASSERT_EQ(order.size(), static_cast<std::size_t>(size));
  std::sort(order.begin(), order.end());
  for (Index i = 0; i < size; ++i) EXPECT_EQ(order[i], i);
}

TEST(Ordering, HasEachPlaceOnce) {
  const System system = block();
  expect_permutation(nested_dissection(system.pattern), system.pattern.size);
}

TEST(Ordering, KeepsTheComponentsOfAPointTogether) {
  const System system = block();
  const std::vector<Index> order = nested_dissection(system.pattern);
  for (Index c = 0; c < system.pattern.size; c += 3) {
    EXPECT_EQ(order[c + 1], order[c] + 1);
    EXPECT_EQ(order[c + 2], order[c] + 2);
  }
}

TEST(Ordering, IsTheSameEveryTime) {
  const System system = block();
  EXPECT_EQ(nested_dissection(system.pattern), nested_dissection(system.pattern));
}

// Patterns of which other orderings are known to end the process.
TEST(Ordering, TakesAnyPattern) {
  for (Index size : {1, 2, 3, 9}) {
    expect_permutation(nested_dissection(sparse(Eigen::MatrixXd::Ones(size, size)).pattern), size);
    expect_permutation(nested_dissection(sparse(Eigen::MatrixXd::Identity(size, size)).pattern),
                       size);
  }
  // Two parts that do not touch, a dense row, an unknown on its own.
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(30, 30);
  matrix.topLeftCorner(10, 10).setOnes();
  matrix.block(10, 10, 12, 12).setOnes();
  matrix.col(25).segment(10, 18).setOnes();
  matrix.row(25) = matrix.col(25).transpose();
  expect_permutation(nested_dissection(sparse(matrix).pattern), 30);
}

TEST(Ordering, OfNothing) { EXPECT_TRUE(nested_dissection({0, {0}, {}}).empty()); }

}  // namespace
}  // namespace palpate::test::test_ordering
