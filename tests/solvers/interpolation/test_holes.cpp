// SPDX-License-Identifier: BSD-3-Clause
// Where something is missing, and where the space ends: no jump, no NaN, no more than the limit.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "interpolation/interpolator.h"
#include "solvers/interpolation/analytic_space.h"
#include "solvers/interpolation/methods.h"

namespace palpate::test::test_holes {
namespace {

using test::analytic_space;
using test::at;
using test::exponential;
using test::kHalfWidth;
using test::points_on_sides;

constexpr double kLimit = 150;

class Holes : public testing::TestWithParam<Method> {
 protected:
  /// Uniform, and where the method takes it one of many sizes.
  [[nodiscard]] static std::vector<TouchToolSpace> tool_spaces() {
    std::vector<TouchToolSpace> tool_spaces{analytic_space(exponential, 5)};
    if (GetParam() != Method::tricubic)
      tool_spaces.push_back(test::graded_space(exponential, 3, 4));
    for (TouchToolSpace& tool_space : tool_spaces) {
      test::make_holes(tool_space, 0.2);
      at(tool_space, {0, 0, 0}) =
          test::analytic_configuration(tool_space.setup.grid, exponential, {0, 0, 0});
      tool_space.setup.policy.force_limit = kLimit;
    }
    return tool_spaces;
  }
};

TEST_P(Holes, ForceIsContinuousAcrossSides) {
  for (const TouchToolSpace& tool_space : tool_spaces()) {
    const auto interpolator = make_interpolator(GetParam(), tool_space);
    int beside_holes = 0;
    for (const auto& [t, across] : points_on_sides(tool_space, 100000)) {
      const TouchResult a = interpolator->evaluate(t - across);
      const TouchResult b = interpolator->evaluate(t + across);
      beside_holes +=
          a.support == Support::extrapolated || b.support == Support::extrapolated ? 1 : 0;
      ASSERT_LT((a.force - b.force).norm(), 1e-11 * (a.force.norm() + 10)) << t.transpose();
      ASSERT_NEAR(a.energy, b.energy, 1e-11 * (1 + std::abs(a.energy)));
    }
    EXPECT_GT(beside_holes, 50000);
  }
}

TEST_P(Holes, ForceIsContinuousAtTheBorderAndBeyond) {
  for (const TouchToolSpace& tool_space : tool_spaces()) {
    const auto interpolator = make_interpolator(GetParam(), tool_space);
    test::RandomPoints points(kHalfWidth);
    for (int i = 0; i < 2000; ++i) {
      Vec3 t = points();
      const int axis = i % 3;
      t[axis] = std::copysign(kHalfWidth, t[axis]);
      // Farther than what counts as the border.
      const Vec3 out = std::copysign(1e-11, t[axis]) * Vec3::Unit(axis);
      const TouchResult before = interpolator->evaluate(t - out);
      const TouchResult after = interpolator->evaluate(t + out);
      EXPECT_EQ(after.support, Support::extrapolated);
      // The stiffness may jump at the border; it is of this order.
      constexpr double kStiffness = 1e6;
      ASSERT_LT((after.force - before.force).norm(), 1e-11 * kStiffness);
      // Along the border, farther out, over the side between two cells.
      Vec3 beyond = 1.3 * t;
      const int other = (axis + 1) % 3;
      beyond[other] =
          tool_space.setup.grid.spacing() * std::round(t[other] / tool_space.setup.grid.spacing());
      const Vec3 across = 1e-14 * Vec3::Unit(other);
      const TouchResult low = interpolator->evaluate(beyond - across);
      const TouchResult high = interpolator->evaluate(beyond + across);
      ASSERT_LT((low.force - high.force).norm(), 1e-13 * kStiffness);
    }
  }
}

TEST_P(Holes, ForceIsLimited) {
  for (const TouchToolSpace& tool_space : tool_spaces()) {
    const auto interpolator = make_interpolator(GetParam(), tool_space);
    double largest = 0;
    for (const ConfigurationSummary& c : tool_space.configurations) {
      if (c.usable()) largest = std::max(largest, c.force.norm());
    }
    int limited = 0;
    test::RandomPoints points(3 * kHalfWidth);
    for (int i = 0; i < 5000; ++i) {
      const Vec3 t = points();
      const TouchResult r = interpolator->evaluate(t);
      const Vec3 nearest = t.cwiseMin(kHalfWidth).cwiseMax(-kHalfWidth);
      const double most = std::max(kLimit, interpolator->evaluate(nearest).force.norm());
      EXPECT_LE(r.force.norm(), (1 + 1e-12) * most);
      if (GetParam() != Method::linear) {
        EXPECT_LE(r.force.norm(), (1 + 1e-12) * 2 * largest);
      }
      if (nearest == t || r.force.norm() < (1 - 1e-9) * kLimit) continue;
      ++limited;
      // A force of constant size: its change is across it.
      if (most == kLimit) {
        EXPECT_LT((r.force.transpose() * r.stiffness).norm(),
                  1e-9 * r.force.norm() * (1 + r.stiffness.norm()));
      }
    }
    EXPECT_GT(limited, 500);
  }
}

TEST_P(Holes, AnyDisplacementHasAnAnswer) {
  // More than ten million over all methods; few under the sanitizers, which take their time.
#ifdef __SANITIZE_ADDRESS__
  constexpr int kShare = 50;
#else
  constexpr int kShare = 1;
#endif
  const Method method = GetParam();
  const bool is_radial = method == Method::rbf_linear || method == Method::rbf_cubic;
  const int count = (is_radial ? 300000 : 2500000) / kShare;
  std::vector<TouchToolSpace> tool_spaces{analytic_space(exponential, 3)};
  if (!is_radial) tool_spaces = this->tool_spaces();
  const double odd[] = {std::nan(""),
                        std::numeric_limits<double>::infinity(),
                        -std::numeric_limits<double>::infinity(),
                        std::numeric_limits<double>::max(),
                        -1e300,
                        1e150,
                        1e-320,
                        -0.0};
  std::minstd_rand random(9);
  int num = 0;
  for (const TouchToolSpace& tool_space : tool_spaces) {
    const auto interpolator = make_interpolator(method, tool_space);
    const double spacing = tool_space.setup.grid.spacing();
    for (std::size_t i = 0; i < count / tool_spaces.size(); ++i, ++num) {
      // Three half-widths either way; now and then on a side of cells, and not of this world.
      Vec3 t;
      for (int k = 0; k < 3; ++k) {
        t[k] = kHalfWidth * (6.0 * random() / std::minstd_rand::max() - 3);
      }
      const auto what = random() % 64;
      if (what < 3) t[what] = spacing * std::round(t[what] / spacing);
      if (what == 3) t *= 1e-6;
      if (what == 4) t[random() % 3] = odd[random() % 8];
      const TouchResult r = interpolator->evaluate(t);
      const double sum = r.energy + r.force.sum() + r.stiffness.sum();
      ASSERT_TRUE(std::isfinite(sum)) << t.transpose();
      ASSERT_TRUE(t.allFinite() || r.support == Support::none);
    }
  }
  EXPECT_GE(num, count - 1);
}

INSTANTIATE_TEST_SUITE_P(, Holes, testing::ValuesIn(all_methods()), test::name_of_method);

class ExtrapolatingMethods : public testing::TestWithParam<Method> {};

// An extrapolated node is the Taylor expansion at its neighbour: where Π is cubic, h quadratic, it
// is exact with third derivatives.
TEST_P(ExtrapolatingMethods, NodesGoOnFromTheirNeighbour) {
  const test::Energy cubic = [](const Vec3& t) {
    test::Sample s;
    for (const auto& [a, b, c] : {std::array{1, 1, 1}, {2, 1, 0}, {0, 0, 3}, {0, 2, 0}}) {
      const test::Sample of = test::monomial(a, b, c)(t);
      s.energy += of.energy;
      s.force += of.force;
      s.stiffness += of.stiffness;
    }
    return s;
  };
  const auto third = [](const Vec3& t) {
    ThirdDerivative sum = ThirdDerivative::Zero();
    for (const auto& [a, b, c] : {std::array{1, 1, 1}, {2, 1, 0}, {0, 0, 3}, {0, 2, 0}}) {
      sum += test::monomial_third(a, b, c)(t);
    }
    return sum;
  };
  TouchToolSpace tool_space = analytic_space(cubic);
  test::add_third_derivatives(tool_space, third);
  for (const CheckPoint& p : {CheckPoint{1, 1, 1}, {3, 3, 3}, {3, 3, 2}, {-3, 0, 0}}) {
    at(tool_space, p).outcome = Outcome::not_converged;
  }
  const auto interpolator = make_interpolator(GetParam(), tool_space);
  for (const ConfigurationSummary& c : tool_space.configurations) {
    const TouchResult r = interpolator->evaluate(c.t);
    EXPECT_LT((r.force - cubic(c.t).force).norm(), 1e-12 * (1 + c.force.norm()));
    EXPECT_NEAR(r.energy, cubic(c.t).energy, 1e-13);
  }
  InterpolationOptions without;
  without.third_derivatives = false;
  const ConfigurationSummary& missing = at(tool_space, {-3, 0, 0});
  const ConfigurationSummary& from = at(tool_space, {-3, -1, 0});
  const TouchResult r = make_interpolator(GetParam(), tool_space, without)->evaluate(missing.t);
  EXPECT_EQ(r.support, Support::extrapolated);
  EXPECT_LT((r.force - from.force - from.stiffness * (missing.t - from.t)).norm(), 1e-12);
  if (GetParam() != Method::energy_hermite) return;
  test::RandomPoints points;
  for (int i = 0; i < 500; ++i) {
    const Vec3 t = points();
    EXPECT_LT((interpolator->evaluate(t).force - cubic(t).force).norm(), 1e-9);
  }
}

INSTANTIATE_TEST_SUITE_P(, ExtrapolatingMethods,
                         testing::Values(Method::trilinear, Method::tricubic,
                                         Method::energy_hermite),
                         test::name_of_method);

}  // namespace
}  // namespace palpate::test::test_holes
