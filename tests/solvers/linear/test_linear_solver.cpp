// SPDX-License-Identifier: BSD-3-Clause
// One suite for every solver that was built in.
#include "linear/linear_solver.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "base/error.h"
#include "solvers/linear/systems.h"
#include "solvers/support/random.h"

namespace palpate::test::test_linear_solver {
namespace {

/// Backward stable solves of well conditioned systems: ε times the condition number, below 1e4.
constexpr double kRounding = 1e-11;

class Solver : public testing::TestWithParam<std::string> {
 protected:
  std::unique_ptr<LinearSolver> make() const { return make_linear_solver(GetParam()); }
  Random random_{51};
};

INSTANTIATE_TEST_SUITE_P(Each, Solver, testing::ValuesIn(linear_solver_names()),
                         [](const auto& each) { return letters(each.param); });

TEST_P(Solver, HasItsName) { EXPECT_EQ(make()->name(), GetParam()); }

TEST_P(Solver, Solves) {
  const System system = block();
  const auto solver = make();
  solver->analyse(system.pattern);
  ASSERT_EQ(solver->factorise(system.values), FactorStatus::ok);
  const Eigen::VectorXd x = random_.vector(system.pattern.size, 1);
  Eigen::VectorXd column = system.matrix() * x;
  solver->solve(column);
  EXPECT_LT((column - x).norm(), kRounding * x.norm());
  EXPECT_EQ(solver->negative_pivots(), 0);
}

TEST_P(Solver, SolvesForSeveralColumnsAtOnce) {
  const System system = block();
  const auto solver = make();
  solver->analyse(system.pattern);
  ASSERT_EQ(solver->factorise(system.values), FactorStatus::ok);
  const Eigen::Index n = system.pattern.size;
  const Eigen::MatrixXd x = random_.vector(n * 7, 1).reshaped(n, 7);
  // A block of a larger matrix: its columns do not follow one another in memory.
  Eigen::MatrixXd frame = Eigen::MatrixXd::Constant(n + 5, 9, 3.0);
  frame.block(2, 1, n, 7) = system.matrix() * x;
  solver->solve(frame.block(2, 1, n, 7));
  EXPECT_LT((frame.block(2, 1, n, 7) - x).norm(), kRounding * x.norm());
  frame.block(2, 1, n, 7).setConstant(3.0);
  EXPECT_EQ(frame, Eigen::MatrixXd::Constant(n + 5, 9, 3.0)) << "wrote beside its columns";
}

TEST_P(Solver, OneAnalysisServesManyValues) {
  const System system = block();
  const auto solver = make();
  solver->analyse(system.pattern);
  const Eigen::VectorXd b = random_.vector(system.pattern.size, 1);
  for (double shift : {0.0, 1.0, 0.25, 0.0}) {
    const System other{system.pattern, system.shifted(shift)};
    ASSERT_EQ(solver->factorise(other.values), FactorStatus::ok);
    Eigen::VectorXd x = b;
    solver->solve(x);
    EXPECT_LT((other.matrix() * x - b).norm(), kRounding * b.norm()) << "shift " << shift;
  }
}

TEST_P(Solver, AFactorIsAsGoodAfterAnyOther) {
  const System system = block();
  const Eigen::VectorXd b = random_.vector(system.pattern.size, 1);
  const auto solve = [&](LinearSolver& solver) {
    Eigen::VectorXd x = b;
    if (solver.factorise(system.values) == FactorStatus::ok) solver.solve(x);
    return x;
  };
  const auto solver = make();
  solver->analyse(system.pattern);
  const Eigen::VectorXd first = solve(*solver);
  ASSERT_NE(first, b) << "no factor";
  ASSERT_EQ(solver->factorise(system.shifted(-0.3)), FactorStatus::ok);
  EXPECT_EQ(solve(*solver), first) << "not bit for bit";
  solver->analyse(system.pattern);
  EXPECT_EQ(solve(*solver), first) << "not bit for bit after another analysis";
  const auto another = make();
  another->analyse(system.pattern);
  EXPECT_EQ(solve(*another), first) << "not bit for bit in another solver";
}

TEST_P(Solver, ThePrecisionFollowsFromTheMatrixAlone) {
  const System system = block();
  const double lowest =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(system.matrix()).eigenvalues()[0];
  const std::vector<double> nearly_singular = system.shifted(-(1 - 1e-6) * lowest);
  const Eigen::VectorXd b = random_.vector(system.pattern.size, 1);
  const auto solve = [&](LinearSolver& solver) {
    EXPECT_EQ(solver.factorise(system.values, Precision::single_if_safe), FactorStatus::ok);
    Eigen::VectorXd x = b;
    solver.solve(x);
    return x;
  };
  const auto fresh = make();
  fresh->analyse(system.pattern);
  const Eigen::VectorXd expected = solve(*fresh);
  const auto used = make();
  used->analyse(system.pattern);
  ASSERT_EQ(used->factorise(nearly_singular, Precision::single_if_safe), FactorStatus::ok);
  EXPECT_FALSE(used->is_single());
  EXPECT_EQ(solve(*used), expected);
  EXPECT_EQ(used->is_single(), fresh->is_single());
}

TEST_P(Solver, AnotherPatternMayBeAnalysed) {
  const System system = block();
  const auto solver = make();
  solver->analyse(system.pattern);
  ASSERT_EQ(solver->factorise(system.values), FactorStatus::ok);
  const System small = body(make_block(Law::linear, {ElementOrder::linear, {1, 1, 1}}).scene);
  solver->analyse(small.pattern);
  ASSERT_EQ(solver->factorise(small.values), FactorStatus::ok);
  const Eigen::VectorXd x = random_.vector(small.pattern.size, 1);
  Eigen::VectorXd column = small.matrix() * x;
  solver->solve(column);
  EXPECT_LT((column - x).norm(), kRounding * x.norm());
}

TEST_P(Solver, CountsNegativeEigenvalues) {
  const System system = block();
  const auto solver = make();
  solver->analyse(system.pattern);
  const Eigen::VectorXd eigenvalues =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(system.matrix(), Eigen::EigenvaluesOnly)
          .eigenvalues();
  const Eigen::VectorXd b = random_.vector(system.pattern.size, 1);
  for (Index expected : {0, 1, 2, 5, 20, system.pattern.size}) {
    // A shift in the middle between two eigenvalues.
    const double below = expected > 0 ? eigenvalues[expected - 1] : 0;
    const double above = expected < system.pattern.size ? eigenvalues[expected] : 2 * below;
    const System indefinite{system.pattern, system.shifted(-(below + above) / 2)};
    ASSERT_EQ(solver->factorise(indefinite.values), FactorStatus::ok);
    EXPECT_EQ(solver->negative_pivots(), expected);
    Eigen::VectorXd x = b;
    solver->solve(x);
    EXPECT_EQ(solver->negative_pivots(), expected) << "after a solve";
    // Without pivoting the growth of an indefinite factor costs some digits.
    EXPECT_LT((indefinite.matrix() * x - b).norm(), 1e-8 * b.norm()) << expected;
  }
}

TEST_P(Solver, AMatrixOfZerosIsSingular) {
  const System system = block();
  const auto solver = make();
  solver->analyse(system.pattern);
  EXPECT_EQ(solver->factorise(std::vector<double>(system.values.size(), 0.0)),
            FactorStatus::singular);
}

// A zero pivot that is exact, whatever the order of elimination.
TEST_P(Solver, AnEmptyRowIsSingular) {
  const System system = block();
  const auto solver = make();
  solver->analyse(system.pattern);
  Eigen::VectorXd d = Eigen::VectorXd::Ones(system.pattern.size);
  d[17] = 0;
  EXPECT_EQ(solver->factorise(system.scaled(d)), FactorStatus::singular);
}

// Six rigid motions: the pivots that should be zero are rounding.
TEST_P(Solver, ABodyThatFloatsIsSingular) {
  for (ElementOrder order : {ElementOrder::linear, ElementOrder::quadratic}) {
    Scene scene = make_block(Law::linear, {order}).scene;
    std::fill(scene.body.fixed.begin(), scene.body.fixed.end(), 0);
    const System system = body(scene);
    const auto solver = make();
    solver->analyse(system.pattern);
    EXPECT_EQ(solver->factorise(system.values), FactorStatus::singular)
        << nodes_per_cell(order) << " nodes";
  }
}

TEST_P(Solver, GoesOnAfterASingularMatrix) {
  const System system = block();
  const auto solver = make();
  solver->analyse(system.pattern);
  EXPECT_EQ(solver->factorise(std::vector<double>(system.values.size(), 0.0)),
            FactorStatus::singular);
  ASSERT_EQ(solver->factorise(system.values), FactorStatus::ok);
  const Eigen::VectorXd x = random_.vector(system.pattern.size, 1);
  Eigen::VectorXd column = system.matrix() * x;
  solver->solve(column);
  EXPECT_LT((column - x).norm(), kRounding * x.norm());
  EXPECT_EQ(solver->negative_pivots(), 0);
}

TEST_P(Solver, ValuesThatAreNoNumbersAreNotAFactor) {
  const System system = block();
  const auto solver = make();
  solver->analyse(system.pattern);
  std::vector<double> values = system.values;
  values[values.size() / 2] = std::numeric_limits<double>::quiet_NaN();
  // Either the factorisation says so or the solution is no number; it must not look good.
  if (solver->factorise(values) == FactorStatus::ok) {
    Eigen::VectorXd x = Eigen::VectorXd::Ones(system.pattern.size);
    solver->solve(x);
    EXPECT_FALSE(x.allFinite());
  }
}

TEST_P(Solver, TheUnitOfTheValuesHasNoPart) {
  const System system = block();
  const auto solver = make();
  solver->analyse(system.pattern);
  const Eigen::VectorXd x = random_.vector(system.pattern.size, 1);
  const Eigen::VectorXd b = system.matrix() * x;
  for (double unit : {1e-30, 1e-12, 1e12, 1e30}) {
    std::vector<double> values = system.values;
    for (double& value : values) value *= unit;
    ASSERT_EQ(solver->factorise(values), FactorStatus::ok) << unit;
    Eigen::VectorXd column = unit * b;
    solver->solve(column);
    EXPECT_LT((column - x).norm(), kRounding * x.norm()) << unit;
  }
}

// Units that are powers of two change nothing but the exponents.
TEST_P(Solver, PowersOfTwoScaleExactly) {
  const System system = block();
  const auto solver = make();
  solver->analyse(system.pattern);
  const Eigen::VectorXd b = random_.vector(system.pattern.size, 1);
  ASSERT_EQ(solver->factorise(system.shifted(-0.2)), FactorStatus::ok);
  Eigen::VectorXd x = b;
  solver->solve(x);
  for (int exponent : {1, 2, -3, 40, -301}) {
    std::vector<double> values = system.shifted(-0.2);
    for (double& value : values) value = std::ldexp(value, exponent);
    ASSERT_EQ(solver->factorise(values), FactorStatus::ok) << exponent;
    Eigen::VectorXd column = b;
    solver->solve(column);
    for (double& value : column) value = std::ldexp(value, exponent);
    EXPECT_EQ(column, x) << exponent;
  }
}

// Moduli and sizes of cells that differ: the diagonal spans some decades, the matrix is as regular
// as the one it is scaled from.
TEST_P(Solver, BadlyScaledRowsAreNoSingularMatrix) {
  const System system = block();
  const auto solver = make();
  solver->analyse(system.pattern);
  const Eigen::VectorXd x = random_.vector(system.pattern.size, 1);
  for (double decades : {2.0, 4.0, 8.0}) {
    Eigen::VectorXd d(system.pattern.size);
    for (double& value : d) value = std::pow(10.0, random_.uniform(-decades, decades));
    ASSERT_EQ(solver->factorise(system.scaled(d)), FactorStatus::ok) << decades << " decades";
    // D A D y = D A x has the solution y = D⁻¹ x.
    Eigen::VectorXd column = d.asDiagonal() * (system.matrix() * x);
    solver->solve(column);
    const Eigen::VectorXd found = d.asDiagonal() * column;
    EXPECT_LT((found - x).norm(), 100 * kRounding * x.norm()) << decades << " decades";
  }
}

TEST_P(Solver, ThreeUnknowns) {
  const SymmetricPattern pattern{3, {0, 3, 5, 6}, {0, 1, 2, 1, 2, 2}};
  const auto solver = make();
  solver->analyse(pattern);
  ASSERT_EQ(solver->factorise({4, 1, 0, 3, 1, -2}), FactorStatus::ok);
  EXPECT_EQ(solver->negative_pivots(), 1);
  Eigen::VectorXd column = dense(pattern, {4, 1, 0, 3, 1, -2}) * Vec3(1, 2, 3);
  solver->solve(column);
  EXPECT_LT((column - Vec3(1, 2, 3)).norm(), 1e-14);
}

TEST_P(Solver, AnotherHasTheSameFactor) {
  const System system = block();
  const auto solver = make();
  solver->analyse(system.pattern);
  const auto another = solver->another();
  const auto third = another->another();
  EXPECT_EQ(another->name(), solver->name());
  const Eigen::VectorXd b = random_.vector(system.pattern.size, 1);
  const std::vector<double> values = system.shifted(-0.3);
  std::vector<Eigen::VectorXd> x;
  for (LinearSolver* each : {solver.get(), another.get(), third.get()}) {
    ASSERT_EQ(each->factorise(values), FactorStatus::ok);
    x.push_back(b);
    each->solve(x.back());
    EXPECT_EQ(x.back(), x.front()) << "not bit for bit";
    EXPECT_EQ(each->negative_pivots(), solver->negative_pivots());
    EXPECT_EQ(each->factor_bytes(), solver->factor_bytes());
  }
}

TEST_P(Solver, AnotherOutlivesTheFirst) {
  const System system = block();
  auto solver = make();
  solver->analyse(system.pattern);
  const auto another = solver->another();
  ASSERT_EQ(solver->factorise(system.values), FactorStatus::ok);
  solver.reset();
  ASSERT_EQ(another->factorise(system.values), FactorStatus::ok);
  const Eigen::VectorXd x = random_.vector(system.pattern.size, 1);
  Eigen::VectorXd column = system.matrix() * x;
  another->solve(column);
  EXPECT_LT((column - x).norm(), kRounding * x.norm());
}

TEST_P(Solver, AnotherOfNoPatternIsFresh) {
  const auto solver = make()->another();
  const System system = block();
  solver->analyse(system.pattern);
  EXPECT_EQ(solver->factorise(system.values), FactorStatus::ok);
}

TEST_P(Solver, KnowsTheSizeOfItsFactor) {
  const System system = block();
  const auto solver = make();
  solver->analyse(system.pattern);
  ASSERT_EQ(solver->factorise(system.values), FactorStatus::ok);
  // At least the matrix, at most a dense triangle, and the diagonal on its own; MUMPS counts the
  // square of a front.
  const std::int64_t size = system.pattern.size;
  EXPECT_GE(solver->factor_bytes(), 8 * system.pattern.num_values());
  EXPECT_LE(solver->factor_bytes(), 8 * (size * size + size));
}

TEST_P(Solver, NoUnknownsAtAll) {
  const auto solver = make();
  solver->analyse({0, {0}, {}});
  const auto another = solver->another();
  for (LinearSolver* each : {solver.get(), another.get()}) {
    EXPECT_EQ(each->factorise({}), FactorStatus::ok);
    EXPECT_EQ(each->negative_pivots(), 0);
    EXPECT_EQ(each->factor_bytes(), 0);
    Eigen::MatrixXd none(0, 3);
    each->solve(none);
  }
}

TEST_P(Solver, MayLiveBesideOthers) {
  const System system = block();
  const auto a = make();
  const auto b = make();
  a->analyse(system.pattern);
  b->analyse(system.pattern);
  ASSERT_EQ(a->factorise(system.values), FactorStatus::ok);
  ASSERT_EQ(b->factorise(system.shifted(1)), FactorStatus::ok);
  const Eigen::VectorXd x = random_.vector(system.pattern.size, 1);
  Eigen::VectorXd column = system.matrix() * x;
  a->solve(column);
  EXPECT_LT((column - x).norm(), kRounding * x.norm());
}

TEST(LinearSolver, TheFirstNameIsTheDefault) {
  EXPECT_EQ(make_linear_solver()->name(), linear_solver_names().front());
}

TEST(LinearSolver, AnUnknownNameIsRefused) {
  EXPECT_THROW((void)make_linear_solver("PARDISO"), InputError);
}

}  // namespace
}  // namespace palpate::test::test_linear_solver
