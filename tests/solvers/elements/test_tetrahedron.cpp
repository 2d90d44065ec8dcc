// SPDX-License-Identifier: BSD-3-Clause
#include "elements/tetrahedron.h"

#include <gtest/gtest.h>

#include <cmath>

#include "solvers/support/finite_difference.h"
#include "solvers/support/orders.h"
#include "solvers/support/random.h"

namespace palpate::test::test_tetrahedron {
namespace {

/// A dozen operations on numbers of order one.
constexpr double kRounding = 1e-14;

constexpr int kEdges[6][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};

Vec3 reference_node(int a) {
  const Vec3 corners[4] = {Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};
  return a < 4 ? corners[a] : Vec3((corners[kEdges[a - 4][0]] + corners[kEdges[a - 4][1]]) / 2);
}

/// ∫ x^a y^b z^c over the reference tetrahedron: a! b! c! / (a + b + c + 3)!.
double integral_of_monomial(int a, int b, int c) {
  return std::tgamma(a + 1) * std::tgamma(b + 1) * std::tgamma(c + 1) / std::tgamma(a + b + c + 4);
}

double monomial(const Vec3& x, int a, int b, int c) {
  return std::pow(x[0], a) * std::pow(x[1], b) * std::pow(x[2], c);
}

class Tetrahedron : public testing::TestWithParam<ElementOrder> {
 protected:
  int nodes() const { return nodes_per_cell(GetParam()); }
  /// Degree up to which shape functions are complete and the quadrature is exact.
  int degree() const { return static_cast<int>(GetParam()); }
  Random random_{11};
  Vec3 random_point() {
    Vec3 x;
    do {
      x = random_.vector(3, 1).cwiseAbs();
    } while (x.sum() > 1);
    return x;
  }
};

INSTANTIATE_TEST_SUITE_P(Elements, Tetrahedron, testing::ValuesIn(kOrders), name_of_order);

TEST_P(Tetrahedron, AShapeFunctionIsOneAtItsNodeAndZeroAtTheOthers) {
  for (int b = 0; b < nodes(); ++b) {
    const Eigen::VectorXd values = shape_values(GetParam(), reference_node(b));
    ASSERT_EQ(values.size(), nodes());
    EXPECT_LT((values - Eigen::VectorXd::Unit(nodes(), b)).norm(), kRounding) << "node " << b;
  }
}

TEST_P(Tetrahedron, ShapeFunctionsReproducePolynomialsOfTheirDegree) {
  for (int trial = 0; trial < 5; ++trial) {
    const Vec3 x = random_point();
    const Eigen::VectorXd values = shape_values(GetParam(), x);
    for (int a = 0; a <= degree(); ++a) {
      for (int b = 0; a + b <= degree(); ++b) {
        for (int c = 0; a + b + c <= degree(); ++c) {
          double sum = 0;
          for (int n = 0; n < nodes(); ++n) sum += values[n] * monomial(reference_node(n), a, b, c);
          EXPECT_NEAR(sum, monomial(x, a, b, c), kRounding) << a << b << c;
        }
      }
    }
  }
}

TEST_P(Tetrahedron, GradientsAreThoseOfTheShapeFunctions) {
  for (int trial = 0; trial < 5; ++trial) {
    const Vec3 x = random_point();
    const auto gradients = shape_gradients(GetParam(), x);
    ASSERT_EQ(gradients.rows(), nodes());
    for (int i = 0; i < 3; ++i) {
      // Polynomials of degree 2: central differences are exact for any step.
      const Eigen::VectorXd expected = derivative(
          [&](double step) { return shape_values(GetParam(), x + step * Vec3::Unit(i)); }, 0.5);
      EXPECT_LT((gradients.col(i) - expected).norm(), 10 * kRounding);
    }
    EXPECT_LT(gradients.colwise().sum().norm(), kRounding) << "a translation has no gradient";
  }
}

TEST_P(Tetrahedron, QuadratureIsExactToItsDegree) {
  const auto& rule = quadrature(GetParam());
  EXPECT_EQ(rule.size(), GetParam() == ElementOrder::linear ? 1U : 4U);
  for (int a = 0; a <= degree(); ++a) {
    for (int b = 0; a + b <= degree(); ++b) {
      for (int c = 0; a + b + c <= degree(); ++c) {
        double sum = 0;
        for (const auto& point : rule) sum += point.weight * monomial(point.xi, a, b, c);
        EXPECT_NEAR(sum, integral_of_monomial(a, b, c), kRounding) << a << b << c;
      }
    }
  }
}

}  // namespace
}  // namespace palpate::test::test_tetrahedron
