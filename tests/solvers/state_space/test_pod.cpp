// SPDX-License-Identifier: BSD-3-Clause
#include "state_space/pod.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "base/error.h"

namespace palpate {
namespace {

using Eigen::MatrixXf;

MatrixXf random_matrix(Eigen::Index rows, Eigen::Index cols, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal;
  return MatrixXf::NullaryExpr(rows, cols, [&] { return normal(random); });
}

/// Fields whose singular values fall by `decay` from one to the next.
MatrixXf decaying_snapshots(Eigen::Index rows, Eigen::Index cols, float decay, unsigned seed) {
  const Eigen::Index rank = 60;
  MatrixXf left = random_matrix(rows, rank, seed);
  for (Eigen::Index c = 0; c < rank; ++c) left.col(c) *= 1e-3F * std::pow(decay, float(c));
  return left * random_matrix(rank, cols, seed + 1);
}

double largest(const MatrixXf& fields) {
  double result = 0;
  for (Eigen::Index c = 0; c < fields.cols(); ++c) {
    for (Eigen::Index i = 0; i < fields.rows(); i += 3) {
      result = std::max(result, fields.col(c).segment<3>(i).cast<double>().norm());
    }
  }
  return result;
}

void expect_orthonormal(const MatrixXf& modes) {
  const MatrixXf gram = modes.transpose() * modes;
  EXPECT_LT((gram - MatrixXf::Identity(gram.rows(), gram.cols())).cwiseAbs().maxCoeff(), 1e-5F);
}

class PodBound : public testing::TestWithParam<double> {};

TEST_P(PodBound, HoldsAtEveryPointOfEverySnapshot) {
  const MatrixXf s = decaying_snapshots(300, 4 * 50, 0.8F, 1);
  PodBasis basis(s.rows(), GetParam());
  const PodFit fit = basis.extend(s);
  const MatrixXf error = s - basis.modes() * fit.coefficients;
  EXPECT_NEAR(fit.largest_displacement, largest(s.leftCols(50)), 1e-9);
  EXPECT_LE(largest(error.leftCols(50)), GetParam() * fit.largest_displacement);
  EXPECT_LE(largest(error.leftCols(50)), fit.displacement_error);
  EXPECT_LE(largest(error.rightCols(150)), fit.sensitivity_error);
  EXPECT_LE(fit.displacement_error, GetParam() * fit.largest_displacement);
  EXPECT_GT(fit.displacement_error, 0.1 * GetParam() * fit.largest_displacement)
      << "more modes than the bound needs";
  expect_orthonormal(basis.modes());
}

INSTANTIATE_TEST_SUITE_P(, PodBound, testing::Values(1e-1, 1e-2, 1e-3, 1e-4, kLeastPodBound));

TEST(Pod, LooserBoundsTakeFewerModes) {
  const MatrixXf s = decaying_snapshots(300, 4 * 50, 0.8F, 1);
  Eigen::Index previous = 61;
  for (double bound : {1e-4, 1e-3, 1e-2, 1e-1}) {
    PodBasis basis(s.rows(), bound);
    (void)basis.extend(s);
    EXPECT_LT(basis.modes().cols(), previous);
    previous = basis.modes().cols();
  }
  EXPECT_GT(previous, 0);
}

TEST(Pod, RankOfALowRankSet) {
  const MatrixXf s = random_matrix(600, 5, 3) * random_matrix(5, 4 * 40, 4);
  PodBasis basis(s.rows(), 1e-4);
  (void)basis.extend(s);
  EXPECT_EQ(basis.modes().cols(), 5);
}

TEST(Pod, FullRankSetWithFewPoints) {
  const MatrixXf s = random_matrix(9, 4 * 30, 5);
  PodBasis basis(s.rows(), kLeastPodBound);
  const PodFit fit = basis.extend(s);
  EXPECT_EQ(basis.modes().cols(), 9);
  EXPECT_LE(fit.displacement_error, kLeastPodBound * fit.largest_displacement);
}

TEST(Pod, LaterSitesExtendTheBasisByWhatIsNew) {
  const MatrixXf first = random_matrix(600, 5, 6) * random_matrix(5, 4 * 40, 7);
  MatrixXf second = random_matrix(600, 3, 8) * random_matrix(3, 4 * 20, 9);
  second += first.leftCols(80);
  PodBasis basis(600, 1e-4);
  (void)basis.extend(first);
  const MatrixXf modes = basis.modes();
  const PodFit fit = basis.extend(second);
  EXPECT_EQ(basis.modes().cols(), 8);
  EXPECT_EQ(basis.modes().leftCols(5), modes);
  EXPECT_LE(largest((second - basis.modes() * fit.coefficients).leftCols(20)),
            1e-4 * fit.largest_displacement);
  expect_orthonormal(basis.modes());
  const PodFit again = basis.extend(first);
  EXPECT_EQ(basis.modes().cols(), 8);
  EXPECT_EQ(again.coefficients.rows(), 8);
}

TEST(Pod, IsDeterministic) {
  const MatrixXf s = decaying_snapshots(300, 4 * 50, 0.8F, 1);
  PodBasis a(s.rows(), 1e-3);
  PodBasis b(s.rows(), 1e-3);
  EXPECT_EQ(a.extend(s).coefficients, b.extend(s).coefficients);
  EXPECT_EQ(a.modes(), b.modes());
}

TEST(Pod, RestAloneKeepsItsSensitivity) {
  MatrixXf s(30, 4);
  s.col(0).setZero();
  s.rightCols(3) = random_matrix(30, 3, 10);
  PodBasis basis(30, 1e-3);
  const PodFit fit = basis.extend(s);
  EXPECT_EQ(basis.modes().cols(), 3);
  EXPECT_EQ(fit.largest_displacement, 0);
  EXPECT_LE(largest(s - basis.modes() * fit.coefficients), 1e-3 * largest(s));
}

TEST(Pod, RestAloneOfManySitesIsRepresented) {
  PodBasis basis(300, 1e-3);
  for (unsigned tool_space = 0; tool_space < 20; ++tool_space) {
    MatrixXf snapshots = 1e-3F * random_matrix(300, 4, tool_space);
    snapshots.col(0).setZero();
    const PodFit fit = basis.extend(snapshots);
    EXPECT_EQ(fit.largest_displacement, 0);
    EXPECT_LE(fit.sensitivity_error, 1e-3 * largest(snapshots));
  }
  EXPECT_EQ(basis.modes().cols(), 60);
}

TEST(Pod, NothingToRepresent) {
  PodBasis basis(30, 1e-3);
  EXPECT_EQ(basis.extend(MatrixXf(30, 0)).coefficients.cols(), 0);
  const PodFit fit = basis.extend(MatrixXf::Zero(30, 8));
  EXPECT_EQ(basis.modes().cols(), 0);
  EXPECT_EQ(fit.coefficients.cols(), 8);
  EXPECT_EQ(fit.displacement_error, 0);
}

TEST(Pod, RefusesBoundsItCannotKeep) {
  for (double bound : {0.0, -1.0, 1.0, kLeastPodBound / 2, std::nan("")}) {
    EXPECT_THROW(PodBasis(30, bound), InputError) << bound;
  }
}

}  // namespace
}  // namespace palpate
