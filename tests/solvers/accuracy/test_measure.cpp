// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "accuracy/draw.h"
#include "accuracy/measure.h"
#include "accuracy/statistics.h"
#include "solvers/interpolation/analytic_space.h"

namespace palpate::test::test_measure {
namespace {

constexpr double kWidth = test::kHalfWidth;

/// A space of one tool space whose exact states are those of an energy.
struct Known {
  explicit Known(const test::Energy& of_points, const test::Energy& of_space,
                 std::int32_t resolution = 7) {
    space.tool_spaces.push_back(test::analytic_space(of_space, resolution));
    points = draw_test_points({4, 0, kWidth, 1}, 400);
    for (TestPoint& point : points) {
      const test::Sample sample = of_points(point.t);
      point.energy = sample.energy;
      point.force = sample.force;
      point.stiffness = sample.stiffness;
      point.outcome = Outcome::converged;
    }
  }

  Measurement measure(Method method, std::int32_t factor = 1) {
    errors.clear();
    const std::vector<std::optional<Vec3>> finer(points.size());
    return palpate::measure(space, space.tool_spaces.front(), {method, {}, factor}, {points, finer},
                            errors);
  }

  TouchSpace space;
  std::vector<TestPoint> points;
  std::vector<PointError> errors;
};

int count(const Measurement& m, PointClass c) { return m.points[static_cast<std::size_t>(c)]; }

TEST(Measure, AnErrorThatIsKnownIsFound) {
  // The space has forces that are all 2 % too large.
  const test::Energy exact = test::monomial(2, 0, 0);
  const test::Energy wrong = [&](const Vec3& t) {
    test::Sample sample = exact(t);
    sample.energy *= 1.02;
    sample.force *= 1.02;
    sample.stiffness *= 1.02;
    return sample;
  };
  Known known(exact, wrong);
  const double largest_force = 1.02 * exact(Vec3(kWidth, 0, 0)).force.norm();
  for (const Method method : {Method::trilinear, Method::energy_hermite}) {
    const Measurement m = known.measure(method);
    ASSERT_EQ(count(m, PointClass::inside), 400);
    for (std::size_t i = 0; i < known.points.size(); ++i) {
      const double force = known.points[i].force.norm();
      const double expected = 0.02 * force / std::max(force, kErrorFloor * largest_force);
      EXPECT_NEAR(known.errors[i].error, expected, 1e-12);
    }
    EXPECT_NEAR(largest(m.relative), 0.02, 1e-12);
    EXPECT_NEAR(mean(m.stiffness), 0.02, 1e-9);
    EXPECT_LE(largest(m.absolute), 0.02 * exact(Vec3(kWidth, 0, 0)).force.norm());
    EXPECT_EQ(m.near_rest.size(), 40U);
  }
}

TEST(Measure, MethodsAreExactWhereTheyShouldBe) {
  Known linear_force(test::monomial(1, 1, 0), test::monomial(1, 1, 0));
  for (const Method method : all_methods()) {
    const Measurement m = linear_force.measure(method);
    EXPECT_LE(largest(m.relative), 1e-9) << to_string(method);
    EXPECT_LE(largest(m.force_jump), 1e-12) << to_string(method);
    EXPECT_GT(quantile(m.nanoseconds, 0.999), 0);
    EXPECT_GE(quantile(m.nanoseconds, 0.999), quantile(m.nanoseconds, 0.5));
  }
}

TEST(Measure, MoreConfigurationsAreBetterAndHermiteIsTheBest) {
  Known known(test::exponential, test::exponential, 9);
  const double hermite = mean(known.measure(Method::energy_hermite).relative);
  EXPECT_LT(hermite, mean(known.measure(Method::energy_hermite, 2).relative));
  EXPECT_EQ(known.measure(Method::energy_hermite, 2).samples, 125);
  EXPECT_LT(hermite, 0.25 * mean(known.measure(Method::tricubic).relative));
  EXPECT_LT(hermite, 0.01 * mean(known.measure(Method::trilinear).relative));
}

TEST(Measure, OnlyAGradientDoesNoWorkAroundAPath) {
  Known known(test::exponential, test::exponential);
  const Measurement hermite = known.measure(Method::energy_hermite);
  EXPECT_EQ(hermite.loop_work.size(), 20U);
  EXPECT_LE(largest(hermite.loop_work), 1e-12);
  EXPECT_LE(largest(hermite.stiffness_jump), 1e-10);
  const Measurement trilinear = known.measure(Method::trilinear);
  EXPECT_GE(largest(trilinear.loop_work), 1e-4);
  EXPECT_GE(largest(trilinear.stiffness_jump), 1e-3);
}

TEST(Measure, WhatIsNotRegularIsToldApart) {
  Known known(test::exponential, test::exponential);
  known.points[0].outcome = Outcome::not_converged;
  known.points[1].flags = flags::inverted;
  for (ConfigurationSummary& c : known.space.tool_spaces.front().configurations) {
    if (c.check_point[0] == 3) c.flags = flags::inverted;
    if (c.check_point[0] == -3) c.outcome = Outcome::not_converged;
  }
  const Measurement m = known.measure(Method::energy_hermite);
  EXPECT_EQ(count(m, PointClass::failed), 1);
  EXPECT_EQ(count(m, PointClass::irregular), 1);
  EXPECT_TRUE(std::isnan(known.errors[0].error));
  for (std::size_t i = 2; i < known.points.size(); ++i) {
    const double x = known.points[i].t[0];
    const PointClass expected = x > 2 * kWidth / 3    ? PointClass::marked
                                : x < -2 * kWidth / 3 ? PointClass::extrapolated
                                                      : PointClass::inside;
    EXPECT_EQ(known.errors[i].point_class, expected) << known.points[i].t.transpose();
  }
  EXPECT_EQ(m.relative.size(), static_cast<std::size_t>(count(m, PointClass::inside)));
  EXPECT_EQ(m.marked.size(), static_cast<std::size_t>(count(m, PointClass::marked)));
  EXPECT_FALSE(m.extrapolated.empty());
}

TEST(Measure, VariantsAreThoseThatTheSpaceServes) {
  TouchToolSpace tool_space = test::analytic_space(test::exponential);
  const auto names = [&](const std::vector<Method>& methods = {}) {
    std::vector<std::string> all;
    for (const Variant& v : variants(tool_space, methods)) {
      if (v.factor == 1) all.push_back(to_string(v));
    }
    return all;
  };
  EXPECT_EQ(names({Method::energy_hermite}), std::vector<std::string>{"Energy Hermite"});
  EXPECT_EQ(names({Method::rbf_cubic}),
            (std::vector<std::string>{"RBF cubic", "RBF cubic, no polynomial"}));
  EXPECT_EQ(names().size(), 8U);
  tool_space.intermediate_states.emplace_back();
  for (ConfigurationSummary& c : tool_space.configurations) c.third_derivative.setZero();
  EXPECT_EQ(names({Method::energy_hermite, Method::rbf_linear}),
            (std::vector<std::string>{"Energy Hermite", "Energy Hermite, no third derivatives",
                                      "RBF linear", "RBF linear, no polynomial",
                                      "RBF linear, no intermediate states"}));
  // Without rest there is no stiffness at rest.
  test::at(tool_space, {0, 0, 0}).outcome = Outcome::not_converged;
  EXPECT_TRUE(names({Method::linear}).empty());
  tool_space = test::graded_space(test::exponential, 5, 1);
  const auto tricubic = variants(tool_space, {Method::tricubic});
  ASSERT_EQ(tricubic.size(), 1U);
  EXPECT_EQ(tricubic[0].factor, 2);
}

}  // namespace
}  // namespace palpate::test::test_measure
