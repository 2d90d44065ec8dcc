// SPDX-License-Identifier: BSD-3-Clause
// What every preconditioner promises: it is symmetric and positive definite, knows what it cannot
// prepare for, and then stays what it was.
#include "iterative/preconditioner.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <limits>

#include "base/error.h"
#include "iterative/smoothed_aggregation.h"
#include "solvers/iterative/tangents.h"

namespace palpate::test::test_preconditioner {
namespace {

/// Of a cycle in single precision.
constexpr double kSingle = 1e-5;

class EveryKind : public testing::TestWithParam<Kind> {
 protected:
  static std::unique_ptr<Preconditioner> ready(const Tangent& tangent) {
    auto preconditioner = GetParam().make(tangent);
    const SetupReport report = preconditioner->refresh(tangent.values);
    EXPECT_EQ(report.status, SetupStatus::ok) << to_string(report);
    return preconditioner;
  }
  static Eigen::MatrixXd inverse_by(Preconditioner& preconditioner, Index size) {
    return apply(preconditioner, Eigen::MatrixXd::Identity(size, size));
  }
};

INSTANTIATE_TEST_SUITE_P(All, EveryKind, testing::ValuesIn(kinds()),
                         [](const auto& each) { return each.param.name; });

TEST_P(EveryKind, IsSymmetricAndPositiveDefinite) {
  const Scene scene = small_scene();
  for (const NodalVector& state : {NodalVector(), stretched(scene, 0.6)}) {
    const Tangent tangent = tangent_of(scene, state);
    const auto preconditioner = ready(tangent);
    const Eigen::MatrixXd m = inverse_by(*preconditioner, tangent.size());
    EXPECT_LT((m - m.transpose()).norm(), kSingle * m.norm());
    const Eigen::MatrixXd symmetric = (m + m.transpose()) / 2;
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(symmetric).eigenvalues()[0], 0);
    // x·My = y·Mx.
    Random random(66);
    const Eigen::VectorXd x = random.vector(tangent.size(), 1);
    const Eigen::VectorXd y = random.vector(tangent.size(), 1);
    const double xy = x.dot(apply(*preconditioner, y).col(0));
    const double yx = y.dot(apply(*preconditioner, x).col(0));
    EXPECT_NEAR(xy, yx, kSingle * x.norm() * y.norm() * symmetric.norm());
  }
}

TEST_P(EveryKind, IsNearTheInverse) {
  const Scene scene = small_scene();
  for (const NodalVector& state : {NodalVector(), stretched(scene, 0.6)}) {
    const Tangent tangent = tangent_of(scene, state);
    const auto preconditioner = ready(tangent);
    // MK has the eigenvalues of LᵀML, where K = LLᵀ.
    const Eigen::MatrixXd l = tangent.matrix().llt().matrixL();
    const Eigen::MatrixXd m = inverse_by(*preconditioner, tangent.size());
    const Eigen::VectorXd eigenvalues =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(l.transpose() * m * l).eigenvalues();
    EXPECT_GT(eigenvalues.minCoeff(), GetParam().least);
    EXPECT_LT(eigenvalues.maxCoeff(), GetParam().greatest);
  }
}

// So large that there are levels of aggregates that are visited twice.
TEST(Preconditioner, ACycleWithManyLevelsIsSymmetric) {
  const Tangent tangent = tangent_of(block_scene(ElementOrder::linear, {40, 24, 20}));
  auto cycle = std::make_unique<AggregationCycle>(tangent.pattern, tangent.levels.corners);
  const AggregationCycle& hierarchy = *cycle;
  const auto preconditioner = make_preconditioner(tangent.pattern, std::move(cycle));
  ASSERT_EQ(preconditioner->refresh(tangent.values).status, SetupStatus::ok);
  ASSERT_GE(hierarchy.level_sizes().size(), 3U);
  Random random(75);
  for (int i = 0; i < 3; ++i) {
    const Eigen::VectorXd x = random.vector(tangent.size(), 1);
    const Eigen::VectorXd y = random.vector(tangent.size(), 1);
    const Eigen::VectorXd mx = apply(*preconditioner, x);
    const Eigen::VectorXd my = apply(*preconditioner, y);
    EXPECT_NEAR(x.dot(my), y.dot(mx), kSingle * std::sqrt(x.dot(mx) * y.dot(my)));
    EXPECT_GT(x.dot(mx), 0);
  }
}

TEST_P(EveryKind, ThreeColumnsAreAsOne) {
  const Tangent tangent = tangent_of(small_scene());
  const auto preconditioner = ready(tangent);
  const Eigen::MatrixXd columns =
      Random(67).vector(3 * Eigen::Index{tangent.size()}, 1).reshaped(tangent.size(), 3);
  const Eigen::MatrixXd one_by_one = apply(*preconditioner, columns);
  NodeVectors<double> r;
  NodeVectors<double> z;
  r.set_zero(tangent.pattern->num_nodes, 3);
  z.set_zero(tangent.pattern->num_nodes, 3);
  r.assign(columns);
  preconditioner->reserve(3);
  preconditioner->apply(r, z);
  Eigen::MatrixXd together(tangent.size(), 3);
  z.copy_to(together);
  EXPECT_LT((together - one_by_one).norm(), kSingle * one_by_one.norm());
}

TEST_P(EveryKind, TheUnitHasNoPart) {
  const Tangent tangent = tangent_of(small_scene());
  const Eigen::VectorXd x = Random(68).vector(tangent.size(), 1);
  const Eigen::VectorXd expected = apply(*ready(tangent), x);
  // Far beyond what single precision can hold.
  for (int exponent : {-200, 300}) {
    Tangent scaled = tangent;
    for (double& value : scaled.values) value = std::ldexp(value, exponent);
    const Eigen::VectorXd found = apply(*ready(scaled), x);
    EXPECT_EQ(Eigen::VectorXd(found * std::ldexp(1.0, exponent)), expected) << exponent;
    const Eigen::VectorXd of_small =
        apply(*ready(tangent), Eigen::VectorXd(std::ldexp(1.0, -300) * x));
    EXPECT_LT((std::ldexp(1.0, 300) * of_small - expected).norm(), kSingle * expected.norm());
  }
}

TEST_P(EveryKind, OfZeroIsZero) {
  const Tangent tangent = tangent_of(small_scene());
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(tangent.size());
  EXPECT_EQ(apply(*ready(tangent), zero), zero);
}

TEST_P(EveryKind, ARefreshIsAsGoodAsANewOne) {
  const Scene scene = small_scene();
  const Tangent rest = tangent_of(scene);
  const Tangent other = tangent_of(scene, stretched(scene, 0.6));
  const Eigen::VectorXd x = Random(69).vector(rest.size(), 1);
  const auto preconditioner = ready(rest);
  const Eigen::VectorXd at_rest = apply(*preconditioner, x);
  ASSERT_EQ(preconditioner->refresh(other.values).status, SetupStatus::ok);
  EXPECT_EQ(apply(*preconditioner, x), apply(*ready(other), x));
  ASSERT_EQ(preconditioner->refresh(rest.values).status, SetupStatus::ok);
  EXPECT_EQ(apply(*preconditioner, x), at_rest);
}

TEST_P(EveryKind, WhereItCannotPrepareItStaysWhatItWas) {
  const Tangent tangent = tangent_of(small_scene());
  auto preconditioner = GetParam().make(tangent);
  EXPECT_FALSE(preconditioner->is_ready());
  std::vector<double> bad = tangent.values;
  bad[bad.size() / 2] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(preconditioner->refresh(bad).status, SetupStatus::not_finite);
  EXPECT_FALSE(preconditioner->is_ready());

  ASSERT_EQ(preconditioner->refresh(tangent.values).status, SetupStatus::ok);
  EXPECT_TRUE(preconditioner->is_ready());
  const Eigen::VectorXd x = Random(70).vector(tangent.size(), 1);
  const Eigen::VectorXd expected = apply(*preconditioner, x);

  EXPECT_EQ(preconditioner->refresh(bad).status, SetupStatus::not_finite);
  EXPECT_EQ(apply(*preconditioner, x), expected);

  // Negative stiffness at two nodes, of which the first is named.
  bad = tangent.values;
  const BlockPattern& pattern = *tangent.pattern;
  for (Index node : {7, 11}) bad[pattern.first_value(node)] *= -1;
  const SetupReport report = preconditioner->refresh(bad);
  EXPECT_EQ(report.status, SetupStatus::indefinite_block);
  EXPECT_EQ(report.node, 7);
  EXPECT_EQ(report.num_indefinite_blocks, 2);
  EXPECT_EQ(report.negative_at_least, 1);
  EXPECT_NE(to_string(report).find("node 7"), std::string::npos) << to_string(report);
  EXPECT_EQ(apply(*preconditioner, x), expected);
}

TEST(Preconditioner, ABodyThatIsIndefiniteAsAWholeIsSeenOnTheCorners) {
  const Tangent tangent = tangent_of(small_scene());
  const Eigen::VectorXd eigenvalues =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(tangent.matrix()).eigenvalues();
  // Blocks stay definite; three modes do not.
  Tangent shifted = tangent;
  shifted.shift(-(eigenvalues[2] + eigenvalues[3]) / 2);
  for (CoarseSolver coarse : {CoarseSolver::aggregation, CoarseSolver::factor}) {
    const auto preconditioner = make_preconditioner(tangent.pattern, tangent.levels, coarse);
    ASSERT_EQ(preconditioner->refresh(tangent.values).status, SetupStatus::ok);
    const Eigen::VectorXd x = Random(71).vector(tangent.size(), 1);
    const Eigen::VectorXd expected = apply(*preconditioner, x);
    const SetupReport report = preconditioner->refresh(shifted.values);
    EXPECT_EQ(report.status, SetupStatus::indefinite);
    EXPECT_GE(report.negative_at_least, 1);
    EXPECT_LE(report.negative_at_least, 3) << "more than there are";
    EXPECT_EQ(apply(*preconditioner, x), expected);
  }
}

TEST(Preconditioner, ABodyThatFloatsIsSingular) {
  const Tangent tangent = tangent_of(floating(small_scene()));
  for (CoarseSolver coarse : {CoarseSolver::aggregation, CoarseSolver::factor}) {
    const auto preconditioner = make_preconditioner(tangent.pattern, tangent.levels, coarse);
    EXPECT_EQ(preconditioner->refresh(tangent.values).status, SetupStatus::singular);
  }
}

TEST(Preconditioner, ABodyOfTet4HasAggregationAlone) {
  const Tangent tangent = tangent_of(block_scene(ElementOrder::linear));
  const auto preconditioner = make_preconditioner(tangent.pattern, tangent.levels);
  ASSERT_EQ(preconditioner->refresh(tangent.values).status, SetupStatus::ok);
  const auto plain = make_preconditioner(
      tangent.pattern, make_aggregation_cycle(tangent.pattern, tangent.levels.corners));
  ASSERT_EQ(plain->refresh(tangent.values).status, SetupStatus::ok);
  const Eigen::VectorXd x = Random(72).vector(tangent.size(), 1);
  EXPECT_EQ(apply(*preconditioner, x), apply(*plain, x));
}

TEST(Preconditioner, LevelsOfAnotherBodyAreRefused) {
  const Tangent tangent = tangent_of(small_scene());
  const Tangent other = tangent_of(block_scene(ElementOrder::quadratic, {3, 3, 3}));
  EXPECT_THROW((void)make_preconditioner(tangent.pattern, other.levels), InputError);
}

}  // namespace
}  // namespace palpate::test::test_preconditioner
