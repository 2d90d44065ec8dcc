// SPDX-License-Identifier: BSD-3-Clause
// What holds for every method.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "base/error.h"
#include "interpolation/interpolator.h"
#include "solvers/interpolation/analytic_space.h"
#include "solvers/interpolation/methods.h"

namespace palpate::test::test_interpolators {
namespace {

using test::analytic_space;
using test::at;
using test::exponential;
using test::kHalfWidth;

class AnyMethod : public testing::TestWithParam<Method> {
 protected:
  [[nodiscard]] static std::unique_ptr<Interpolator> make(const TouchToolSpace& tool_space) {
    return make_interpolator(GetParam(), tool_space);
  }
};

/// What a dense system leaves at a check-point, as a share of the values: rounding times its
/// condition.
double rounding(Method method) {
  if (method == Method::rbf_linear) return 1e-13;
  return method == Method::rbf_cubic ? 1e-11 : 0;
}

bool is_finite(const TouchResult& r) {
  return std::isfinite(r.energy) && r.force.allFinite() && r.stiffness.allFinite();
}

TEST_P(AnyMethod, IsExactAtTheCheckPoints) {
  const TouchToolSpace tool_space = analytic_space(exponential);
  const auto interpolator = make(tool_space);
  for (const ConfigurationSummary& c : tool_space.configurations) {
    const TouchResult r = interpolator->evaluate(c.t);
    EXPECT_EQ(r.support, Support::inside);
    EXPECT_NEAR(r.energy, c.energy, (1e-13 + rounding(GetParam())) * std::abs(c.energy));
    EXPECT_LT((r.force - c.force).norm(), (1e-12 + rounding(GetParam())) * (1 + c.force.norm()));
  }
}

TEST_P(AnyMethod, RestGivesTheStoredForce) {
  TouchToolSpace tool_space = analytic_space([](const Vec3& t) {
    test::Sample s = exponential(t);
    s.force = 100 * t;
    s.energy = 50 * t.squaredNorm();
    return s;
  });
  at(tool_space, {0, 0, 0}).force.setZero();
  EXPECT_LE(make(tool_space)->evaluate(Vec3::Zero()).force.norm(), rounding(GetParam()));
}

TEST_P(AnyMethod, StiffnessIsTheGradientOfTheForce) {
  const auto interpolator = make(analytic_space(exponential));
  const double step = 1e-7;
  test::RandomPoints points;
  for (int i = 0; i < 300; ++i) {
    const Vec3 t = points();
    const TouchResult r = interpolator->evaluate(t);
    for (int a = 0; a < 3; ++a) {
      const Vec3 d = step * Vec3::Unit(a);
      const Vec3 slope =
          (interpolator->evaluate(t + d).force - interpolator->evaluate(t - d).force) / (2 * step);
      EXPECT_LT((slope - r.stiffness.col(a)).norm(), 1e-6 * (1 + r.stiffness.norm()));
    }
  }
}

TEST_P(AnyMethod, ForceIsContinuousAcrossCellsAndAtTheBorder) {
  const auto interpolator = make(analytic_space(exponential));
  const double h = 2 * kHalfWidth / 6;
  test::RandomPoints points(1.6 * kHalfWidth);
  for (int i = 0; i < 500; ++i) {
    Vec3 t = points();
    const int axis = i % 3;
    t[axis] = h * (i % 7 - 3);  // a side of cells, the border of the box for ±3
    const Vec3 d = 1e-10 * Vec3::Unit(axis);
    const TouchResult before = interpolator->evaluate(t - d);
    const TouchResult after = interpolator->evaluate(t + d);
    const double jump = 4e-10 * (before.stiffness.norm() + after.stiffness.norm());
    EXPECT_LT((after.force - before.force).norm(), jump + 1e-9 * before.force.norm());
    EXPECT_NEAR(after.energy, before.energy,
                4e-10 * before.force.norm() + 1e-9 * std::abs(before.energy));
  }
}

TEST_P(AnyMethod, OutsideTheForceFollowsTheStiffness) {
  const auto interpolator = make(analytic_space(exponential));
  const Vec3 border(kHalfWidth, 0.003, -0.001);
  const TouchResult at_border = interpolator->evaluate(border);
  EXPECT_EQ(at_border.support, Support::inside);
  const TouchResult out = interpolator->evaluate(border + Vec3(0.004, 0, 0));
  EXPECT_EQ(out.support, Support::extrapolated);
  EXPECT_LT((out.force - at_border.force - out.stiffness * Vec3(0.004, 0, 0)).norm(), 1e-9);
  EXPECT_GT((out.stiffness * Vec3(0.004, 0, 0)).x(), 0);
}

// Configurations that were never computed: beyond the force limit nothing is expanded.
TEST_P(AnyMethod, MissingCheckPointsAreLikeFailedOnes) {
  TouchToolSpace tool_space = analytic_space(exponential);
  TouchToolSpace failed = tool_space;
  tool_space.configurations.clear();
  for (ConfigurationSummary& c : failed.configurations) {
    if (c.t.norm() < 0.01) {
      tool_space.configurations.push_back(c);
    } else {
      c.outcome = Outcome::budget_used_up;
    }
  }
  const auto a = make(tool_space);
  const auto b = make(failed);
  test::RandomPoints points(1.5 * kHalfWidth);
  int inside = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 t = points();
    const TouchResult r = a->evaluate(t);
    EXPECT_EQ(r.support, b->evaluate(t).support);
    EXPECT_EQ(r.force, b->evaluate(t).force);
    EXPECT_TRUE(is_finite(r));
    inside += r.support == Support::inside ? 1 : 0;
  }
  EXPECT_GT(inside, 20);
}

TEST_P(AnyMethod, MarkedRegionIsInterpolatedAndSaidSo) {
  TouchToolSpace tool_space = analytic_space(exponential);
  const TouchResult plain = make(tool_space)->evaluate(Vec3(0.005, 0.005, 0.005));
  at(tool_space, {1, 1, 1}).flags = flags::inverted;
  const TouchResult marked = make(tool_space)->evaluate(Vec3(0.005, 0.005, 0.005));
  EXPECT_EQ(plain.support, Support::inside);
  EXPECT_EQ(marked.support, Support::marked);
  // The differences of Energy Hermite at the other corners do without the one that is marked.
  const double change = GetParam() == Method::energy_hermite ? 1e-3 : 0;
  EXPECT_LE((plain.force - marked.force).norm(), change * plain.force.norm());
}

TEST_P(AnyMethod, SmallGrids) {
  const TouchToolSpace one = analytic_space(exponential, 1);
  const TouchResult r = make(one)->evaluate(Vec3(0.001, 0, 0));
  EXPECT_EQ(r.support, Support::extrapolated);
  EXPECT_LT(
      (r.force - one.configurations[0].force - one.configurations[0].stiffness * Vec3(0.001, 0, 0))
          .norm(),
      1e-9);
  const TouchToolSpace three = analytic_space(exponential, 3);
  const auto interpolator = make(three);
  for (const ConfigurationSummary& c : three.configurations) {
    EXPECT_LT((interpolator->evaluate(c.t).force - c.force).norm(), 1e-12 * c.force.norm());
  }
}

TEST_P(AnyMethod, BadInputFindsNothing) {
  const auto interpolator = make(analytic_space(exponential));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const Vec3& t : {Vec3(nan, 0, 0), Vec3(0, infinity, 0), Vec3(0, 0, -infinity)}) {
    const TouchResult r = interpolator->evaluate(t);
    EXPECT_EQ(r.support, Support::none);
    EXPECT_TRUE(r.force.isZero(0));
  }
  for (double far : {1.0, 1e10, 1e100, 1e150, 1e200, 1e307}) {
    const TouchResult r = interpolator->evaluate(Vec3(far, -far, far));
    EXPECT_TRUE(is_finite(r)) << far;
  }
}

TEST_P(AnyMethod, NothingUsableFindsNothing) {
  TouchToolSpace tool_space = analytic_space(exponential, 3);
  for (ConfigurationSummary& c : tool_space.configurations) c.outcome = Outcome::not_converged;
  EXPECT_EQ(make(tool_space)->evaluate(Vec3::Zero()).support, Support::none);
  tool_space.configurations.clear();
  EXPECT_EQ(make(tool_space)->evaluate(Vec3::Zero()).support, Support::none);
}

TEST_P(AnyMethod, OutlivesItsToolSpace) {
  auto tool_space = std::make_unique<TouchToolSpace>(analytic_space(exponential));
  const auto interpolator = make(*tool_space);
  const TouchResult before = interpolator->evaluate(Vec3(0.001, 0.002, 0.003));
  tool_space.reset();
  EXPECT_EQ(interpolator->evaluate(Vec3(0.001, 0.002, 0.003)).force, before.force);
}

INSTANTIATE_TEST_SUITE_P(, AnyMethod, testing::ValuesIn(test::interpolating_methods()),
                         test::name_of_method);

TEST(Trilinear, ReproducesTrilinearForcesAndItsStiffnessIsNotSymmetrised) {
  TouchToolSpace tool_space = analytic_space(exponential);
  Mat3 a;
  a << 1, 2, 3, 4, 5, 6, 7, 8, 10;
  const auto force = [&](const Vec3& t) {
    return Vec3(a * t + 1e4 * t.x() * t.y() * t.z() * Vec3(1, -1, 2));
  };
  for (ConfigurationSummary& c : tool_space.configurations) c.force = force(c.t);
  const auto interpolator = make_interpolator(Method::trilinear, tool_space);
  test::RandomPoints points;
  for (int i = 0; i < 100; ++i) {
    const Vec3 t = points();
    EXPECT_LT((interpolator->evaluate(t).force - force(t)).norm(), 1e-15);
  }
  EXPECT_LT((interpolator->evaluate(Vec3::Zero()).stiffness - a).norm(), 1e-12);
}

struct Known {
  Method method;
  Vec3 t;
  Vec3 force;
  double energy;
  double stiffness_xy;
  Support support;
};

// Results for a uniform grid with holes, which the sizes of cells must not change.
TEST(UniformGrid, GivesTheKnownResults) {
  TouchToolSpace tool_space = analytic_space(exponential);
  at(tool_space, {1, 1, 1}).outcome = Outcome::not_converged;
  at(tool_space, {3, 3, 3}).outcome = Outcome::not_converged;
  at(tool_space, {-3, -1, 2}).outcome = Outcome::not_converged;
  const std::vector<Known> known = {
      {Method::trilinear, Vec3(0.001, -0.002, 0.003),
       Vec3(36.615625308585138, -31.976853638896777, 77.533254020550331), 1.2965597849934671,
       423.12790918006948, Support::inside},
      {Method::trilinear, Vec3(-0.0101, 0.0087, -0.0113),
       Vec3(0.53724739433581981, -2.4665515257042423, -12.057399112985383), 0.69802487622894582,
       716.90556820956931, Support::inside},
      {Method::trilinear, Vec3(0.0071, 0.0014, -0.0052),
       Vec3(122.08973549171323, -19.658730782128384, -20.966986382688631), 1.4247161523046241,
       125.05018540740126, Support::inside},
      {Method::trilinear, Vec3(0.0135, -0.004, 0.0002),
       Vec3(288.28028823826247, -72.097926766639304, 24.97146256431656), 2.7763988842303062,
       -4059.9781582606547, Support::extrapolated},
      {Method::energy_hermite, Vec3(0.001, -0.002, 0.003),
       Vec3(34.963743325684973, -30.589765316691306, 73.662000083796855), 1.2485768901283576,
       392.5311731434889, Support::inside},
      {Method::energy_hermite, Vec3(-0.0101, 0.0087, -0.0113),
       Vec3(0.47429480261729218, -2.4140503795697268, -11.653916649303785), 0.67937403319062328,
       677.95647803198074, Support::inside},
      {Method::energy_hermite, Vec3(0.0071, 0.0014, -0.0052),
       Vec3(115.55307252832276, -18.757369914974973, -18.75361739881361), 1.3690937000063654,
       -212.6247802987256, Support::inside},
      {Method::energy_hermite, Vec3(0.0135, -0.004, 0.0002),
       Vec3(287.44821931323992, -71.941066766376792, 24.481330633209854), 2.7674008000477008,
       -4051.3889138833965, Support::extrapolated},
  };
  for (const Known& k : known) {
    const TouchResult r = make_interpolator(k.method, tool_space)->evaluate(k.t);
    // The order of the sums is the compiler's.
    constexpr double kRounding = 1e-14;
    EXPECT_NEAR(r.energy, k.energy, kRounding * std::abs(k.energy));
    EXPECT_LT((r.force - k.force).norm(), kRounding * k.force.norm());
    EXPECT_NEAR(r.stiffness(0, 1), k.stiffness_xy, kRounding * r.stiffness.norm());
    EXPECT_EQ(r.support, k.support);
  }
}

TEST(Tricubic, ReproducesCubicForces) {
  for (std::int32_t resolution : {5, 7, 9}) {
    TouchToolSpace tool_space = analytic_space(exponential, resolution);
    const auto force = [](const Vec3& t) {
      const Vec3 x = t / kHalfWidth;
      const double p = x.x() * x.x() * x.x() - 2 * x.y() * x.y() * x.z() + x.z();
      return Vec3(p, std::pow(x.x() * x.y() * x.z(), 3) + 1, std::pow(x.z(), 3) * x.x() * x.x());
    };
    for (ConfigurationSummary& c : tool_space.configurations) c.force = force(c.t);
    const auto interpolator = make_interpolator(Method::tricubic, tool_space);
    test::RandomPoints points;
    for (int i = 0; i < 300; ++i) {
      const Vec3 t = points();
      EXPECT_LT((interpolator->evaluate(t).force - force(t)).norm(), 1e-13);
    }
  }
  // Of three check-points an axis, quadratic ones.
  TouchToolSpace three = analytic_space(exponential, 3);
  const auto force = [](const Vec3& t) { return Vec3(1e4 * t.cwiseProduct(t) + t); };
  for (ConfigurationSummary& c : three.configurations) c.force = force(c.t);
  const auto interpolator = make_interpolator(Method::tricubic, three);
  test::RandomPoints points;
  for (int i = 0; i < 100; ++i) {
    const Vec3 t = points();
    EXPECT_LT((interpolator->evaluate(t).force - force(t)).norm(), 1e-14);
  }
}

/// The polynomial along an axis, from its definition.
double lagrange(const std::vector<double>& nodes, std::size_t j, double x) {
  double product = 1;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (i != j) product *= (x - nodes[i]) / (nodes[j] - nodes[i]);
  }
  return product;
}

// Random data, and the sum over 64 products as it is written in a book.
TEST(Tricubic, AgreesWithTheTensorProductWrittenOut) {
  TouchToolSpace tool_space = analytic_space(exponential, 7);
  std::mt19937 random(8);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (ConfigurationSummary& c : tool_space.configurations) {
    c.energy = uniform(random);
    for (int k = 0; k < 3; ++k) c.force[k] = uniform(random);
  }
  const auto interpolator = make_interpolator(Method::tricubic, tool_space);
  const double h = tool_space.setup.grid.spacing();
  test::RandomPoints points;
  for (int n = 0; n < 200; ++n) {
    const Vec3 t = points();
    std::array<std::vector<double>, 3> nodes;
    std::array<int, 3> first{};
    for (int k = 0; k < 3; ++k) {
      const int cell = static_cast<int>(std::floor(t[k] / h));
      first[k] = std::min(std::max(cell - 1, -3), 0);
      for (int i = 0; i < 4; ++i) nodes[k].push_back(h * (first[k] + i));
    }
    Vec3 force = Vec3::Zero();
    double energy = 0;
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < 4; ++j) {
        for (int k = 0; k < 4; ++k) {
          const double weight = lagrange(nodes[0], i, t.x()) * lagrange(nodes[1], j, t.y()) *
                                lagrange(nodes[2], k, t.z());
          const ConfigurationSummary& c =
              at(tool_space, {first[0] + i, first[1] + j, first[2] + k});
          force += weight * c.force;
          energy += weight * c.energy;
        }
      }
    }
    const TouchResult r = interpolator->evaluate(t);
    EXPECT_LT((r.force - force).norm(), 1e-13);
    EXPECT_NEAR(r.energy, energy, 1e-13);
  }
}

TEST(Tricubic, RefusesCellsOfDifferentSize) {
  try {
    (void)make_interpolator(Method::tricubic, test::graded_space(exponential));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("'Energy Hermite'"), std::string::npos);
  }
}

TEST(Linear, IsTheStiffnessAtRest) {
  TouchToolSpace tool_space = analytic_space(exponential);
  const Mat3 k = at(tool_space, {0, 0, 0}).stiffness;
  for (std::int32_t resolution : {7, 1}) {
    const auto interpolator =
        make_interpolator(Method::linear, analytic_space(exponential, resolution));
    EXPECT_EQ(interpolator->num_samples(), 1U);
    test::RandomPoints points(2 * kHalfWidth);
    for (int i = 0; i < 100; ++i) {
      const Vec3 t = points();
      const TouchResult r = interpolator->evaluate(t);
      EXPECT_LT((r.force - k * t).norm(), 1e-12);
      EXPECT_LT((r.stiffness - k).norm(), 1e-9);
      EXPECT_NEAR(r.energy, 0.5 * t.dot(k * t), 1e-13);
      const bool inside = resolution > 1 && t.lpNorm<Eigen::Infinity>() <= kHalfWidth;
      EXPECT_EQ(r.support, inside ? Support::inside : Support::extrapolated);
    }
  }
  at(tool_space, {0, 0, 0}).outcome = Outcome::not_converged;
  EXPECT_THROW((void)make_interpolator(Method::linear, tool_space), InputError);
}

TEST(MakeInterpolator, KnowsItsMethods) {
  std::string names;
  for (Method method : all_methods()) {
    names += to_string(method) + ' ';
    const auto interpolator = make_interpolator(method, analytic_space(exponential, 3));
    EXPECT_GT(interpolator->bytes(), 100U);
    EXPECT_EQ(interpolator->num_samples(), method == Method::linear ? 1U : 27U);
  }
  EXPECT_EQ(names, "Trilinear Tricubic RBF linear RBF cubic Energy Hermite Linear ");
  try {
    (void)make_interpolator(static_cast<Method>(9), analytic_space(exponential, 3));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("'RBF cubic'"), std::string::npos);
  }
}

}  // namespace
}  // namespace palpate::test::test_interpolators
