// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "accuracy/draw.h"
#include "accuracy/statistics.h"

namespace palpate::test::test_draw {
namespace {

constexpr TestSet kSet{7, 0, 0.02, 3};

std::ptrdiff_t count(const std::vector<TestPoint>& points, TestKind kind) {
  return std::count_if(points.begin(), points.end(),
                       [&](const TestPoint& point) { return point.kind == kind; });
}

TEST(Draw, GivesAsManyAsAskedForInTheBoxAndInOrder) {
  const std::vector<TestPoint> points = draw_test_points(kSet, 503);
  ASSERT_EQ(points.size(), 503U);
  EXPECT_EQ(count(points, TestKind::walk), 100);
  EXPECT_EQ(count(points, TestKind::near_rest), 50);
  EXPECT_TRUE(std::is_sorted(points.begin(), points.end()));
  for (const TestPoint& point : points) {
    EXPECT_LE(point.t.lpNorm<Eigen::Infinity>(), 0.02);
    if (point.kind == TestKind::near_rest) {
      EXPECT_LE(point.t.norm(), 0.0002);
    }
  }
}

// In a box whose half-width has a square of 0 each walk comes to its end.
TEST(Draw, ABoxFarBelowAllBodiesIsDrawnFrom) {
  const std::vector<TestPoint> points = draw_test_points({7, 0, 1e-300, 3}, 50);
  EXPECT_EQ(points.size(), 50U);
  for (const TestPoint& point : points) EXPECT_LE(point.t.lpNorm<Eigen::Infinity>(), 1e-300);
}

TEST(Draw, FewPointsAreTheFirstOfMany) {
  const std::vector<TestPoint> many = draw_test_points(kSet, 400);
  for (const TestPoint& point : draw_test_points(kSet, 57)) {
    const auto same = std::lower_bound(many.begin(), many.end(), point);
    ASSERT_NE(same, many.end());
    EXPECT_EQ(same->kind, point.kind);
    EXPECT_EQ(same->number, point.number);
    EXPECT_EQ(same->t, point.t);
  }
}

TEST(Draw, OtherSeedsAndNodesHaveOtherPoints) {
  const Vec3 t = draw_test_points(kSet, 10).front().t;
  TestSet other = kSet;
  other.seed = 4;
  EXPECT_NE(draw_test_points(other, 10).front().t, t);
  other = kSet;
  other.tool_space = 8;
  EXPECT_NE(draw_test_points(other, 10).front().t, t);
}

TEST(Draw, PointsFillTheBoxEvenly) {
  Vec3 sum = Vec3::Zero();
  Vec3 squares = Vec3::Zero();
  int num = 0;
  for (const TestPoint& point : draw_test_points(kSet, 10000)) {
    if (point.kind != TestKind::uniform) continue;
    sum += point.t / 0.02;
    squares += (point.t / 0.02).cwiseAbs2();
    ++num;
  }
  // Four standard deviations of the mean of 7000.
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(sum[k] / num, 0, 4 * std::sqrt(1 / 3.0 / num));
    EXPECT_NEAR(squares[k] / num, 1 / 3.0, 4 * std::sqrt(4 / 45.0 / num));
  }
}

TEST(Draw, WalksBeginAtRestAndTakeSmallSteps) {
  Vec3 last = Vec3::Zero();
  int num = 0;
  for (const TestPoint& point : draw_test_points(kSet, 1000)) {
    if (point.kind != TestKind::walk) continue;
    if (point.number % kWalkLength == 0) last.setZero();
    EXPECT_NEAR((point.t - last).norm(), kWalkStep * 0.02, 1e-15);
    last = point.t;
    ++num;
  }
  EXPECT_EQ(num, 200);
}

TEST(Draw, AnchorsAreTheMiddlesOfEqualParts) {
  EXPECT_EQ(anchor_of({0.001, -0.006, 0}, 0.02), Vec3(0, 0, 0));
  EXPECT_LE((anchor_of({0.019, -0.0067, 0.0066}, 0.02) - 0.04 / 3 * Vec3(1, -1, 0)).norm(), 1e-15);
  EXPECT_LE((anchor_of({0.02, -0.02, 0.03}, 0.02) - 0.04 / 3 * Vec3(1, -1, 1)).norm(), 1e-15);
}

TEST(Statistics, AreThoseOfTheNumbers) {
  const std::vector<double> values{5, 1, 4, 2, 3};
  EXPECT_EQ(mean(values), 3);
  EXPECT_EQ(largest(values), 5);
  EXPECT_EQ(quantile(values, 0.5), 3);
  EXPECT_EQ(quantile(values, 0.2), 1);
  EXPECT_EQ(quantile(values, 0.21), 2);
  EXPECT_EQ(quantile(values, 1), 5);
  EXPECT_TRUE(std::isnan(mean({})));
  EXPECT_TRUE(std::isnan(largest({})));
  EXPECT_TRUE(std::isnan(quantile({}, 0.5)));
}

}  // namespace
}  // namespace palpate::test::test_draw
