// SPDX-License-Identifier: BSD-3-Clause
#include "interaction/bspline_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "base/error.h"
#include "solvers/interaction/jets.h"
#include "solvers/support/orders.h"
#include "solvers/support/random.h"

namespace palpate::test::test_bspline_grid {
namespace {

using Region = BsplineGrid::Region;
using test::Jet;

constexpr double kSpacing = 0.1;
const Eigen::AlignedBox3d kBox(Vec3(-1, -0.5, 0), Vec3(1, 1.5, 1));
/// Of a few hundred operations on numbers of size 1, the third derivative being divided by h³.
constexpr double kRounding = 1e-10;

Vec3 within(const Eigen::AlignedBox3d& box, test::Random& random) {
  Vec3 place;
  for (int k = 0; k < 3; ++k) place[k] = random.uniform(box.min()[k], box.max()[k]);
  return place;
}

// Every weight, scale and place of a coefficient is in this.
TEST(BsplineGrid, IsExactForPolynomialsOfDegreeThree) {
  const auto x = [](const Jet& a, const Jet& b) {  // the product of two jets
    Jet c;
    c.value = a.value * b.value;
    c.gradient = a.value * b.gradient + b.value * a.gradient;
    c.hessian = a.value * b.hessian + b.value * a.hessian + a.gradient * b.gradient.transpose() +
                b.gradient * a.gradient.transpose();
    int place = 0;
    for (int i = 0; i < 3; ++i) {
      for (int j = i; j < 3; ++j) {
        for (int k = j; k < 3; ++k, ++place) {
          c.third[place] = a.value * b.third[place] + b.value * a.third[place];
          for (const auto& [l, m, n] : {std::array{i, j, k}, {j, i, k}, {k, i, j}}) {
            c.third[place] += a.gradient[l] * b.hessian(m, n) + b.gradient[l] * a.hessian(m, n);
          }
        }
      }
    }
    return c;
  };
  test::Random random(1);
  for (int i = 0; i < 4; ++i) {
    const Eigen::Matrix<double, 3, 4> factors = random.vector(12, 1).reshaped(3, 4);
    const auto polynomial = [&](const Vec3& place) {
      Jet product;
      product.value = 1;
      for (int f = 0; f < 3; ++f) {
        Jet linear;
        linear.gradient = factors.row(f).head<3>();
        linear.value = linear.gradient.dot(place) + factors(f, 3);
        product = x(product, linear);
      }
      return product;
    };
    const BsplineGrid grid([&](const Vec3& place) { return polynomial(place).value; },
                           {kBox, kSpacing, -1e9, 1e9});
    for (int n = 0; n < 1000; ++n) {
      const Vec3 place = within(kBox, random);
      Jet jet;
      ASSERT_EQ(grid.evaluate(place, 3, jet), Region::band);
      EXPECT_LT(test::difference(jet, polynomial(place), 1), kRounding);
    }
  }
}

double sphere(const Vec3& place) { return (place - Vec3(0, 0.5, 0.5)).norm() - 0.4; }

TEST(BsplineGrid, ConvergesWithTheFourthOrderWhereTheFunctionIsSmooth) {
  const std::vector<double> spacings{0.04, 0.02, 0.01};
  std::vector<std::array<double, 4>> errors;
  for (double spacing : spacings) {
    const BsplineGrid grid(sphere, {kBox, spacing, -0.1, 0.1});
    test::Random random(2);
    std::array<double, 4>& error = errors.emplace_back();
    for (int n = 0; n < 2000; ++n) {
      const Vec3 normal = random.rotation().col(0);
      const double r = 0.4 + random.uniform(-0.1, 0.1);
      Jet jet;
      ASSERT_EQ(grid.evaluate(Vec3(0, 0.5, 0.5) + r * normal, 3, jet), Region::band);
      const Mat3 across = Mat3::Identity() - normal * normal.transpose();
      error[0] = std::max(error[0], std::abs(jet.value - (r - 0.4)));
      error[1] = std::max(error[1], (jet.gradient - normal).norm());
      error[2] = std::max(error[2], (jet.hessian - across / r).norm());
      for (int k = 0; k < 3; ++k) {
        const Mat3 third =
            -(normal[k] * across + normal * across.row(k) + across.col(k) * normal.transpose()) /
            (r * r);
        error[3] = std::max(error[3], (test::third_along(jet, k) - third).norm());
      }
    }
  }
  const double least_orders[] = {3.8, 3.8, 2.8, 1.8};  // degree four has two for the third
  for (int k = 0; k < 4; ++k) {
    for (std::size_t i = 1; i < errors.size(); ++i) {
      EXPECT_GT(std::log2(errors[i - 1][k] / errors[i][k]), least_orders[k]) << k << ' ' << i;
    }
  }
}

TEST(BsplineGrid, SaysWhereItEndsAndKeepsTheBandAlone) {
  const double spacing = 0.01;
  const BsplineGrid grid(sphere, {kBox, spacing, -0.05, 0.1});
  // The nodes of the whole box: 201 × 201 × 101.
  EXPECT_LT(grid.num_coefficients(), 201 * 201 * 101 / 4);
  test::Random random(3);
  int num_below = 0;
  int num_above = 0;
  for (int n = 0; n < 20000; ++n) {
    const Vec3 place = within({kBox.min() - Vec3::Ones(), kBox.max() + Vec3::Ones()}, random);
    Jet jet;
    jet.value = 7;
    const Region region = grid.evaluate(place, 3, jet);
    const double f = sphere(place);
    if (region == Region::band) {
      EXPECT_NEAR(jet.value, f, 1e-5) << place.transpose();
      continue;
    }
    EXPECT_EQ(jet.value, 7);
    if (region == Region::below) {
      EXPECT_LT(f, -0.05);
    } else {
      EXPECT_GT(f, 0.1);
    }
    ++(region == Region::below ? num_below : num_above);
  }
  EXPECT_GT(num_below, 10);
  EXPECT_GT(num_above, 10000);
  Jet jet;
  EXPECT_EQ(grid.evaluate(Vec3::Constant(std::nan("")), 3, jet), Region::above);
  EXPECT_EQ(grid.evaluate(Vec3::Constant(1e300), 3, jet), Region::above);
  EXPECT_EQ(grid.evaluate(Vec3(0, 0.5, 0.5), 3, jet), Region::below);
}

// The third derivative moves by no more than the fourth allows, over cells, bricks and kinks of f.
TEST(BsplineGrid, DoesNotJump) {
  const double spacing = 0.02;
  const auto kinked = [](const Vec3& place) {
    return (place - Vec3(0, 0.5, 0.5)).cwiseAbs().maxCoeff() - 0.3;
  };
  const BsplineGrid grid(kinked, {kBox, spacing, -0.1, 0.1});
  test::Random random(4);
  const double step = 1e-3 * spacing;
  // |∇⁴s| of the splines of a kink of unit slope, in units of h⁻³, with a margin of two.
  const double largest_fourth = 8;
  double largest = 0;
  for (int line = 0; line < 20; ++line) {
    const Vec3 direction = random.rotation().col(0);
    const Vec3 start = Vec3(0, 0.5, 0.5) + random.vector(3, 0.35);
    Jet before;
    bool in_band = grid.evaluate(start, 3, before) == Region::band;
    for (int n = 1; n < 3000; ++n) {
      Jet jet;
      const bool is_in = grid.evaluate(start + n * step * direction, 3, jet) == Region::band;
      if (in_band && is_in) {
        const double moved = test::difference(before, jet, spacing);
        EXPECT_LT(moved, largest_fourth * step / spacing);
        largest = std::max(largest, moved);
      }
      in_band = is_in;
      before = jet;
    }
  }
  EXPECT_GT(largest, 0.1 * largest_fourth * step / spacing) << "no kink was crossed";
}

TEST(BsplineGrid, RefusesAGridThatIsTooLarge) {
  for (double spacing : {1e-3, 1e-30}) {  // too many bricks in the band, too many along a side
    try {
      const BsplineGrid grid(sphere, {kBox, spacing, -1e9, 1e9});
      ADD_FAILURE() << "no error at " << spacing;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("too fine for a tool of this size"),
                std::string::npos);
    }
  }
}

}  // namespace
}  // namespace palpate::test::test_bspline_grid
