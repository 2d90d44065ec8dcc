// SPDX-License-Identifier: BSD-3-Clause
// One suite for every solver that was built in.
#include "linear/linear_solver.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "base/error.h"
#include "solvers/support/block.h"
#include "solvers/support/box_mesh.h"
#include "solvers/support/laws.h"
#include "solvers/support/random.h"
#include "solvers/support/tangent.h"

namespace palpate::test {
namespace {

/// Backward stable solves of well conditioned systems: ε times the condition number, below 1e4.
constexpr double kRounding = 1e-11;

struct System {
  SymmetricPattern pattern;
  std::vector<double> values;

  [[nodiscard]] Eigen::MatrixXd matrix() const { return dense(pattern, values); }
  /// The matrix of which the diagonal is larger by `shift`.
  [[nodiscard]] std::vector<double> shifted(double shift) const {
    std::vector<double> result = values;
    for (Index c = 0; c < pattern.size; ++c) result[pattern.column_start[c]] += shift;
    return result;
  }
  /// D A D.
  [[nodiscard]] std::vector<double> scaled(const Eigen::VectorXd& d) const {
    std::vector<double> result = values;
    for (Index c = 0; c < pattern.size; ++c) {
      for (Index i = pattern.column_start[c]; i < pattern.column_start[c + 1]; ++i) {
        result[i] *= d[c] * d[pattern.row[i]];
      }
    }
    return result;
  }
};

/// The tangent at rest of a small body, in units in which it is of order one.
System body(const Scene& scene) {
  const Assembly assembly(scene);
  NodalVector force;
  System system{assembly.pattern(), {}};
  assembly.tangent(NodalVector::Zero(3 * assembly.num_points()), force, system.values);
  double largest = 0;
  for (double value : system.values) largest = std::max(largest, std::abs(value));
  for (double& value : system.values) value /= largest;
  return system;
}

System block() {
  return body(make_block(Law::neo_hookean, {ElementOrder::linear, {3, 3, 2}}).scene);
}

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
    std::fill(scene.fixed.begin(), scene.fixed.end(), 0);
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
}  // namespace palpate::test
