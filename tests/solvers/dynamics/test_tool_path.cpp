// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <limits>

#include "base/error.h"
#include "dynamics/tool_path.h"

namespace palpate::test::test_tool_path {
namespace {

TEST(ToolPath, GoesThroughItsPlacesSmoothlyAndNotBeyondThem) {
  Eigen::MatrixXd places(1, 5);
  places << 0, 1, 3, 3, 2;
  const ToolPath path({0, 0.1, 0.2, 0.5, 0.6}, places);
  EXPECT_EQ(path.at(-1)[0], 0);
  EXPECT_EQ(path.at(9)[0], 2);
  const double times[] = {0, 0.1, 0.2, 0.5, 0.6};
  for (int i = 0; i < 5; ++i) EXPECT_NEAR(path.at(times[i])[0], places(0, i), 1e-14);
  double last_speed = 0;
  constexpr double h = 1e-4;
  for (double t = 0; t < 0.7; t += h) {
    const double here = path.at(t)[0];
    const double speed = (path.at(t + h)[0] - here) / h;
    EXPECT_LT(std::abs(speed - last_speed), 0.2) << "a jump of the velocity at " << t;
    last_speed = speed;
    EXPECT_LE(here, 3 + 1e-14);
    EXPECT_GE(here, 0);
    if (t > 0.2 && t < 0.5) {
      EXPECT_NEAR(here, 3, 1e-14) << "it stands still";
    }
  }
}

TEST(ToolPath, AToolThatIsLetGoStaysWhereItWas) {
  Eigen::MatrixXd places(6, 2);
  places << 0, 1, 0, 2, 0, 3, 0, 4, 0, 5, 0, 6;
  ToolPath path({0, 1}, places);
  EXPECT_EQ(path.next_release(-1), std::numeric_limits<double>::infinity());
  const Eigen::VectorXd held = path.at(0.8);
  const Eigen::VectorXd at_release = path.at(0.4);
  path.let_go(1, 0.4);
  EXPECT_EQ(path.release(1), 0.4);
  EXPECT_EQ(path.next_release(0.3), 0.4);
  EXPECT_EQ(path.next_release(0.4), std::numeric_limits<double>::infinity());
  EXPECT_EQ(path.at(0.4), at_release);
  EXPECT_EQ(path.at(0.8).head<3>(), held.head<3>());
  EXPECT_EQ(path.at(0.8).tail<3>(), at_release.tail<3>());
  EXPECT_THROW(path.let_go(2, 0.1), InputError);
  EXPECT_THROW(path.let_go(-1, 0.1), InputError);
  EXPECT_THROW(path.let_go(0, std::numeric_limits<double>::quiet_NaN()), InputError);
}

// A jump is two rows that are nearly at the same time.
TEST(ToolPath, RowsThatAreNearlyAtTheSameTimeGiveNumbers) {
  for (const double gap : {1e-9, 1e-15, 1e-310}) {
    Eigen::MatrixXd places = Eigen::MatrixXd::Zero(3, 4);
    places.row(0) << 0, 0.01, 0.03, 0.05;
    const ToolPath path({-0.1, 0, gap, 0.2}, places);
    double last = 0;
    for (int i = -10; i <= 20; ++i) {
      const Eigen::VectorXd at = path.at(0.01 * i);
      ASSERT_TRUE(at.allFinite()) << gap;
      EXPECT_GE(at.x(), last);
      last = at.x();
    }
    EXPECT_NEAR(path.at(0).x(), 0.01, 1e-15);
    EXPECT_EQ(path.at(0.2).x(), 0.05);
  }
}

TEST(ToolPath, OneThatIsNoneIsRefused) {
  const Eigen::MatrixXd two = Eigen::MatrixXd::Zero(3, 2);
  EXPECT_THROW(ToolPath({}, Eigen::MatrixXd(3, 0)), InputError);
  EXPECT_THROW(ToolPath({0.0}, two), InputError);
  EXPECT_THROW(ToolPath({0, 0}, two), InputError);
  EXPECT_THROW(ToolPath({1, 0}, two), InputError);
  EXPECT_THROW(ToolPath({0, std::numeric_limits<double>::quiet_NaN()}, two), InputError);
  Eigen::MatrixXd infinite = two;
  infinite(1, 1) = std::numeric_limits<double>::infinity();
  EXPECT_THROW(ToolPath({0, 1}, infinite), InputError);
}

}  // namespace
}  // namespace palpate::test::test_tool_path
