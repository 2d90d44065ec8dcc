// SPDX-License-Identifier: BSD-3-Clause
#include "fields/pod.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "base/error.h"

namespace palpate::test::test_pod {
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

/// The parts of snapshots as a tool space has them: u of n configurations, then three w for each.
struct Parts {
  explicit Parts(const MatrixXf& snapshots)
      : bound(snapshots.leftCols(snapshots.cols() / 4)),
        following(snapshots.rightCols(snapshots.cols() / 4 * 3)) {}
  MatrixXf bound;
  MatrixXf following;
};

PodFit fit_of(const std::vector<MatrixXf>& batches, double limit, const MatrixXf& begin = {}) {
  PodBasis basis(batches.front().rows(), 3, limit, begin);
  for (const MatrixXf& batch : batches) {
    const Parts parts(batch);
    basis.add(parts.bound, parts.following);
  }
  return basis.finish();
}

/// The same snapshots in batches of so many configurations.
std::vector<MatrixXf> in_batches(const MatrixXf& snapshots, Eigen::Index size) {
  const Parts all(snapshots);
  std::vector<MatrixXf> batches;
  for (Eigen::Index first = 0; first < all.bound.cols(); first += size) {
    const Eigen::Index count = std::min(size, all.bound.cols() - first);
    MatrixXf& batch = batches.emplace_back(snapshots.rows(), 4 * count);
    batch << all.bound.middleCols(first, count), all.following.middleCols(3 * first, 3 * count);
  }
  return batches;
}

void expect_bound(const MatrixXf& snapshots, const PodFit& fit, double limit) {
  const Parts parts(snapshots);
  const double error = largest(parts.bound - fit.modes * fit.bound);
  EXPECT_LE(error, limit);
  // Products of single precision, of so many terms, round by so much.
  const double rounding = 5e-7 * largest(snapshots);
  EXPECT_LE(error, fit.bound_error + rounding);
  EXPECT_LE(fit.bound_error, limit);
  EXPECT_LE(largest(parts.following - fit.modes * fit.following), fit.following_error + rounding);
}

class PodBound : public testing::TestWithParam<double> {};

TEST_P(PodBound, HoldsAtEveryPointOfEverySnapshot) {
  const MatrixXf s = decaying_snapshots(300, 4 * 50, 0.8F, 1);
  const double limit = GetParam() * largest(s.leftCols(50));
  for (const Eigen::Index batch : {50, 7}) {
    const PodFit fit = fit_of(in_batches(s, batch), limit);
    expect_bound(s, fit, limit);
    EXPECT_GT(fit.bound_error, 0.1 * limit) << "more modes than the bound needs";
    expect_orthonormal(fit.modes);
  }
}

INSTANTIATE_TEST_SUITE_P(, PodBound, testing::Values(1e-1, 1e-2, 1e-3, 1e-4, kLeastPodBound));

TEST(Pod, BatchesTakeHardlyMoreModes) {
  const MatrixXf s = decaying_snapshots(300, 4 * 50, 0.8F, 1);
  const double limit = 1e-3 * largest(s.leftCols(50));
  const Eigen::Index at_once = fit_of({s}, limit).modes.cols();
  // A fifth more: a batch is represented a little better than it would have to be in the end.
  EXPECT_LE(fit_of(in_batches(s, 25), limit).modes.cols(), at_once * 5 / 4);
}

TEST(Pod, LooserBoundsTakeFewerModes) {
  const MatrixXf s = decaying_snapshots(300, 4 * 50, 0.8F, 1);
  Eigen::Index previous = 61;
  for (double bound : {1e-4, 1e-3, 1e-2, 1e-1}) {
    const Eigen::Index rank = fit_of({s}, bound * largest(s.leftCols(50))).modes.cols();
    EXPECT_LT(rank, previous);
    previous = rank;
  }
  EXPECT_GT(previous, 0);
}

TEST(Pod, RankOfALowRankSet) {
  const MatrixXf s = random_matrix(600, 5, 3) * random_matrix(5, 4 * 40, 4);
  EXPECT_EQ(fit_of({s}, 1e-4 * largest(s)).modes.cols(), 5);
  EXPECT_EQ(fit_of(in_batches(s, 3), 1e-4 * largest(s)).modes.cols(), 5);
}

TEST(Pod, FullRankSetWithFewPoints) {
  const MatrixXf s = random_matrix(9, 4 * 30, 5);
  const double limit = kLeastPodBound * largest(s.leftCols(30));
  const PodFit fit = fit_of({s}, limit);
  EXPECT_EQ(fit.modes.cols(), 9);
  expect_bound(s, fit, limit);
}

TEST(Pod, ModesThatWereThereStayAndServeAgain) {
  const MatrixXf first = random_matrix(600, 5, 6) * random_matrix(5, 4 * 40, 7);
  MatrixXf second = random_matrix(600, 3, 8) * random_matrix(3, 4 * 20, 9);
  second += first.leftCols(80);
  const double limit = 1e-4 * largest(second);
  // Rounded, as they are stored: they are no longer orthonormal.
  const MatrixXf modes = fit_of({first}, limit).modes.cast<Eigen::half>().cast<float>();
  const PodFit fit = fit_of({second}, limit, modes);
  EXPECT_EQ(fit.modes.leftCols(5), modes);
  // Rounding leaves a little of the first beyond the span of its modes.
  EXPECT_LE(fit.modes.cols(), 8 + 5);
  expect_bound(second, fit, limit);
}

TEST(Pod, IsDeterministic) {
  const MatrixXf s = decaying_snapshots(300, 4 * 50, 0.8F, 1);
  const PodFit a = fit_of(in_batches(s, 20), 1e-6);
  const PodFit b = fit_of(in_batches(s, 20), 1e-6);
  EXPECT_EQ(a.bound, b.bound);
  EXPECT_EQ(a.following, b.following);
  EXPECT_EQ(a.modes, b.modes);
}

TEST(Pod, NothingToRepresent) {
  EXPECT_EQ(PodBasis(30, 3, 1).finish().modes.cols(), 0);
  const PodFit fit = fit_of({MatrixXf::Zero(30, 8)}, 1);
  EXPECT_EQ(fit.modes.cols(), 0);
  EXPECT_EQ(fit.bound.cols(), 2);
  EXPECT_EQ(fit.bound_error, 0);
}

TEST(Pod, PointsOfOneComponent) {
  const MatrixXf s = decaying_snapshots(200, 4 * 30, 0.7F, 11);
  const double limit = 1e-3 * s.leftCols(30).cwiseAbs().maxCoeff();
  PodBasis basis(200, 1, limit);
  basis.add(s.leftCols(30), s.rightCols(90));
  const PodFit fit = basis.finish();
  EXPECT_LE((s.leftCols(30) - fit.modes * fit.bound).cwiseAbs().maxCoeff(), limit);
}

TEST(Pod, RefusesBoundsItCannotKeep) {
  for (double bound : {0.0, -1.0, 1.0, kLeastPodBound / 2, std::nan("")}) {
    EXPECT_THROW(validate_pod_bound(bound), InputError) << bound;
  }
}

}  // namespace
}  // namespace palpate::test::test_pod
