// SPDX-License-Identifier: BSD-3-Clause
#include "interpolation/display_field.h"

#include <gtest/gtest.h>

#include <random>

#include "solvers/interpolation/analytic_space.h"

namespace palpate::test::test_display_field {
namespace {

using test::analytic_space;
using test::at;
using test::exponential;
using test::kHalfWidth;

constexpr int kModes = 5;

/// Coefficients quadratic in t, of the order of 1e-2.
struct Quadratic {
  Eigen::Matrix<double, kModes, 3> linear = Eigen::Matrix<double, kModes, 3>::Random();
  Eigen::Matrix<double, kModes, 9> second = Eigen::Matrix<double, kModes, 9>::Random();

  [[nodiscard]] Mat3 hessian(int m) const {
    const Eigen::Matrix<double, 9, 1> row = second.row(m).transpose();
    const Mat3 a = 40 * Eigen::Map<const Mat3>(row.data());
    return 0.5 * (a + a.transpose());
  }
  [[nodiscard]] Eigen::VectorXd value(const Vec3& t) const {
    Eigen::VectorXd c = linear * t;
    for (int m = 0; m < kModes; ++m) c[m] += 0.5 * t.dot(hessian(m) * t);
    return c;
  }
  [[nodiscard]] Eigen::MatrixXd gradient(const Vec3& t) const {
    Eigen::MatrixXd g = linear;
    for (int m = 0; m < kModes; ++m) g.row(m) += (hessian(m) * t).transpose();
    return g;
  }
};

TouchToolSpace quadratic_space(const Quadratic& field) {
  TouchToolSpace tool_space = analytic_space(exponential);
  const auto n = static_cast<Eigen::Index>(tool_space.configurations.size());
  tool_space.coefficients.resize(kModes, n);
  tool_space.coefficient_gradients.resize(3 * kModes, n);
  for (Eigen::Index c = 0; c < n; ++c) {
    const Vec3& t = tool_space.configurations[c].t;
    tool_space.coefficients.col(c) = field.value(t).cast<float>();
    const Eigen::MatrixXf g = field.gradient(t).cast<float>();
    for (int a = 0; a < 3; ++a) {
      tool_space.coefficient_gradients.col(c).segment(a * kModes, kModes) = g.col(a);
    }
  }
  return tool_space;
}

/// Coefficients are kept in single precision.
constexpr double kSingle = 1e-8;

TEST(DisplayField, IsExactForQuadraticFields) {
  const Quadratic quadratic;
  const DisplayField field(quadratic_space(quadratic));
  ASSERT_EQ(field.num_modes(), kModes);
  test::RandomPoints points;
  Eigen::VectorXf c(kModes);
  for (int i = 0; i < 300; ++i) {
    const Vec3 t = points();
    EXPECT_EQ(field.coefficients(t, c.data()), Support::inside);
    EXPECT_LT((c.cast<double>() - quadratic.value(t)).norm(), kSingle);
  }
}

TEST(DisplayField, GoesOnOutsideAndBesideHolesAsTheForceDoes) {
  const Quadratic quadratic;
  TouchToolSpace tool_space = quadratic_space(quadratic);
  at(tool_space, {1, 1, 1}).outcome = Outcome::not_converged;
  at(tool_space, {-1, -1, -1}).flags = flags::unstable;
  const DisplayField field(tool_space);
  const auto interpolator = make_interpolator(Method::energy_hermite, tool_space);
  Eigen::VectorXf c(kModes);

  const Vec3 border(0.003, -kHalfWidth, 0.001);
  const Vec3 offset(0, -0.004, 0);
  EXPECT_EQ(field.coefficients(border + offset, c.data()), Support::extrapolated);
  EXPECT_LT(
      (c.cast<double>() - quadratic.value(border) - quadratic.gradient(border) * offset).norm(),
      kSingle);

  // At the hole itself stands the expansion at the nearest node.
  const Vec3 hole = at(tool_space, {1, 1, 1}).t;
  const Vec3 nearest = at(tool_space, {0, 1, 1}).t;
  EXPECT_EQ(field.coefficients(hole, c.data()), Support::extrapolated);
  EXPECT_LT(
      (c.cast<double>() - quadratic.value(nearest) - quadratic.gradient(nearest) * (hole - nearest))
          .norm(),
      kSingle);

  test::RandomPoints points(1.5 * kHalfWidth);
  for (int i = 0; i < 500; ++i) {
    const Vec3 t = points();
    EXPECT_EQ(field.coefficients(t, c.data()), interpolator->evaluate(t).support);
    EXPECT_TRUE(c.allFinite());
  }
  EXPECT_EQ(field.coefficients(Vec3::Constant(std::nan("")), c.data()), Support::none);
  EXPECT_TRUE(c.isZero(0));
}

TEST(DisplayField, IsContinuousBesideHoles) {
  TouchToolSpace tool_space = analytic_space(exponential);
  const auto n = static_cast<Eigen::Index>(tool_space.configurations.size());
  tool_space.coefficients.setRandom(kModes, n);
  tool_space.coefficient_gradients.setRandom(3 * kModes, n);
  std::mt19937 random(3);
  for (ConfigurationSummary& c : tool_space.configurations) {
    if (random() % 4 == 0) c.outcome = Outcome::not_converged;
  }
  const DisplayField field(tool_space);
  const double h = tool_space.setup.grid.spacing();
  test::RandomPoints points(1.2 * kHalfWidth);
  Eigen::VectorXf a(kModes);
  Eigen::VectorXf b(kModes);
  for (int i = 0; i < 20000; ++i) {
    Vec3 t = points();
    const int axis = i % 3;
    t[axis] = h * (i % 7 - 3);
    const Vec3 across = 1e-12 * Vec3::Unit(axis);
    field.coefficients(t - across, a.data());
    field.coefficients(t + across, b.data());
    ASSERT_LT((a - b).norm(), 2e-6) << t.transpose();
  }
}

TEST(DisplayField, FarOutNothingIsFound) {
  const DisplayField field(quadratic_space(Quadratic()));
  Eigen::VectorXf c(kModes);
  for (double far : {1.0, 1e30, 1e39, 1e300, 1e308}) {
    const Support support = field.coefficients(Vec3(far, -far, far), c.data());
    EXPECT_TRUE(c.allFinite()) << far;
    EXPECT_EQ(support, far < 1e38 ? Support::extrapolated : Support::none);
  }
}

TEST(DisplayField, SiteWithoutModes) {
  TouchToolSpace tool_space = analytic_space(exponential, 3);
  tool_space.coefficients.resize(0, 27);
  tool_space.coefficient_gradients.resize(0, 27);
  const DisplayField field(tool_space);
  EXPECT_EQ(field.coefficients(Vec3::Zero(), nullptr), Support::inside);
}

TEST(ApplyModes, IsTheProductInBothPrecisions) {
  for (Eigen::Index rows : {0, 3, 511, 512, 513, 2400}) {
    const Eigen::MatrixXf modes = Eigen::MatrixXf::Random(rows, 40);
    const Eigen::VectorXf c = Eigen::VectorXf::Random(40);
    Eigen::VectorXf single(rows);
    Eigen::VectorXd twice(rows);
    apply_modes(modes, c.data(), single.data());
    apply_modes(modes, c.data(), twice.data());
    const Eigen::VectorXf expected = modes * c;
    EXPECT_LE((single - expected).cwiseAbs().sum(), 1e-5F * static_cast<float>(rows));
    EXPECT_EQ(single.cast<double>(), twice);
  }
}

}  // namespace
}  // namespace palpate::test::test_display_field
