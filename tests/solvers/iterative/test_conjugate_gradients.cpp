// SPDX-License-Identifier: BSD-3-Clause
// Solutions beside those of a factor, and how every solve ends that does not converge.
#include "iterative/conjugate_gradients.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <limits>

#include "solvers/iterative/tangents.h"

namespace palpate::test::test_conjugate_gradients {
namespace {

Eigen::MatrixXd random_columns(Index size, int count, std::uint64_t seed = 73) {
  return Random(seed).vector(Eigen::Index{size} * count, 1).reshaped(size, count);
}

/// True residual of the worst column, over its right-hand side.
double residual_of(const Tangent& tangent, const Eigen::MatrixXd& x, const Eigen::MatrixXd& b) {
  const Eigen::MatrixXd r = b - tangent.matrix() * x;
  return (r.colwise().norm().array() / b.colwise().norm().array()).maxCoeff();
}

class Solving : public testing::TestWithParam<Kind> {
 protected:
  /// The solution agrees with that of a factor.
  /// @param tolerance Of the residual.
  /// @param agreement Of the solutions.
  static int expect_solved(const Tangent& tangent, double tolerance = kTight,
                           double agreement = kAgreement) {
    auto preconditioner = GetParam().make(tangent);
    const SetupReport report = preconditioner->refresh(tangent.values);
    EXPECT_EQ(report.status, SetupStatus::ok) << to_string(report);
    const Eigen::VectorXd b = random_columns(tangent.size(), 1);
    Eigen::MatrixXd x = b;
    const Operator k(tangent.pattern, tangent.values);
    KrylovSolver solver({tolerance, 1000});
    const SolveSummary summary = solver.solve(k, *preconditioner, x);
    EXPECT_EQ(summary.status, SolveStatus::converged) << to_string(summary.status);
    EXPECT_LE(summary.residual, tolerance);
    EXPECT_NEAR(residual_of(tangent, x, b), summary.residual, 0.5 * tolerance)
        << "what is reported is the true residual";
    const auto direct = make_linear_solver();
    direct->analyse(tangent.scalars);
    EXPECT_EQ(direct->factorise(tangent.values), FactorStatus::ok);
    EXPECT_EQ(direct->negative_pivots(), 0);
    Eigen::MatrixXd expected = b;
    direct->solve(expected);
    EXPECT_LT((x - expected).norm(), agreement * expected.norm());
    return summary.iterations;
  }

  static constexpr double kTight = 1e-11;
  /// Of solutions with such a residual in bodies with a condition of some 1e4.
  static constexpr double kAgreement = 1e-8;
  /// Of a residual where the stiffest part has ten thousand times the stiffness of the softest: the
  /// rounding of b − K x is as many times that of b.
  static constexpr double kOfContrast = 1e-9;
  /// And of the solutions: the soft part's is known from a residual that the stiff part dominates.
  static constexpr double kAgreementOfContrast = 1e-5;
};

INSTANTIATE_TEST_SUITE_P(Each, Solving, testing::ValuesIn(kinds()),
                         [](const auto& each) { return each.param.name; });

class Difficult : public Solving {};
INSTANTIATE_TEST_SUITE_P(Each, Difficult, testing::ValuesIn(multigrid_kinds()),
                         [](const auto& each) { return each.param.name; });

TEST_P(Solving, AtRest) {
  const int iterations = expect_solved(tangent_of(block_scene()));
  if (GetParam().is_multigrid()) {
    EXPECT_LT(iterations, 60);
  }
}

TEST_P(Solving, WhereTheBodyIsStrained) {
  const Scene scene = block_scene();
  const int iterations = expect_solved(tangent_of(scene, stretched(scene, 0.6)));
  if (GetParam().is_multigrid()) {
    EXPECT_LT(iterations, 80);
  }
}

TEST_P(Solving, Tet4) { expect_solved(tangent_of(block_scene(ElementOrder::linear))); }

TEST_P(Difficult, AContrastOfTenThousand) {
  Scene scene = block_scene(ElementOrder::quadratic, {6, 4, 4});
  put_inside(scene, scaled(scene.organ.materials[0], 1e4),
             [](const Vec3& x) { return (x - Vec3(0.05, 0.03, 0.025)).norm() < 0.015; });
  expect_solved(tangent_of(scene), kOfContrast, kAgreementOfContrast);
}

TEST_P(Difficult, StiffAndSoftCellsAtRandom) {
  Scene scene = block_scene(ElementOrder::quadratic, {5, 4, 4});
  scene.organ.materials.push_back(scaled(scene.organ.materials[0], 1e4));
  scene.body.material_of_cell.clear();
  Random random(74);
  for (Index c = 0; c < scene.body.mesh.num_cells(); ++c) {
    scene.body.material_of_cell.push_back(random.uniform(0, 1) < 0.3 ? 1 : 0);
  }
  expect_solved(tangent_of(scene), kOfContrast, kAgreementOfContrast);
}

TEST_P(Difficult, NearlyIncompressible) {
  const Scene scene = block_scene(ElementOrder::quadratic, {4, 3, 3}, 0.49);
  EXPECT_LT(expect_solved(tangent_of(scene)), 150);
}

TEST_P(Difficult, Slivers) {
  for (double degrees : {2.0, 0.05}) {
    Scene scene;
    scene.body.mesh = make_sliver_box(ElementOrder::quadratic, degrees, 0.1);
    for (const Vec3& x : scene.body.mesh.points) scene.body.fixed.push_back(x.z() == 0 ? 1 : 0);
    scene.body.touchable.assign(scene.body.fixed.size(), 0);
    scene.organ.materials = {make_isotropic(Law::linear, 3000, 0.4)};
    EXPECT_LT(expect_solved(tangent_of(scene), kOfContrast, kAgreementOfContrast), 60);
  }
}

TEST_P(Solving, PartsThatDoNotTouch) {
  Scene scene = block_scene(ElementOrder::quadratic, {3, 2, 2});
  const auto fixed = scene.body.fixed;
  add_copy(scene.body.mesh, Vec3(0, 1, 0));
  scene.body.fixed.insert(scene.body.fixed.end(), fixed.begin(), fixed.end());
  scene.body.touchable.assign(scene.body.fixed.size(), 1);
  expect_solved(tangent_of(scene));
}

TEST_P(Solving, PointsThatAToolHolds) {
  // As CondensedSystem has them: their rows and columns are a multiple of the identity.
  Tangent tangent = tangent_of(block_scene());
  std::vector<char> held(tangent.levels.num_nodes(), 0);
  for (Index node = 0; node < 9; ++node) held[node] = 1;
  for (Index c = 0; c < tangent.size(); ++c) {
    for (Index i = tangent.scalars.column_start[c]; i < tangent.scalars.column_start[c + 1]; ++i) {
      const Index r = tangent.scalars.row[i];
      if (held[c / 3] == 0 && held[r / 3] == 0) continue;
      tangent.values[i] = r == c ? 100 : 0;
    }
  }
  tangent.levels = without(tangent.levels, held);
  expect_solved(tangent);
}

TEST_P(Solving, ThreeColumnsTakeOnePass) {
  const Tangent tangent = tangent_of(block_scene());
  auto preconditioner = GetParam().make(tangent);
  ASSERT_EQ(preconditioner->refresh(tangent.values).status, SetupStatus::ok);
  const Operator k(tangent.pattern, tangent.values);
  KrylovSolver solver({1e-9, 2000});
  Eigen::MatrixXd b = random_columns(tangent.size(), 7);
  b.col(1).setZero();
  b.col(2) *= 1e-150;  // each has its own scale
  Eigen::MatrixXd x = b;
  const SolveSummary together = solver.solve(k, *preconditioner, x);
  ASSERT_EQ(together.status, SolveStatus::converged) << to_string(together.status);
  EXPECT_EQ(x.col(1), b.col(1));
  int alone = 0;
  for (int c : {0, 2, 3, 6}) {
    Eigen::MatrixXd single = b.col(c);
    const SolveSummary summary = solver.solve(k, *preconditioner, single);
    ASSERT_EQ(summary.status, SolveStatus::converged);
    EXPECT_LT((single - x.col(c)).norm(), 1e-6 * single.norm()) << c;
    alone = std::max(alone, summary.iterations);
  }
  EXPECT_LE(together.iterations, 3 * (alone + 3)) << "two groups of three, and one";
}

TEST(ConjugateGradients, IterationsDoNotGrowWithTheBody) {
  for (CoarseSolver coarse : {CoarseSolver::aggregation, CoarseSolver::factor}) {
    std::vector<int> iterations;
    for (int cells : {3, 6, 12}) {
      const Tangent tangent =
          tangent_of(block_scene(ElementOrder::quadratic, {2 * cells, cells, cells}));
      const auto preconditioner = make_preconditioner(tangent.pattern, tangent.levels, coarse);
      ASSERT_EQ(preconditioner->refresh(tangent.values).status, SetupStatus::ok);
      Eigen::MatrixXd x = random_columns(tangent.size(), 1);
      KrylovSolver solver({});
      const SolveSummary summary =
          solver.solve({tangent.pattern, tangent.values}, *preconditioner, x);
      EXPECT_EQ(summary.status, SolveStatus::converged);
      iterations.push_back(summary.iterations);
    }
    EXPECT_LE(iterations.back(), 30);
    EXPECT_LE(iterations.back(), iterations.front() + 6);
  }
}

class Endings : public testing::Test {
 protected:
  Endings() : tangent_(tangent_of(small_scene())) {
    preconditioner_ = make_preconditioner(tangent_.pattern, tangent_.levels);
    (void)preconditioner_->refresh(tangent_.values);
    b_ = random_columns(tangent_.size(), 1);
  }

  SolveSummary solve(Eigen::MatrixXd& x, Preconditioner& preconditioner,
                     const SolveOptions& options = {}) {
    KrylovSolver solver(options);
    const SolveSummary summary =
        solver.solve({tangent_.pattern, tangent_.values}, preconditioner, x);
    EXPECT_TRUE(x.allFinite());
    return summary;
  }
  SolveSummary solve(Eigen::MatrixXd& x, const SolveOptions& options = {}) {
    return solve(x, *preconditioner_, options);
  }

  Tangent tangent_;
  std::unique_ptr<Preconditioner> preconditioner_;
  Eigen::MatrixXd b_;
};

TEST_F(Endings, NothingToDo) {
  Eigen::MatrixXd x = Eigen::MatrixXd::Zero(tangent_.size(), 3);
  const SolveSummary summary = solve(x);
  EXPECT_EQ(summary.status, SolveStatus::converged);
  EXPECT_EQ(summary.iterations, 0);
  EXPECT_EQ(summary.residual, 0);
  EXPECT_TRUE(x.isZero(0));
  Eigen::MatrixXd none(tangent_.size(), 0);
  EXPECT_EQ(solve(none).status, SolveStatus::converged);
}

TEST_F(Endings, IterationLimit) {
  SolveOptions options;
  options.max_iterations = 3;
  Eigen::MatrixXd x = b_;
  const SolveSummary summary = solve(x, options);
  EXPECT_EQ(summary.status, SolveStatus::iteration_limit);
  EXPECT_EQ(summary.iterations, 3);
  EXPECT_NEAR(summary.residual, residual_of(tangent_, x, b_), 1e-12);
  EXPECT_LT(summary.residual, 1) << "what was found is not thrown away";
}

TEST_F(Endings, NegativeCurvature) {
  const Eigen::VectorXd eigenvalues =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(tangent_.matrix()).eigenvalues();
  tangent_.shift(-(eigenvalues[0] + eigenvalues[1]) / 2);
  Eigen::MatrixXd x = b_;
  const SolveSummary summary = solve(x);
  ASSERT_EQ(summary.status, SolveStatus::negative_curvature) << to_string(summary.status);
  const Eigen::VectorXd& p = summary.direction;
  ASSERT_EQ(p.size(), tangent_.size());
  const double curvature = p.dot(tangent_.matrix() * p) / p.squaredNorm();
  EXPECT_LT(curvature, 0);
  EXPECT_NEAR(summary.curvature, curvature, 1e-6 * std::abs(curvature));
}

TEST_F(Endings, AToleranceBelowRounding) {
  SolveOptions options;
  options.tolerance = 1e-30;
  Eigen::MatrixXd x = b_;
  const SolveSummary summary = solve(x, options);
  EXPECT_EQ(summary.status, SolveStatus::stagnated) << to_string(summary.status);
  EXPECT_LT(summary.residual, 1e-13) << "it goes as far as it can";
}

// Bending is ten thousand times softer than stretch: for a hundred iterations and more the residual
// is larger than the right-hand side, while the energy falls.
TEST(ThinPlate, TheResidualGrowsBeforeItFalls) {
  Scene scene = small_scene();
  scene.body.mesh = make_box(ElementOrder::quadratic, {8, 8, 1}, {0.1, 0.1, 0.002});
  scene.body.fixed.clear();
  for (const Vec3& x : scene.body.mesh.points) scene.body.fixed.push_back(x.x() == 0 ? 1 : 0);
  scene.body.touchable.assign(scene.body.fixed.size(), 1);
  const Tangent tangent = tangent_of(scene);
  const auto preconditioner = make_preconditioner(tangent.pattern, tangent.levels);
  ASSERT_EQ(preconditioner->refresh(tangent.values).status, SetupStatus::ok);
  const Operator k(tangent.pattern, tangent.values);
  const Eigen::MatrixXd b = Eigen::MatrixXd::Ones(tangent.size(), 1);
  Eigen::MatrixXd x = b;
  const SolveSummary early = KrylovSolver({1e-5, 100}).solve(k, *preconditioner, x);
  EXPECT_EQ(early.status, SolveStatus::iteration_limit) << to_string(early.status);
  EXPECT_GT(early.residual, 1);
  x = b;
  const SolveSummary late = KrylovSolver({1e-5, 2000}).solve(k, *preconditioner, x);
  EXPECT_EQ(late.status, SolveStatus::converged) << to_string(late.status);
  EXPECT_LT(residual_of(tangent, x, b), 1e-5);
}

/// The matrix of a body that floats, with the preconditioner of one that is hardly held.
class Floating : public Endings {
 protected:
  Floating() {
    tangent_ = tangent_of(floating(small_scene()));
    Tangent held = tangent_;
    held.shift(1e-3);
    preconditioner_ = make_preconditioner(held.pattern, held.levels);
    EXPECT_EQ(preconditioner_->refresh(held.values).status, SetupStatus::ok);
  }
};

TEST_F(Floating, ALoadThatNothingHoldsHasNoSolution) {
  Eigen::MatrixXd x = Eigen::VectorXd::Ones(tangent_.size());
  const SolveSummary summary = solve(x);
  EXPECT_EQ(summary.status, SolveStatus::singular) << to_string(summary.status);
  EXPECT_GT(summary.residual, 0.5);
}

TEST_F(Floating, ALoadInEquilibriumHasOne) {
  const Eigen::VectorXd displacement = random_columns(tangent_.size(), 1);
  const Eigen::MatrixXd b = tangent_.matrix() * displacement;
  Eigen::MatrixXd x = b;
  const SolveSummary summary = solve(x);
  EXPECT_EQ(summary.status, SolveStatus::converged) << to_string(summary.status);
  EXPECT_LT(residual_of(tangent_, x, b), 1e-8);
}

TEST_F(Endings, WhatIsNoNumber) {
  for (double bad :
       {std::numeric_limits<double>::quiet_NaN(), -std::numeric_limits<double>::infinity()}) {
    Eigen::MatrixXd x = random_columns(tangent_.size(), 3);
    x(4, 1) = bad;
    EXPECT_EQ(solve(x).status, SolveStatus::not_finite);
    EXPECT_TRUE(x.isZero(0));
  }
  tangent_.values[100] = std::numeric_limits<double>::quiet_NaN();
  Eigen::MatrixXd x = b_;
  EXPECT_EQ(solve(x).status, SolveStatus::not_finite);
  EXPECT_TRUE(x.isZero(0));
}

TEST_F(Endings, AnOverflow) {
  Eigen::MatrixXd x = 1e200 * b_;
  EXPECT_EQ(solve(x).status, SolveStatus::not_finite) << "the square of its length is infinite";
}

TEST_F(Endings, NoPreconditioner) {
  const auto fresh = make_preconditioner(tangent_.pattern, tangent_.levels);
  Eigen::MatrixXd x = b_;
  EXPECT_EQ(solve(x, *fresh).status, SolveStatus::no_preconditioner);
  EXPECT_TRUE(x.isZero(0));
}

/// Another preconditioner's answer, changed.
class Changed final : public Preconditioner {
 public:
  using Change = std::function<void(NodeVectors<double>&)>;
  Changed(Preconditioner& base, Change change) : base_(base), change_(std::move(change)) {}
  void reserve(int columns) override { base_.reserve(columns); }
  void apply(const NodeVectors<double>& r, NodeVectors<double>& z) override {
    base_.apply(r, z);
    change_(z);
  }
  [[nodiscard]] std::size_t bytes() const override { return base_.bytes(); }

 private:
  [[nodiscard]] SetupReport prepare(const std::vector<double>& values) override {
    return base_.refresh(values);
  }
  Preconditioner& base_;
  Change change_;
};

TEST_F(Endings, APreconditionerThatIsNegative) {
  Changed negative(*preconditioner_, [](auto& z) { z.column(0) *= -1; });
  ASSERT_EQ(negative.refresh(tangent_.values).status, SetupStatus::ok);
  Eigen::MatrixXd x = b_;
  EXPECT_EQ(solve(x, negative).status, SolveStatus::indefinite_preconditioner);
}

TEST_F(Endings, APreconditionerThatGivesZero) {
  Changed zero(*preconditioner_, [](auto& z) { z.column(0).setZero(); });
  ASSERT_EQ(zero.refresh(tangent_.values).status, SetupStatus::ok);
  Eigen::MatrixXd x = b_;
  EXPECT_EQ(solve(x, zero).status, SolveStatus::indefinite_preconditioner);
}

TEST_F(Endings, APreconditionerThatGivesNoNumber) {
  Changed bad(*preconditioner_, [calls = 0](auto& z) mutable {
    if (++calls == 3) z.column(0)(1, 5) = std::numeric_limits<double>::quiet_NaN();
  });
  ASSERT_EQ(bad.refresh(tangent_.values).status, SetupStatus::ok);
  Eigen::MatrixXd x = b_;
  const SolveSummary summary = solve(x, bad);
  EXPECT_EQ(summary.status, SolveStatus::not_finite);
  EXPECT_LT(summary.residual, 1) << "the iterate before";
}

// A tangent that is indefinite where the body has buckled is solved for, as far as it goes, with
// the preconditioner of the state at rest.
TEST_F(Endings, ThePreconditionerOfAnotherState) {
  const Scene scene = small_scene();
  tangent_ = tangent_of(scene, stretched(scene, 0.6));
  Eigen::MatrixXd x = b_;
  const SolveSummary summary = solve(x);
  EXPECT_EQ(summary.status, SolveStatus::converged) << to_string(summary.status);
  EXPECT_LT(residual_of(tangent_, x, b_), 1e-8);
}

class Small : public testing::TestWithParam<Kind> {};
INSTANTIATE_TEST_SUITE_P(Each, Small, testing::ValuesIn(kinds()),
                         [](const auto& each) { return each.param.name; });

TEST_P(Small, EverythingIsFixed) {
  Scene scene = block_scene(ElementOrder::quadratic, {1, 1, 1});
  std::fill(scene.body.fixed.begin(), scene.body.fixed.end(), 1);
  const Tangent tangent = tangent_of(scene);
  ASSERT_EQ(tangent.size(), 0);
  auto preconditioner = GetParam().make(tangent);
  EXPECT_EQ(preconditioner->refresh(tangent.values).status, SetupStatus::ok);
  Eigen::MatrixXd x(0, 3);
  KrylovSolver solver({});
  EXPECT_EQ(solver.solve({tangent.pattern, tangent.values}, *preconditioner, x).status,
            SolveStatus::converged);
}

// One corner is free, or none but midside nodes are, or one node in all.
TEST_P(Small, FewNodesAreFree) {
  Scene scene = block_scene(ElementOrder::quadratic, {1, 1, 1});
  const Index count = scene.body.mesh.num_points();
  for (const auto& free :
       {std::vector<Index>{0}, std::vector<Index>{count - 1}, std::vector<Index>{0, 5, count - 1},
        std::vector<Index>{count - 3, count - 2, count - 1}}) {
    std::fill(scene.body.fixed.begin(), scene.body.fixed.end(), 1);
    for (Index p : free) scene.body.fixed[p] = 0;
    const Tangent tangent = tangent_of(scene);
    ASSERT_EQ(tangent.size(), 3 * static_cast<Index>(free.size()));
    auto preconditioner = GetParam().make(tangent);
    ASSERT_EQ(preconditioner->refresh(tangent.values).status, SetupStatus::ok);
    const Eigen::MatrixXd b = random_columns(tangent.size(), 3);
    Eigen::MatrixXd x = b;
    KrylovSolver solver({});
    EXPECT_EQ(solver.solve({tangent.pattern, tangent.values}, *preconditioner, x).status,
              SolveStatus::converged);
    EXPECT_LT(residual_of(tangent, x, b), 1e-8);
  }
}

}  // namespace
}  // namespace palpate::test::test_conjugate_gradients
