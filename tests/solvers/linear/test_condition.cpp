// SPDX-License-Identifier: BSD-3-Clause
#include "linear/condition.h"

#include <gtest/gtest.h>

#include "solvers/linear/systems.h"
#include "solvers/support/random.h"

namespace palpate::test::test_condition {
namespace {

double dense_condition(const Eigen::MatrixXd& matrix) {
  const auto norm = [](const Eigen::MatrixXd& m) {
    return m.cwiseAbs().colwise().sum().maxCoeff();
  };
  return norm(matrix) * norm(matrix.fullPivLu().inverse());
}

SolveColumns solve_with(LinearSolver& solver) {
  return [&solver](auto columns) { solver.solve(columns); };
}

void check(const System& system) {
  const auto solver = make_linear_solver();
  solver->analyse(system.pattern);
  ASSERT_EQ(solver->factorise(system.values), FactorStatus::ok);
  const double exact = dense_condition(system.matrix());
  const double estimate = condition_estimate(system.pattern, system.values, solve_with(*solver));
  // From below, but for what the inverse loses to rounding; a third at the least, as promised.
  EXPECT_LT(estimate, exact * (1 + 1e-6));
  EXPECT_GT(estimate, exact / 3);
}

TEST(Condition, OfABody) { check(block()); }

TEST(Condition, OfAnIndefiniteMatrix) {
  const System system = block();
  check({system.pattern, system.shifted(-0.2)});
}

TEST(Condition, OfRowsThatDiffer) {
  const System system = block();
  Random random(53);
  for (double decades : {1.0, 3.0}) {
    Eigen::VectorXd d(system.pattern.size);
    for (double& value : d) value = std::pow(10.0, random.uniform(-decades, decades));
    check({system.pattern, system.scaled(d)});
  }
}

TEST(Condition, OfRandomMatrices) {
  Random random(54);
  for (int size : {1, 2, 3, 10, 40}) {
    Eigen::MatrixXd matrix = random.vector(size * size, 1).reshaped(size, size);
    matrix = (matrix * matrix.transpose()).eval();
    matrix.diagonal().array() += 1e-3;
    check(sparse(matrix));
  }
}

TEST(Condition, OfTheIdentity) {
  const System system = sparse(Eigen::MatrixXd::Identity(7, 7));
  const auto solver = make_linear_solver();
  solver->analyse(system.pattern);
  ASSERT_EQ(solver->factorise(system.values), FactorStatus::ok);
  EXPECT_NEAR(condition_estimate(system.pattern, system.values, solve_with(*solver)), 1, 1e-14);
}

TEST(Condition, OfNothing) {
  const auto solver = make_linear_solver();
  EXPECT_EQ(condition_estimate({0, {0}, {}}, {}, solve_with(*solver)), 1);
}

}  // namespace
}  // namespace palpate::test::test_condition
