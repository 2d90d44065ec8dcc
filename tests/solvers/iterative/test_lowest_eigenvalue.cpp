// SPDX-License-Identifier: BSD-3-Clause
// The lowest eigenvalue beside that of a dense solver, and its sign beside the negative pivots of a
// factor, in bodies before and after they buckle.
#include "iterative/lowest_eigenvalue.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <limits>

#include "iterative/cycle.h"
#include "solvers/iterative/tangents.h"

namespace palpate::test::test_lowest_eigenvalue {
namespace {

Eigen::VectorXd eigenvalues_of(const Tangent& tangent) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(tangent.matrix()).eigenvalues();
}

int negative_pivots(const Tangent& tangent) {
  const auto solver = make_linear_solver();
  solver->analyse(tangent.scalars);
  EXPECT_EQ(solver->factorise(tangent.values), FactorStatus::ok);
  return solver->negative_pivots();
}

/// The error of a value may be so many times its estimate, which takes the preconditioner for K⁻¹.
constexpr double kOfEstimate = 10;

class Lowest : public testing::TestWithParam<Kind> {
 protected:
  static std::unique_ptr<Preconditioner> ready(const Tangent& tangent) {
    auto preconditioner = GetParam().make(tangent);
    EXPECT_EQ(preconditioner->refresh(tangent.values).status, SetupStatus::ok);
    return preconditioner;
  }
};
// With the smoother alone, which is far from the inverse, the estimate is worth nothing.
INSTANTIATE_TEST_SUITE_P(Each, Lowest, testing::ValuesIn(multigrid_kinds()),
                         [](const auto& each) { return each.param.name; });

TEST_P(Lowest, IsThatOfTheMatrix) {
  const Scene scene = small_scene();
  for (const NodalVector& state : {NodalVector(), stretched(scene, 0.6)}) {
    const Tangent tangent = tangent_of(scene, state);
    const double exact = eigenvalues_of(tangent)[0];
    const auto preconditioner = ready(tangent);
    EigenOptions options;
    options.max_iterations = 300;
    for (double tolerance : {1e-2, 1e-6}) {
      options.tolerance = tolerance;
      const LowestEigenvalue found =
          find_lowest_eigenvalue({tangent.pattern, tangent.values}, *preconditioner, options);
      ASSERT_EQ(found.status, EigenStatus::converged) << to_string(found.status);
      EXPECT_GE(found.value, exact * (1 - 1e-9)) << "a value of xᵀKx is never below";
      EXPECT_LE(found.value, exact * (1 + kOfEstimate * tolerance));
      const Eigen::VectorXd& x = found.vector;
      EXPECT_NEAR(x.norm(), 1, 1e-6);
      EXPECT_NEAR(x.dot(tangent.matrix() * x), found.value, 1e-6 * found.value);
    }
  }
}

TEST_P(Lowest, OfAnIndefiniteMatrixWithThePreconditionerOfAnother) {
  const Tangent rest = tangent_of(small_scene());
  const Eigen::VectorXd eigenvalues = eigenvalues_of(rest);
  const auto preconditioner = ready(rest);
  for (double shift :
       {0.9 * eigenvalues[0], 1.1 * eigenvalues[0], 0.5 * (eigenvalues[4] + eigenvalues[5])}) {
    Tangent tangent = rest;
    tangent.shift(-shift);
    const double exact = eigenvalues[0] - shift;
    EigenOptions options;
    options.max_iterations = 500;
    const Operator k(tangent.pattern, tangent.values);
    const LowestEigenvalue sign = find_lowest_eigenvalue(k, *preconditioner, options);
    EXPECT_EQ(sign.status, exact < 0 ? EigenStatus::negative : EigenStatus::converged);
    EXPECT_EQ(sign.value < 0, exact < 0);
    options.stop_when_negative = false;
    options.tolerance = 1e-4;
    const LowestEigenvalue value = find_lowest_eigenvalue(k, *preconditioner, options);
    EXPECT_NEAR(value.value, exact, 0.02 * std::abs(exact));
  }
}

/// A column along x of St. Venant–Kirchhoff with ν = 0, held at its ends, compressed evenly: an
/// equilibrium, which is stable until the column buckles (tests/solvers/equilibrium).
Tangent column_at(double strain) {
  constexpr double kLength = 20;
  Scene scene;
  scene.body.mesh = make_box(ElementOrder::quadratic, {16, 1, 1}, {kLength, 1, 0.8});
  for (const Vec3& x : scene.body.mesh.points) {
    scene.body.fixed.push_back(x.x() == 0 || x.x() == kLength ? 1 : 0);
  }
  scene.body.touchable.assign(scene.body.fixed.size(), 1);
  scene.organ.materials = {make_isotropic(Law::st_venant_kirchhoff, 1000, 0)};
  NodalVector u = NodalVector::Zero(3 * Eigen::Index{scene.body.mesh.num_points()});
  for (Index p = 0; p < scene.body.mesh.num_points(); ++p) {
    u[3 * p] = -strain * scene.body.mesh.points[p].x();
  }
  return tangent_of(scene, u);
}

TEST_P(Lowest, ItsSignTellsWhetherAColumnHasBuckled) {
  const auto preconditioner = ready(column_at(0));
  int num_stable = 0;
  int num_unstable = 0;
  // It buckles in one direction at 0.0053, in the other at 0.0082.
  for (double strain : {0.0, 0.002, 0.004, 0.0045, 0.0060, 0.0075, 0.0095, 0.02}) {
    const Tangent tangent = column_at(strain);
    const int negative = negative_pivots(tangent);
    EigenOptions options;
    options.max_iterations = 2000;
    const LowestEigenvalue found =
        find_lowest_eigenvalue({tangent.pattern, tangent.values}, *preconditioner, options);
    EXPECT_EQ(found.status == EigenStatus::negative, negative > 0)
        << "strain " << strain << ", " << negative << " negative pivots, " << found.value;
    const Inertia inertia = inertia_of(found);
    EXPECT_EQ(inertia.knowledge, Inertia::Knowledge::at_least);
    EXPECT_EQ(inertia.num_negative, negative > 0 ? 1 : 0);
    EXPECT_EQ(inertia.lowest_eigenvalue, found.value);
    ++(negative > 0 ? num_unstable : num_stable);
  }
  EXPECT_EQ(num_stable, 4);
  EXPECT_EQ(num_unstable, 4);
}

TEST(LowestEigenvalue, ABuckledColumnIsSeenOnTheCorners) {
  const Tangent tangent = column_at(0.2);
  const int negative = negative_pivots(tangent);
  ASSERT_GE(negative, 2);
  for (CoarseSolver coarse : {CoarseSolver::aggregation, CoarseSolver::factor}) {
    const auto preconditioner = make_preconditioner(tangent.pattern, tangent.levels, coarse);
    const SetupReport report = preconditioner->refresh(tangent.values);
    EXPECT_EQ(report.status, SetupStatus::indefinite) << to_string(report);
    EXPECT_GE(report.negative_at_least, 1);
    EXPECT_LE(report.negative_at_least, negative);
    EXPECT_EQ(inertia_of({}, report).num_negative, report.negative_at_least);
  }
}

// A preconditioner that is far from the inverse makes the estimate of the error worth nothing, and
// the value that it ends with may be a hundred times the lowest. Its sign is right all the same.
TEST(LowestEigenvalue, ItsSignIsRightWithAPoorPreconditioner) {
  const Tangent rest = column_at(0);
  const auto preconditioner = make_preconditioner(rest.pattern, make_smoother_cycle(rest.pattern));
  ASSERT_EQ(preconditioner->refresh(rest.values).status, SetupStatus::ok);
  for (double strain : {0.0, 0.004, 0.0050, 0.0055, 0.0060, 0.02}) {
    const Tangent tangent = column_at(strain);
    EigenOptions options;
    options.max_iterations = options.max_solve_iterations = 4000;
    const LowestEigenvalue found =
        find_lowest_eigenvalue({tangent.pattern, tangent.values}, *preconditioner, options);
    EXPECT_EQ(found.status,
              negative_pivots(tangent) > 0 ? EigenStatus::negative : EigenStatus::converged)
        << "strain " << strain << ": " << to_string(found.status) << ", " << found.value;
  }
}

TEST(LowestEigenvalue, OneThatIsRoundingHasNoSign) {
  Tangent tangent = tangent_of(small_scene());
  const auto preconditioner = make_preconditioner(tangent.pattern, tangent.levels);
  ASSERT_EQ(preconditioner->refresh(tangent.values).status, SetupStatus::ok);
  tangent.shift(-eigenvalues_of(tangent)[0]);
  const LowestEigenvalue found =
      find_lowest_eigenvalue({tangent.pattern, tangent.values}, *preconditioner);
  EXPECT_EQ(found.status, EigenStatus::sign_unknown) << to_string(found.status);
  EXPECT_EQ(inertia_of(found).knowledge, Inertia::Knowledge::unknown);
  EXPECT_EQ(inertia_of(found).num_negative, 0);
}

TEST(LowestEigenvalue, WhereTheSolveForNoiseDoesNotEndTheSignIsNotKnown) {
  const Tangent tangent = tangent_of(small_scene());
  const auto preconditioner = make_preconditioner(tangent.pattern, tangent.levels);
  ASSERT_EQ(preconditioner->refresh(tangent.values).status, SetupStatus::ok);
  EigenOptions options;
  options.max_solve_iterations = 2;
  const LowestEigenvalue found =
      find_lowest_eigenvalue({tangent.pattern, tangent.values}, *preconditioner, options);
  EXPECT_EQ(found.status, EigenStatus::sign_unknown) << to_string(found.status);
  EXPECT_GT(found.value, 0) << "what was found is told";
  EXPECT_EQ(inertia_of(found).knowledge, Inertia::Knowledge::unknown);
}

// Many eigenvalues in one place: two bodies that are the same.
TEST(LowestEigenvalue, OfTwins) {
  Scene scene = small_scene();
  const double alone = eigenvalues_of(tangent_of(scene))[0];
  const auto fixed = scene.body.fixed;
  add_copy(scene.body.mesh, Vec3(0, 1, 0));
  scene.body.fixed.insert(scene.body.fixed.end(), fixed.begin(), fixed.end());
  scene.body.touchable.assign(scene.body.fixed.size(), 1);
  const Tangent tangent = tangent_of(scene);
  const auto preconditioner = make_preconditioner(tangent.pattern, tangent.levels);
  ASSERT_EQ(preconditioner->refresh(tangent.values).status, SetupStatus::ok);
  const LowestEigenvalue found =
      find_lowest_eigenvalue({tangent.pattern, tangent.values}, *preconditioner);
  EXPECT_EQ(found.status, EigenStatus::converged);
  EXPECT_NEAR(found.value, alone, 0.03 * alone);
}

// There are fewer modes than vectors in the iteration.
TEST(LowestEigenvalue, OfOneNode) {
  Scene scene = block_scene(ElementOrder::quadratic, {1, 1, 1});
  std::fill(scene.body.fixed.begin(), scene.body.fixed.end(), 1);
  scene.body.fixed[0] = 0;
  const Tangent tangent = tangent_of(scene);
  const auto preconditioner = make_preconditioner(tangent.pattern, tangent.levels);
  ASSERT_EQ(preconditioner->refresh(tangent.values).status, SetupStatus::ok);
  const LowestEigenvalue found =
      find_lowest_eigenvalue({tangent.pattern, tangent.values}, *preconditioner);
  EXPECT_EQ(found.status, EigenStatus::converged) << to_string(found.status);
  const double exact = eigenvalues_of(tangent)[0];
  EXPECT_NEAR(found.value, exact, 1e-9 * exact);
}

TEST(LowestEigenvalue, OfNothingAndOfWhatIsNoNumber) {
  Tangent tangent = tangent_of(small_scene());
  const auto preconditioner = make_preconditioner(tangent.pattern, tangent.levels);
  const LowestEigenvalue unprepared =
      find_lowest_eigenvalue({tangent.pattern, tangent.values}, *preconditioner);
  EXPECT_EQ(unprepared.status, EigenStatus::no_preconditioner);
  EXPECT_EQ(inertia_of(unprepared).knowledge, Inertia::Knowledge::unknown);
  ASSERT_EQ(preconditioner->refresh(tangent.values).status, SetupStatus::ok);
  tangent.values[3] = std::numeric_limits<double>::quiet_NaN();
  const LowestEigenvalue found =
      find_lowest_eigenvalue({tangent.pattern, tangent.values}, *preconditioner);
  EXPECT_EQ(found.status, EigenStatus::not_finite);
  EXPECT_EQ(inertia_of(found).knowledge, Inertia::Knowledge::unknown);

  const auto nothing = std::make_shared<const BlockPattern>(make_block_pattern({0, {0}, {}}));
  EXPECT_EQ(find_lowest_eigenvalue({nothing, std::vector<double>()}, *preconditioner).status,
            EigenStatus::converged);
}

TEST(LowestEigenvalue, WhatWasNotFoundIsNotKnown) {
  const Tangent tangent = tangent_of(small_scene());
  const auto preconditioner = make_preconditioner(tangent.pattern, tangent.levels);
  ASSERT_EQ(preconditioner->refresh(tangent.values).status, SetupStatus::ok);
  EigenOptions options;
  options.tolerance = 1e-12;
  options.max_iterations = 1;
  const LowestEigenvalue found =
      find_lowest_eigenvalue({tangent.pattern, tangent.values}, *preconditioner, options);
  EXPECT_EQ(found.status, EigenStatus::iteration_limit);
  EXPECT_EQ(inertia_of(found).knowledge, Inertia::Knowledge::unknown);
}

}  // namespace
}  // namespace palpate::test::test_lowest_eigenvalue
