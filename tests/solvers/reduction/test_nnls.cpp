// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "reduction/nnls.h"
#include "solvers/support/random.h"

namespace palpate::test::test_nnls {
namespace {

Eigen::MatrixXd random_matrix(test::Random& random, Eigen::Index rows, Eigen::Index columns) {
  Eigen::MatrixXd a(rows, columns);
  for (double& x : a.reshaped()) x = random.uniform(-1, 1);
  return a;
}

/// The conditions of a minimum: x ≥ 0, the gradient is ≤ 0 where x = 0 and 0 where it is above.
TEST(Nnls, FindsTheMinimumWhereNoExactSolutionExists) {
  test::Random random(1);
  for (int i = 0; i < 20; ++i) {
    const Eigen::MatrixXd a = random_matrix(random, 30, 12);
    const Eigen::VectorXd b = random.vector(30, 1.0);
    const NnlsResult result = solve_nnls(a, b, {1e-12, 0});
    EXPECT_FALSE(result.converged);
    EXPECT_GE(result.x.minCoeff(), 0);
    EXPECT_GT((result.x.array() == 0).count(), 0);
    const Eigen::VectorXd gradient = a.transpose() * (b - a * result.x);
    for (Eigen::Index c = 0; c < gradient.size(); ++c) {
      if (result.x[c] > 0) {
        EXPECT_NEAR(gradient[c], 0, 1e-12);
      } else {
        EXPECT_LT(gradient[c], 1e-12);
      }
    }
    EXPECT_NEAR(result.residual, (b - a * result.x).norm() / b.norm(), 1e-12);
  }
}

TEST(Nnls, FindsASparseSolutionOfManyColumns) {
  test::Random random(2);
  const Eigen::MatrixXd a = random_matrix(random, 40, 400);
  const Eigen::VectorXd b = a * Eigen::VectorXd::Ones(400);
  const NnlsResult result = solve_nnls(a, b, {1e-3, 0});
  EXPECT_TRUE(result.converged);
  EXPECT_LE((a * result.x - b).norm(), 1e-3 * b.norm());
  EXPECT_LE((result.x.array() > 0).count(), 40);
  EXPECT_GE(result.x.minCoeff(), 0);
}

TEST(Nnls, PutsUpWithColumnsThatAreTheSameOrNothing) {
  test::Random random(3);
  Eigen::MatrixXd a = random_matrix(random, 10, 8);
  a.col(3) = a.col(2);
  a.col(5).setZero();
  const Eigen::VectorXd b = a * Eigen::VectorXd::Ones(8);
  const NnlsResult result = solve_nnls(a, b, {1e-12, 0});
  EXPECT_TRUE(result.converged);
  EXPECT_EQ(result.x[5], 0);
  EXPECT_NEAR(result.x[2] + result.x[3], 2, 1e-10);
}

TEST(Nnls, StopsAtTheMostColumnsAndSaysSo) {
  test::Random random(4);
  const Eigen::MatrixXd a = random_matrix(random, 40, 100);
  const Eigen::VectorXd b = a * Eigen::VectorXd::Ones(100);
  const NnlsResult result = solve_nnls(a, b, {1e-10, 7});
  EXPECT_FALSE(result.converged);
  EXPECT_LE((result.x.array() > 0).count(), 7);
  EXPECT_LT(result.residual, 1);
}

TEST(Nnls, OfNothingIsNothing) {
  const NnlsResult result = solve_nnls(Eigen::MatrixXd::Ones(3, 4), Eigen::VectorXd::Zero(3), {});
  EXPECT_TRUE(result.converged);
  EXPECT_EQ(result.x, Eigen::VectorXd::Zero(4));
}

}  // namespace
}  // namespace palpate::test::test_nnls
