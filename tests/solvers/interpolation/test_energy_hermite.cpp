// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "interpolation/hermite_data.h"
#include "interpolation/interpolator.h"
#include "solvers/interpolation/analytic_space.h"
#include "solvers/interpolation/work.h"

namespace palpate::test::test_energy_hermite {
namespace {

using test::analytic_space;
using test::at;
using test::exponential;
using test::kHalfWidth;
using test::kUnit;
using test::monomial;

std::unique_ptr<Interpolator> hermite(const TouchToolSpace& tool_space,
                                      const InterpolationOptions& options = {}) {
  return make_interpolator(Method::energy_hermite, tool_space, options);
}

/// A space with a hole and a missing corner, so that every kind of stencil is in use.
TouchToolSpace holed_space() {
  TouchToolSpace tool_space = analytic_space(exponential);
  at(tool_space, {1, 1, 1}).outcome = Outcome::not_converged;
  at(tool_space, {3, 3, 3}).outcome = Outcome::not_converged;
  at(tool_space, {-3, -1, 2}).outcome = Outcome::not_converged;
  return tool_space;
}

TEST(EnergyHermite, ForceIsTheGradientOfTheEnergy) {
  const auto interpolator = hermite(holed_space());
  const double step = 1e-6;
  test::RandomPoints points(0.999 * kHalfWidth);
  int beside_holes = 0;
  for (int i = 0; i < 500; ++i) {
    const Vec3 t = points();
    const TouchResult r = interpolator->evaluate(t);
    beside_holes += r.support == Support::extrapolated ? 1 : 0;
    EXPECT_EQ(r.stiffness, r.stiffness.transpose());
    for (int a = 0; a < 3; ++a) {
      const Vec3 d = step * Vec3::Unit(a);
      const TouchResult high = interpolator->evaluate(t + d);
      const TouchResult low = interpolator->evaluate(t - d);
      EXPECT_NEAR((high.energy - low.energy) / (2 * step), r.force[a], 1e-6 * r.force.norm());
      EXPECT_LT(((high.force - low.force) / (2 * step) - r.stiffness.col(a)).norm(),
                1e-5 * r.stiffness.norm());
    }
  }
  EXPECT_GT(beside_holes, 15);
}

TEST(EnergyHermite, EnergyForceAndStiffnessAreContinuousAcrossCells) {
  const auto interpolator = hermite(holed_space());
  const double h = 2 * kHalfWidth / 6;
  test::RandomPoints points;
  for (int i = 0; i < 1000; ++i) {
    Vec3 t = points();
    const int axis = i % 3;
    t[axis] = h * (i % 5 - 2);
    // From the cells of both sides, at the same place to rounding.
    const Vec3 d = 1e-13 * Vec3::Unit(axis);
    const TouchResult a = interpolator->evaluate(t - d);
    const TouchResult b = interpolator->evaluate(t + d);
    EXPECT_NEAR(a.energy, b.energy, 1e-10 * std::abs(a.energy));
    EXPECT_LT((a.force - b.force).norm(), 1e-9 * a.force.norm());
    EXPECT_LT((a.stiffness - b.stiffness).norm(), 1e-8 * a.stiffness.norm());
  }
}

// Fifth-degree polynomials piece by piece: three Gauss points on each side of a cell's width are
// exact for the work along a line parallel to an axis.
TEST(EnergyHermite, NoWorkAroundAClosedLoop) {
  // Beside holes too.
  TouchToolSpace tool_space = analytic_space(exponential);
  at(tool_space, {1, 1, 0}).outcome = Outcome::not_converged;
  const auto interpolator = hermite(tool_space);
  const double h = 2 * kHalfWidth / 6;
  double size = 0;
  const auto work = [&](const Vec3& from, int axis, int cells) {
    return test::work_along(*interpolator, from, axis, cells, h, size);
  };
  const Vec3 start = h * Vec3(-2, -1, 0.3);
  const double loop = work(start, 0, 4) + work(start + h * Vec3(4, 0, 0), 1, 3) +
                      work(start + h * Vec3(4, 3, 0), 0, -4) +
                      work(start + h * Vec3(0, 3, 0), 1, -3);
  EXPECT_LT(std::abs(loop), 1e-14 * size);
}

double largest_force_error(const Interpolator& interpolator, const test::Energy& energy,
                           double half_width = kHalfWidth) {
  test::RandomPoints points(half_width);
  double error = 0;
  for (int i = 0; i < 400; ++i) {
    const Vec3 t = points();
    error = std::max(error, (interpolator.evaluate(t).force - energy(t).force).norm());
  }
  return error;
}

// The differences are exact up to degree 4 along their axis, the basis up to 5.
TEST(EnergyHermite, ReproducesTheMonomialsItShould) {
  for (int a = 0; a <= 6; ++a) {
    for (int b = 0; b <= 6; ++b) {
      for (int c = 0; c <= 6; ++c) {
        const int most = std::max({a, b, c});
        const bool exact = most <= 4 || (most == 5 && a + b + c <= 6);
        if (!exact && a + b + c > 8) continue;
        const test::Energy energy = monomial(a, b, c);
        const double scale = energy(Vec3::Constant(kHalfWidth)).force.norm() + 1;
        for (std::int32_t resolution : {5, 7}) {
          const double error =
              largest_force_error(*hermite(analytic_space(energy, resolution)), energy) / scale;
          if (exact) {
            EXPECT_LT(error, 1e-11) << a << b << c << " with " << resolution;
          } else {
            EXPECT_GT(error, 1e-8) << a << b << c << " with " << resolution;
          }
        }
      }
    }
  }
}

// Beside holes and with few points the differences lose degrees, but keep what those left can give:
// quadratic and, with three in a row, cubic energies.
TEST(EnergyHermite, ReproducesCubicEnergiesFromThreePointsInARow) {
  for (int a = 0; a <= 3; ++a) {
    for (int b = 0; a + b <= 3; ++b) {
      const test::Energy energy = monomial(a, b, 3 - a - b);
      const double scale = energy(Vec3::Constant(kHalfWidth)).force.norm() + 1;
      EXPECT_LT(largest_force_error(*hermite(analytic_space(energy, 3)), energy) / scale, 1e-12);
      TouchToolSpace holed = analytic_space(energy);
      at(holed, {0, 0, 0}).outcome = Outcome::not_converged;
      at(holed, {2, -1, 1}).outcome = Outcome::not_converged;
      const auto interpolator = hermite(holed);
      test::RandomPoints points;
      for (int i = 0; i < 300; ++i) {
        const Vec3 t = points();
        const TouchResult r = interpolator->evaluate(t);
        if (r.support != Support::inside) continue;
        EXPECT_LT((r.force - energy(t).force).norm() / scale, 1e-11) << a << b;
      }
    }
  }
}

// With third derivatives, of degree 5 along an axis too, but for what D^{211} and the like miss.
TEST(EnergyHermite, ReproducesTheMonomialsItShouldWithThirdDerivatives) {
  for (int a = 0; a <= 5; ++a) {
    for (int b = 0; b <= a; ++b) {
      for (int c = 0; c <= b; ++c) {
        const bool exact = a <= 4 || c == 0 || a + b + c <= 7;
        const test::Energy energy = monomial(a, b, c);
        TouchToolSpace tool_space = analytic_space(energy, 5);
        test::add_third_derivatives(tool_space, test::monomial_third(a, b, c));
        const double scale = energy(Vec3::Constant(kHalfWidth)).force.norm() + 1;
        const double error = largest_force_error(*hermite(tool_space), energy) / scale;
        if (exact) {
          EXPECT_LT(error, 1e-11) << a << b << c;
        } else {
          EXPECT_GT(error, 1e-8) << a << b << c;
        }
        // With three in a row: degree 3 from the third derivatives themselves.
        TouchToolSpace three = analytic_space(energy, 3);
        test::add_third_derivatives(three, test::monomial_third(a, b, c));
        if (a + b + c <= 5) {
          EXPECT_LT(largest_force_error(*hermite(three), energy) / scale, 1e-11) << a << b << c;
        }
      }
    }
  }
}

void spoil(TouchToolSpace& tool_space, const std::function<void(ConfigurationSummary&)>& one) {
  for (ConfigurationSummary& c : tool_space.configurations) {
    if (c.check_point[0] >= 2) one(c);
  }
}

void expect_good_beside_marked(const TouchToolSpace& tool_space, const test::Energy& energy) {
  const auto interpolator = hermite(tool_space);
  test::RandomPoints points;
  int num_inside = 0;
  for (int i = 0; i < 500; ++i) {
    const Vec3 t = points();
    const TouchResult touch = interpolator->evaluate(t);
    EXPECT_EQ(touch.support, t[0] > kHalfWidth / 3 ? Support::marked : Support::inside);
    if (touch.support != Support::inside) continue;
    ++num_inside;
    EXPECT_LE((touch.force - energy(t).force).norm(), 1e-11);
  }
  EXPECT_GT(num_inside, 200);
}

// What lies behind an inverted configuration, or one beyond a jump, is another matter: it must not
// leak into the cells before it by the differences.
TEST(EnergyHermite, CellsBeforeMarkedOnesAreAsGoodAsElsewhere) {
  const test::Energy energy = monomial(2, 2, 1);
  for (const Flags flag : {flags::inverted, flags::unstable, flags::near_fold}) {
    TouchToolSpace tool_space = analytic_space(energy, 7);
    spoil(tool_space, [&](ConfigurationSummary& c) {
      c.flags = flag;
      c.energy *= 3;
      c.force *= -2;
      c.stiffness *= 5;
    });
    expect_good_beside_marked(tool_space, energy);
  }
}

// Where the tangent is nearly singular, K and T are so large that they tell nothing of the cells
// around, whether or not a path has jumped there.
TEST(EnergyHermite, CellsBeforeSingularNodesAreAsGoodAsElsewhere) {
  const test::Energy energy = monomial(2, 2, 1);
  TouchToolSpace stiff = analytic_space(energy, 7);
  spoil(stiff, [](ConfigurationSummary& c) { c.stiffness.setConstant(1e6); });
  expect_good_beside_marked(stiff, energy);

  TouchToolSpace bent = analytic_space(energy, 7);
  add_third_derivatives(bent, monomial_third(2, 2, 1));
  spoil(bent, [](ConfigurationSummary& c) { c.third_derivative.setConstant(-1e9); });
  expect_good_beside_marked(bent, energy);
}

/// Root mean square of the force's error over that of the force.
double relative_error(const Interpolator& interpolator, double half_width) {
  test::RandomPoints points(half_width);
  double error = 0;
  double size = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 t = points();
    const Vec3 force = exponential(t).force;
    error += (interpolator.evaluate(t).force - force).squaredNorm();
    size += force.squaredNorm();
  }
  return std::sqrt(error / size);
}

// In the middle of the box, where the differences are central: the basis gives the force to the
// fifth order; the mixed derivatives, by differences of the fourth, keep that.
TEST(EnergyHermite, ConvergesFasterThanTrilinear) {
  std::vector<double> error;
  std::vector<double> linear_error;
  for (std::int32_t resolution : {9, 17, 33}) {
    const TouchToolSpace tool_space = analytic_space(exponential, resolution);
    error.push_back(relative_error(*hermite(tool_space), 0.5 * kHalfWidth));
    linear_error.push_back(
        relative_error(*make_interpolator(Method::trilinear, tool_space), 0.5 * kHalfWidth));
  }
  for (int i = 0; i < 2; ++i) {
    const double order = std::log2(error[i] / error[i + 1]);
    RecordProperty("order_" + std::to_string(i), std::to_string(order));
    EXPECT_GT(order, 4.7);
    EXPECT_NEAR(std::log2(linear_error[i] / linear_error[i + 1]), 2, 0.1);
  }
  const TouchToolSpace seven = analytic_space(exponential, 7);
  const double ratio = relative_error(*make_interpolator(Method::trilinear, seven), kHalfWidth) /
                       relative_error(*hermite(seven), kHalfWidth);
  RecordProperty("trilinear_over_hermite", std::to_string(ratio));
  EXPECT_GT(ratio, 30);
}

TEST(EnergyHermite, ThirdDerivativesAreUsedWhereTheyAreKnown) {
  TouchToolSpace tool_space = analytic_space(exponential);
  const double without = relative_error(*hermite(tool_space), kHalfWidth);
  test::add_third_derivatives(tool_space, test::exponential_third);
  InterpolationOptions not_used;
  not_used.third_derivatives = false;
  EXPECT_EQ(relative_error(*hermite(tool_space, not_used), kHalfWidth), without);
  EXPECT_LT(relative_error(*hermite(tool_space), kHalfWidth), 0.7 * without);
  const std::vector<HermiteNode> data =
      hermite_data(CheckPointGrid(tool_space), tool_space.configurations);
  const ConfigurationSummary& c = tool_space.configurations[100];
  const double* d = data[100].of;
  const double h3 = std::pow(tool_space.setup.grid.spacing(), 3);
  EXPECT_DOUBLE_EQ(d[hermite_index(2, 1, 0)], h3 * c.third_derivative[1]);
  EXPECT_DOUBLE_EQ(d[hermite_index(1, 1, 1)], h3 * c.third_derivative[4]);
  EXPECT_DOUBLE_EQ(d[hermite_index(0, 1, 2)], h3 * c.third_derivative[8]);
  // Of some nodes alone: the others have differences.
  for (std::size_t i = 0; i < tool_space.configurations.size(); i += 2) {
    tool_space.configurations[i].third_derivative[3] = std::nan("");
  }
  const double half = relative_error(*hermite(tool_space), kHalfWidth);
  EXPECT_LT(half, without);
}

/// exponential() without the force at rest.
test::Sample at_rest_without_force(const Vec3& t) {
  test::Sample s = exponential(t);
  const Vec3 force = exponential(Vec3::Zero()).force;
  s.energy -= force.dot(t);
  s.force -= force;
  return s;
}

TEST(EnergyHermite, IsRelativelyExactNearRest) {
  const auto interpolator = hermite(analytic_space(at_rest_without_force));
  test::RandomPoints points(0.01 * kHalfWidth);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 t = points();
    const Vec3 exact = at_rest_without_force(t).force;
    EXPECT_LT((interpolator->evaluate(t).force - exact).norm(), 1e-3 * exact.norm());
  }
}

TEST(EnergyHermite, MixedDerivativesVanishWithoutNeighbours) {
  const TouchToolSpace one = analytic_space(exponential, 1);
  const std::vector<HermiteNode> data = hermite_data(CheckPointGrid(one), one.configurations);
  ASSERT_EQ(data.size(), 1U);
  const double* d = data[0].of;
  EXPECT_EQ(d[hermite_index(0, 0, 0)], one.configurations[0].energy);
  EXPECT_EQ(d[hermite_index(1, 1, 1)], 0);
  EXPECT_EQ(d[hermite_index(2, 2, 2)], 0);
}

}  // namespace
}  // namespace palpate::test::test_energy_hermite
