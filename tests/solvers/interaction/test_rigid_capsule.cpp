// SPDX-License-Identifier: BSD-3-Clause
#include "interaction/rigid_capsule.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "base/error.h"
#include "solvers/interaction/jets.h"
#include "solvers/support/random.h"

namespace palpate::test::test_rigid_capsule {
namespace {

constexpr double kRadius = 0.008;
/// Of a few operations on numbers of size 1.
constexpr double kRounding = 1e-13;
/// Of differences with a step of a hundredth of the radius, relative: their own error of about
/// (step/radius)⁶ times the seventh derivative, and rounding.
constexpr double kDifferences = 1e-8;
/// The same across a seam, where the fourth derivative jumps: half a step times the jump, which is
/// 60 in units of the radius where the seam is as wide as that.
constexpr double kDifferencesOfSeam = 0.02;

/// The distance to the true capsule.
double distance(const Capsule& capsule, const Vec3& y) {
  const Vec3 axis = capsule.axis.normalized();
  const double s = std::clamp(axis.dot(y), -capsule.length / 2, capsule.length / 2);
  return (y - s * axis).norm() - capsule.radius;
}

Vec3 on_unit_sphere(test::Random& random) { return random.rotation().col(0); }

/// A place around the capsule at a distance from its surface.
Vec3 place_at(const Capsule& capsule, double distance, test::Random& random) {
  const Vec3 axis = capsule.axis.normalized();
  const Vec3 n = on_unit_sphere(random);
  const double s = random.uniform(-1, 1) * capsule.length / 2;
  const bool cap = random.uniform(0, 1) < 0.5;
  const Vec3 across = (n - axis.dot(n) * axis).normalized();
  return cap ? Vec3(std::copysign(capsule.length / 2, axis.dot(n)) * axis +
                    (capsule.radius + distance) * n)
             : Vec3(s * axis + (capsule.radius + distance) * across);
}

TEST(RigidSphere, IsTheClosedForm) {
  const RigidShapePtr sphere = make_sphere(kRadius);
  EXPECT_EQ(sphere->error(), 0);
  EXPECT_EQ(sphere->bounding_radius(), kRadius);
  EXPECT_EQ(sphere->bounds().min(), Vec3(Vec3::Constant(-kRadius)));
  EXPECT_EQ(sphere->bounds().max(), Vec3(Vec3::Constant(kRadius)));
  test::Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const double r = kRadius * random.uniform(0.2, 3);
    const Vec3 n = on_unit_sphere(random);
    const test::Jet jet = sphere->evaluate(r * n);
    EXPECT_NEAR(jet.value, r - kRadius, kRounding * kRadius);
    EXPECT_LT((jet.gradient - n).norm(), kRounding);
    const Mat3 across = Mat3::Identity() - n * n.transpose();
    EXPECT_LT((jet.hessian - across / r).norm() * r, kRounding);
    for (int k = 0; k < 3; ++k) {
      const Mat3 expected = -(n[k] * across + n * across.row(k) + across.col(k) * n.transpose());
      EXPECT_LT((test::third_along(jet, k) * r * r - expected).norm(), kRounding);
    }
  }
}

TEST(RigidSphere, IsSmoothThroughItsCentre) {
  const RigidShapePtr sphere = make_sphere(kRadius);
  const test::Jet centre = sphere->evaluate(Vec3::Zero());
  EXPECT_TRUE(test::all_finite(centre));
  EXPECT_EQ(centre.gradient, Vec3(Vec3::Zero()));
  EXPECT_LT(centre.value, -0.9 * kRadius);
  test::Random random(2);
  for (int i = 0; i < 300; ++i) {
    const Vec3 n = on_unit_sphere(random);
    const Vec3 place = 0.09 * random.uniform(0, 1) * kRadius * n;
    test::expect_consistent(*sphere, place, 1e-4 * kRadius, kRadius, 1e-6);
    EXPECT_GT(sphere->evaluate(place).gradient.dot(n), 0) << "does not lead out";
    // The border of the core.
    const test::Jet below = sphere->evaluate(0.1 * (1 - 1e-12) * kRadius * n);
    const test::Jet above = sphere->evaluate(0.1 * (1 + 1e-12) * kRadius * n);
    EXPECT_LT(test::difference(below, above, kRadius), 1e-8);
  }
}

TEST(RigidCapsule, WithoutALengthIsTheSphere) {
  const RigidShapePtr sphere = make_sphere(kRadius);
  test::Random random(3);
  for (double length : {0.0, 1e-14 * kRadius}) {
    const RigidShapePtr capsule = make_capsule({kRadius, length, Vec3(1, 2, 3)});
    EXPECT_LT(capsule->error(), 1e-13 * kRadius);
    for (int i = 0; i < 300; ++i) {
      const Vec3 place = 2 * kRadius * random.uniform(0.1, 1) * on_unit_sphere(random);
      EXPECT_LT(test::difference(sphere->evaluate(place), capsule->evaluate(place), kRadius), 1e-9);
    }
  }
}

class RigidCapsules : public testing::TestWithParam<Capsule> {};

TEST_P(RigidCapsules, DerivativesAreThoseOfTheValue) {
  const Capsule capsule = GetParam();
  const RigidShapePtr shape = make_capsule(capsule);
  test::Random random(4);
  const Vec3 axis = capsule.axis.normalized();
  const double half_width = capsule.seam * kRadius / 2;
  const double step = 0.01 * kRadius * capsule.seam;
  for (int i = 0; i < 1000; ++i) {
    const Vec3 place = place_at(capsule, random.uniform(-0.25, 0.5) * kRadius, random);
    bool smooth = true;
    for (double end : {-1, 1}) {
      const double beyond = std::abs(end * axis.dot(place) - capsule.length / 2);
      smooth &= std::abs(beyond - half_width) > step;
    }
    test::expect_consistent(*shape, place, step, kRadius,
                            smooth ? kDifferences / (capsule.seam * capsule.seam)
                                   : kDifferencesOfSeam / (capsule.seam * capsule.seam));
    test::expect_orders_agree(*shape, place);
  }
}

TEST_P(RigidCapsules, DoNotJump) {
  const Capsule capsule = GetParam();
  const RigidShapePtr shape = make_capsule(capsule);
  test::Random random(5);
  const Vec3 axis = capsule.axis.normalized();
  for (int i = 0; i < 300; ++i) {
    const Vec3 n = on_unit_sphere(random);
    const Vec3 across = kRadius * random.uniform(0.8, 1.3) * (n - axis.dot(n) * axis).normalized();
    for (double border : {-1, 1}) {
      const double s = capsule.length / 2 + border * capsule.seam * kRadius / 2;
      const double h = 1e-9 * kRadius;
      const test::Jet below = shape->evaluate(across + (s - h) * axis);
      const test::Jet above = shape->evaluate(across + (s + h) * axis);
      EXPECT_LT(test::difference(below, above, kRadius), 1e-5);
    }
  }
}

TEST_P(RigidCapsules, StateTheirError) {
  const Capsule capsule = GetParam();
  const RigidShapePtr shape = make_capsule(capsule);
  test::Random random(6);
  double largest = 0;
  for (int i = 0; i < 100000; ++i) {
    const Vec3 place = place_at(capsule, random.uniform(-shape->depth(), 0.5 * kRadius), random);
    const double error = shape->value(place) - distance(capsule, place);
    EXPECT_GT(error, -kRounding * kRadius) << "nearer than it is";
    largest = std::max(largest, error);
  }
  EXPECT_LE(largest, shape->error());
  EXPECT_GT(largest, 0.9 * shape->error()) << "the error is stated too large";
  EXPECT_LT(shape->error(), 0.0061 * capsule.seam * capsule.seam * kRadius);
}

TEST_P(RigidCapsules, AreExactAwayFromTheSeam) {
  const Capsule capsule = GetParam();
  const RigidShapePtr shape = make_capsule(capsule);
  const RigidShapePtr sphere = make_sphere(kRadius);
  const Vec3 axis = capsule.axis.normalized();
  test::Random random(7);
  for (int i = 0; i < 300; ++i) {
    const Vec3 n = on_unit_sphere(random);
    const Vec3 across = (n - axis.dot(n) * axis).normalized();
    const double seam = capsule.seam * kRadius / 2;
    const Vec3 of_cap = across * kRadius + (seam + random.uniform(0, 1) * kRadius) * axis;
    if (capsule.length > 2 * seam) {
      EXPECT_LT(test::difference(shape->evaluate(of_cap + capsule.length / 2 * axis),
                                 sphere->evaluate(of_cap), kRadius),
                1e-12);
      const double s = random.uniform(-1, 1) * (capsule.length / 2 - seam);
      const test::Jet jet = shape->evaluate(s * axis + 1.1 * kRadius * across);
      EXPECT_NEAR(jet.value, 0.1 * kRadius, 1e-12 * kRadius);
      EXPECT_LT((jet.gradient - across).norm(), 1e-12);
      EXPECT_LT((jet.hessian * axis).norm() * kRadius, 1e-12);
    }
  }
}

TEST_P(RigidCapsules, AreFiniteEverywhere) {
  const Capsule capsule = GetParam();
  const RigidShapePtr shape = make_capsule(capsule);
  for (double s : {-2.0, -0.5, 0.0, 0.3, 0.5, 1.0, 1e9}) {
    for (double across : {0.0, 1e-200, 1e-9, 0.5, 1e9}) {
      const Vec3 place = s * capsule.length * capsule.axis.normalized() +
                         across * kRadius * capsule.axis.unitOrthogonal();
      EXPECT_TRUE(test::all_finite(shape->evaluate(place))) << place.transpose();
    }
  }
  EXPECT_FALSE(std::isfinite(shape->value(Vec3(0, std::nan(""), 0))));
}

TEST_P(RigidCapsules, NothingInABoxIsBelowItsBound) {
  const Capsule capsule = GetParam();
  const RigidShapePtr shape = make_capsule(capsule);
  std::mt19937 random(12);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto anywhere = [&] { return Vec3(unit(random), unit(random), unit(random)); };
  const double size = capsule.radius + capsule.length;
  double nearest = std::numeric_limits<double>::infinity();
  for (int n = 0; n < 500; ++n) {
    const Vec3 centre = 1.5 * size * anywhere();
    const Vec3 half = 0.3 * size * anywhere().cwiseAbs();
    const Mat3 axes =
        Eigen::AngleAxisd(3 * unit(random), anywhere().normalized()).toRotationMatrix();
    const double bound = shape->least_in_box(centre, axes, half) - 2 * shape->error();
    for (int i = 0; i < 50; ++i) {
      const double there = shape->value(centre + axes * half.cwiseProduct(anywhere()));
      EXPECT_GE(there, bound - 1e-12 * size);
      nearest = std::min(nearest, there - bound);
    }
  }
  // It is no looser than it has to be.
  EXPECT_LT(nearest, 0.02 * size);
}

TEST_P(RigidCapsules, BoundsHoldTheSurface) {
  const Capsule capsule = GetParam();
  const RigidShapePtr shape = make_capsule(capsule);
  test::Random random(8);
  Eigen::AlignedBox3d box;
  double farthest = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec3 place = place_at(capsule, 0, random);
    box.extend(place);
    farthest = std::max(farthest, place.norm());
  }
  const double slack = 0.01 * kRadius;  // what random places leave out
  EXPECT_TRUE((box.min() - shape->bounds().min()).minCoeff() > -kRounding);
  EXPECT_TRUE((shape->bounds().max() - box.max()).minCoeff() > -kRounding);
  EXPECT_LT((box.sizes() - shape->bounds().sizes()).cwiseAbs().maxCoeff(), slack);
  EXPECT_LT(farthest, shape->bounding_radius() + kRounding);
  EXPECT_GT(farthest, shape->bounding_radius() - slack);
}

std::string name_of(const testing::TestParamInfo<Capsule>& info) {
  const char* kNames[] = {"Long", "Short", "OfTheWidthOfItsSeam", "NarrowSeam", "WideSeam"};
  return kNames[info.index];
}

INSTANTIATE_TEST_SUITE_P(All, RigidCapsules,
                         testing::Values(Capsule{kRadius, 4 * kRadius, Vec3(0.3, -2, 1)},
                                         Capsule{kRadius, 0.3 * kRadius, Vec3(1, 1, 0)},
                                         Capsule{kRadius, kRadius, Vec3(0, 0, -3)},
                                         Capsule{kRadius, 2 * kRadius, Vec3(1, 0, 0), 0.25},
                                         Capsule{kRadius, 6 * kRadius, Vec3(1, 2, -3), 2}),
                         name_of);

void expect_message(const Capsule& capsule, const std::string& part) {
  try {
    (void)make_capsule(capsule);
    ADD_FAILURE() << "no error: " << part;
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
  }
}

TEST(RigidCapsule, BadInput) {
  const double nan = std::nan("");
  const double infinity = std::numeric_limits<double>::infinity();
  for (double bad : {0.0, -1.0, nan, infinity}) {
    EXPECT_THROW((void)make_sphere(bad), InputError);
    expect_message({bad, 0.01}, "radius of the tool");
    expect_message({kRadius, 0.01, Vec3::UnitX(), bad}, "seam of the tool");
  }
  for (double bad : {-1.0, nan, infinity}) expect_message({kRadius, bad}, "length of the tool");
  for (double bad : {0.0, nan, infinity}) {
    expect_message({kRadius, 0.01, Vec3(bad, 0, 0)}, "axis of the tool");
  }
}

TEST(RigidCapsule, SaysWhatItIs) {
  EXPECT_EQ(make_sphere(0.01)->description(), "a sphere of radius 0.01 m");
  EXPECT_EQ(make_capsule({0.005, 0.03})->description(),
            "a capsule of radius 0.005 m and length 0.03 m");
}

}  // namespace
}  // namespace palpate::test::test_rigid_capsule
