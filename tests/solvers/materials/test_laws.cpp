// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <vector>

#include "solvers/materials/point.h"
#include "solvers/support/finite_difference.h"
#include "solvers/support/laws.h"
#include "solvers/support/random.h"

namespace palpate::test::test_laws {
namespace {

/// A law is some hundred operations; det F as small as 0.3 and stretches near 3 amplify their
/// rounding by about a hundred.
constexpr double kRounding = 1e-12;
/// Steps of 1e-2 of the least stretch, extrapolated to O(h⁶), leave 1e-11 of the derivative.
constexpr double kDifference = 1e-9;

class Laws : public testing::TestWithParam<Law> {
 protected:
  Material material() const { return make_material(GetParam(), 3000, 0.35); }

  /// Displacement gradients with det F from 0.3 to 2 and stretches that differ by a factor of up
  /// to e^1.2.
  static std::vector<Mat3> gradients() {
    Random random(5);
    std::vector<Mat3> all;
    for (double det_f : {0.3, 0.5, 0.8, 1.0, 1.3, 1.7, 2.0}) {
      for (int i = 0; i < 3; ++i) {
        all.push_back(random.deformation_gradient(det_f, 0.6) - Mat3::Identity());
      }
    }
    return all;
  }

  static double step(const Mat3& h) {
    // The norm is at least the inverse of the least stretch.
    return 0.01 / (Mat3::Identity() + h).inverse().norm();
  }

  static void expect_lane(const Response<Packet>& all, int lane, const Response<double>& one) {
    EXPECT_NEAR(all.energy[lane], one.energy, kRounding * std::abs(one.energy));
    for (int m = 0; m < 6; ++m) {
      EXPECT_NEAR(all.s[m][lane], one.s[m], kRounding * stress(one).norm());
    }
    for (int m = 0; m < 21; ++m) {
      EXPECT_NEAR(all.d[m][lane], one.d[m], kRounding * tangent(one).norm());
    }
  }
};

class NonlinearLaws : public Laws {};

INSTANTIATE_TEST_SUITE_P(Each, Laws, testing::ValuesIn(kLaws), name_of_law);
INSTANTIATE_TEST_SUITE_P(Each, NonlinearLaws, testing::ValuesIn(kNonlinearLaws), name_of_law);

TEST_P(Laws, StressIsTheDerivativeOfTheEnergy) {
  for (const Mat3& h : gradients()) {
    const Mat3 p = first_piola(material(), h);
    const double scale = std::max(p.norm(), shear_modulus(material()));
    for (int i = 0; i < 9; ++i) {
      const Mat3 direction = Vec9::Unit(i).reshaped(3, 3);
      const double expected = derivative(
          [&](double s) { return respond(material(), h + s * direction).energy; }, step(h));
      EXPECT_NEAR(p.reshaped()[i], expected, kDifference * scale)
          << "det F " << (Mat3::Identity() + h).determinant() << ", component " << i;
    }
  }
}

TEST_P(Laws, TangentIsTheDerivativeOfTheStress) {
  for (const Mat3& h : gradients()) {
    const Mat9 a = first_piola_tangent(material(), h);
    for (int i = 0; i < 9; ++i) {
      const Mat3 direction = Vec9::Unit(i).reshaped(3, 3);
      const Mat3 expected =
          derivative([&](double s) { return first_piola(material(), h + s * direction); }, step(h));
      EXPECT_LT((a.col(i) - Vec9(expected.reshaped())).norm(), kDifference * a.norm())
          << "det F " << (Mat3::Identity() + h).determinant() << ", component " << i;
    }
  }
}

TEST_P(Laws, TheChangeOfVolumeHasItsDerivatives) {
  const Law law = GetParam();
  for (const Mat3& h : gradients()) {
    const Mat3 p = first_piola(law, volume_response(law, h), h);
    const Mat9 a = first_piola_tangent(law, volume_response(law, h), h);
    const double first_scale = std::max(p.norm(), 1.0);
    const double second_scale = std::max(a.norm(), 1.0);
    for (int i = 0; i < 9; ++i) {
      const Mat3 direction = Vec9::Unit(i).reshaped(3, 3);
      const double first = derivative(
          [&](double s) { return volume_response(law, h + s * direction).energy; }, step(h));
      EXPECT_NEAR(p.reshaped()[i], first, kDifference * first_scale) << "component " << i;
      const Mat3 second = derivative(
          [&](double s) {
            const Mat3 at = h + s * direction;
            return first_piola(law, volume_response(law, at), at);
          },
          step(h));
      EXPECT_LT((a.col(i) - Vec9(second.reshaped())).norm(), kDifference * second_scale)
          << "component " << i;
    }
  }
}

// W = W_rest + κ̂/2 g²: what the two formulations have in common.
TEST_P(Laws, EnergyIsThatOfTheMixedFormulationWithItsPressure) {
  const Material whole = material();
  const Material mixed = with_formulation(whole, Formulation::mixed);
  const double modulus = 1 / volumetric_compliance(whole);
  EXPECT_NEAR(volumetric_compliance(mixed), 1 / modulus, 1e-15 / modulus);
  for (const Mat3& h : gradients()) {
    const Response<double> w = respond(whole, h);
    const Response<double> rest = respond(mixed, h);
    const Response<double> g = volume_response(GetParam(), h);
    EXPECT_NEAR(rest.energy + 0.5 * modulus * g.energy * g.energy, w.energy,
                kRounding * std::abs(w.energy));
    const Mat3 s = stress(rest) + modulus * g.energy * stress(g);
    EXPECT_LT((s - stress(w)).norm(), kRounding * tangent(w).norm());
    Mat6 d = tangent(rest) + modulus * g.energy * tangent(g);
    for (int m = 0; m < 6; ++m) {
      for (int n = 0; n < 6; ++n) d(m, n) += modulus * g.s[m] * g.s[n];
    }
    EXPECT_LT((d - tangent(w)).norm(), kRounding * tangent(w).norm());
  }
}

TEST_P(Laws, WithoutTangentTheRestIsTheSame) {
  for (const Mat3& h : gradients()) {
    const Response<double> full = respond(material(), h);
    const Response<double> part = respond<false>(GetParam(), law_constants(material()), h);
    EXPECT_NEAR(part.energy, full.energy, kRounding * std::abs(full.energy));
    for (int m = 0; m < 6; ++m) EXPECT_NEAR(part.s[m], full.s[m], kRounding * stress(full).norm());
  }
}

TEST_P(Laws, APacketIsEightNumbers) {
  // Another material in every lane.
  const auto stiffer = [this](int lane) {
    Material result = material();
    result.parameters[0] *= 1 + 0.1 * lane;
    return result;
  };
  const auto all = gradients();
  for (std::size_t first = 0; first + 8 <= all.size(); first += 8) {
    Kinematics<Packet> k;
    for (int lane = 0; lane < 8; ++lane) {
      for (int i = 0; i < 9; ++i) {
        k.h[i / 3][i % 3].values[lane] = all[first + lane](i / 3, i % 3);
      }
    }
    k.update();
    Response<Packet> r;
    Response<Packet> volume;
    with_law(GetParam(), [&](auto law) {
      constexpr Law kLaw = decltype(law)::value;
      Packet p[kNumConstants<kLaw>];
      for (int lane = 0; lane < 8; ++lane) {
        const Constants constants = law_constants(stiffer(lane));
        for (int i = 0; i < kNumConstants<kLaw>; ++i) p[i].values[lane] = constants[i];
      }
      LawOf<kLaw>::template evaluate<true>(k, p, r);
      VolumeOf<kLaw>::template evaluate<true>(k, volume);
    });
    for (int lane = 0; lane < 8; ++lane) {
      expect_lane(r, lane, respond(stiffer(lane), all[first + lane]));
      expect_lane(volume, lane, volume_response(GetParam(), all[first + lane]));
    }
  }
}

TEST_P(Laws, AreIsotropic) {
  Random random(6);
  for (const Mat3& h : gradients()) {
    const Mat3 q = random.rotation();
    const Response<double> before = respond(material(), h);
    const Response<double> after = respond(material(), q.transpose() * h * q);
    EXPECT_NEAR(after.energy, before.energy, kRounding * before.energy);
    EXPECT_LT((stress(after) - q.transpose() * stress(before) * q).norm(),
              kRounding * tangent(before).norm());
  }
}

TEST_P(NonlinearLaws, ARotationOfTheBodyChangesNeitherEnergyNorStress) {
  Random random(7);
  for (const Mat3& h : gradients()) {
    const Mat3 q = random.rotation();
    const Response<double> before = respond(material(), h);
    const Response<double> after =
        respond(material(), q * (Mat3::Identity() + h) - Mat3::Identity());
    EXPECT_NEAR(after.energy, before.energy, kRounding * before.energy);
    EXPECT_LT((stress(after) - stress(before)).norm(), kRounding * tangent(before).norm());
    EXPECT_LT((tangent(after) - tangent(before)).norm(), kRounding * tangent(before).norm());
  }
}

// A part that turns far and strains little, as in bending. F is known to some ε, so the strain to
// ε/strain of it; energy and stress must not lose more than that.
TEST_P(NonlinearLaws, ASmallStrainThatIsRotatedKeepsItsDigits) {
  Random random(10);
  for (double size : {1e-2, 1e-4, 1e-6}) {
    for (int i = 0; i < 10; ++i) {
      const Mat3 q = random.rotation();
      const Mat3 h = random.matrix(size);
      const Response<double> alone = respond(material(), h);
      const Response<double> rotated = respond(material(), (q - Mat3::Identity()) + q * h);
      const double tolerance = 1e-14 / size;
      EXPECT_NEAR(rotated.energy, alone.energy, tolerance * alone.energy) << size;
      EXPECT_LT((stress(rotated) - stress(alone)).norm(), tolerance * stress(alone).norm()) << size;
    }
  }
}

TEST_P(NonlinearLaws, ARotatedBodyIsAtRest) {
  Random random(8);
  for (int i = 0; i < 20; ++i) {
    const Response<double> r = respond(material(), random.rotation() - Mat3::Identity());
    // F − I and FᵀF − I are wrong by some ε.
    EXPECT_NEAR(r.energy, 0, 1e-14 * bulk_modulus(material()));
    EXPECT_LT(stress(r).norm(), 1e-14 * bulk_modulus(material()));
  }
}

TEST_P(Laws, AtRestAllAreTheLinearLaw) {
  const Response<double> at_rest = respond(material(), Mat3::Zero());
  EXPECT_EQ(at_rest.energy, 0);
  EXPECT_EQ(stress(at_rest), Mat3::Zero());
  const Mat6 linear = tangent(respond(make_material(Law::linear, 3000, 0.35), Mat3::Zero()));
  EXPECT_LT((tangent(at_rest) - linear).norm(), 1e-14 * linear.norm());
}

TEST_P(Laws, TheLinearTangentIsThatOfLame) {
  const double lambda = bulk_modulus(material()) - 2.0 / 3 * shear_modulus(material());
  const double mu = shear_modulus(material());
  const Mat6 d = tangent(respond(material(), Mat3::Zero()));
  for (int m = 0; m < 6; ++m) {
    for (int n = 0; n < 6; ++n) {
      double expected = m < 3 && n < 3 ? lambda : 0;
      if (m == n) expected += m < 3 ? 2 * mu : mu;
      EXPECT_NEAR(d(m, n), expected, 1e-14 * (lambda + 2 * mu)) << m << n;
    }
  }
}

// E → 0 with H: the energy is that of the linear law but for terms of third order.
TEST_P(NonlinearLaws, SmallStrainIsThatOfTheLinearLaw) {
  Random random(9);
  const Material linear = make_material(Law::linear, 3000, 0.35);
  for (int i = 0; i < 10; ++i) {
    const Mat3 h = random.matrix(1e-7);
    const double expected = respond(linear, h).energy;
    EXPECT_NEAR(respond(material(), h).energy, expected, 1e-5 * expected);
    EXPECT_LT((first_piola(material(), h) - first_piola(linear, h)).norm(),
              1e-5 * first_piola(linear, h).norm());
  }
}

TEST_P(NonlinearLaws, FlatteningCostsMoreAndMoreWhereThereIsABarrier) {
  double last = 0;
  for (double height : {0.5, 1e-1, 1e-3, 1e-6, 1e-12}) {
    const double energy =
        respond(material(), Vec3(0, 0, height - 1).asDiagonal().toDenseMatrix()).energy;
    if (has_inversion_barrier(GetParam())) {
      EXPECT_GT(energy, last);
    }
    EXPECT_TRUE(std::isfinite(energy));
    last = energy;
  }
  const double least_that_bars = 10 * shear_modulus(material());
  EXPECT_EQ(last > least_that_bars, has_inversion_barrier(GetParam()));
}

void expect_close(const Response<double>& r, const Response<double>& expected, double tolerance) {
  EXPECT_NEAR(r.energy, expected.energy, tolerance * expected.energy);
  EXPECT_LT((stress(r) - stress(expected)).norm(), tolerance * stress(expected).norm());
  EXPECT_LT((tangent(r) - tangent(expected)).norm(), tolerance * tangent(expected).norm());
}

/// Strains from tiny to large.
std::vector<Mat3> gradients_of_any_size() {
  Random random(11);
  std::vector<Mat3> all;
  for (double size : {1e-12, 1e-6, 1e-2, 0.3}) all.push_back(random.matrix(size));
  for (double det_f : {0.4, 1.0, 2.0}) {
    all.push_back(random.deformation_gradient(det_f, 0.6) - Mat3::Identity());
  }
  return all;
}

TEST(Polynomial, OfFirstDegreeIsMooneyRivlin) {
  for (const Mat3& h : gradients_of_any_size()) {
    const Material polynomial =
        palpate::make_material(Law::mooney_rivlin_polynomial, {3200, 370, 180});
    expect_close(respond(polynomial, h), respond(make_mooney_rivlin(370, 180, 3200), h), 1e-15);
  }
}

TEST(Polynomial, EachCoefficientIsThatOfItsPowers) {
  for (const Mat3& h : gradients_of_any_size()) {
    const double x = respond(Law::mooney_rivlin, {1, 0, 0}, h).energy;
    const double y = respond(Law::mooney_rivlin, {0, 1, 0}, h).energy;
    for (int i = 0; i < num_polynomial_terms; ++i) {
      const auto [r, s] = polynomial_powers[i];
      Constants constants{};
      constants[1 + i] = 7;
      const double expected = 7 * std::pow(x, r) * std::pow(y, s);
      EXPECT_NEAR(respond(Law::mooney_rivlin_polynomial, constants, h).energy, expected,
                  1e-14 * std::abs(expected))
          << r << s;
    }
  }
}

TEST(Fung, WithASmallExponentIsNeoHookean) {
  for (const Mat3& h : gradients_of_any_size()) {
    for (double exponent : {1e-18, 1e-150, 1e-300}) {
      expect_close(respond(Law::fung, {1100, exponent, 3200}, h),
                   respond(make_mooney_rivlin(550, 0, 3200), h), 1e-15);
    }
  }
}

/// A trial state of a solver can be anywhere.
void expect_finite_and_growing(Law law, const Constants& constants) {
  double last = 0;
  for (double stretch : {1.5, 3.0, 10.0, 100.0, 1e4}) {
    const Vec3 f(stretch, 1 / stretch, 1);
    const Response<double> r =
        respond(law, constants, f.asDiagonal().toDenseMatrix() - Mat3::Identity());
    EXPECT_TRUE(std::isfinite(r.energy));
    EXPECT_TRUE(stress(r).allFinite());
    EXPECT_TRUE(tangent(r).allFinite());
    EXPECT_GT(r.energy, last) << stretch;
    last = r.energy;
  }
}

/// Stress is the derivative of the energy, and the tangent that of the stress: to a share of the
/// tangent's norm, and of the stress's or `least`.
void expect_derivatives(const Material& material, const Mat3& h, double step, double tolerance,
                        double least = 0) {
  const Mat3 p = first_piola(material, h);
  const Mat9 a = first_piola_tangent(material, h);
  ASSERT_TRUE(a.allFinite());
  for (int i = 0; i < 9; ++i) {
    const Mat3 direction = Vec9::Unit(i).reshaped(3, 3);
    const double energy =
        derivative([&](double s) { return respond(material, h + s * direction).energy; }, step);
    EXPECT_NEAR(p.reshaped()[i], energy, tolerance * std::max(p.norm(), least));
    const Mat3 change =
        derivative([&](double s) { return first_piola(material, h + s * direction); }, step);
    EXPECT_LT((a.col(i) - Vec9(change.reshaped())).norm(), tolerance * a.norm());
  }
}

TEST(Fung, IsFiniteAndGrowsHoweverFarOut) {
  for (double exponent : {1e-3, 1.0, 50.0, 1e4}) {
    SCOPED_TRACE(exponent);
    expect_finite_and_growing(Law::fung, {1100, exponent, 3200});
  }
}

TEST(Fung, BeyondTheLargestExponentEnergyStressAndTangentStillBelongTogether) {
  const Material material = palpate::make_material(Law::fung, {3000, 0.35, 50});
  for (double stretch : {3.0, 4.0}) {  // exponents of 300 and 700
    const Mat3 h = Vec3(stretch, 1, 1 / stretch).asDiagonal().toDenseMatrix() - Mat3::Identity();
    expect_derivatives(material, h, 1e-3, 1e-8);
  }
}

/// A displacement gradient with the stretches given along axes that are turned, and of a body that
/// is turned after that.
Mat3 with_stretches(const Vec3& stretches, Random& random) {
  const Mat3 axes = random.rotation();
  return random.rotation() * axes * stretches.asDiagonal() * axes.transpose() - Mat3::Identity();
}

TEST(Ogden, OfExponentTwoIsNeoHookeanAndOfMinusTwoTheSecondInvariant) {
  for (const Mat3& h : gradients_of_any_size()) {
    expect_close(respond(Law::ogden, {3200, 1100, 2}, h),
                 respond(make_mooney_rivlin(550, 0, 3200), h), 1e-14);
    expect_close(respond(Law::ogden, {3200, 740, 2, 360, -2}, h),
                 respond(make_mooney_rivlin(370, 180, 3200), h), 1e-14);
  }
}

// λ̄₁⁴ + λ̄₂⁴ + λ̄₃⁴ = Ī₁² − 2 Ī₂, and that of −4 with the two exchanged: with x = Ī₁ − 3 and
// y = Ī₂ − 3 the sums less 3 are x² + 6x − 2y and y² + 6y − 2x.
TEST(Ogden, OfExponentFourIsAPolynomial) {
  for (const Mat3& h : gradients_of_any_size()) {
    const double w = 2 * 1100.0 / 16;
    expect_close(respond(Law::ogden, {3200, 1100, 4}, h),
                 respond(Law::mooney_rivlin_polynomial, {3200, 6 * w, -2 * w, w}, h), 1e-13);
    expect_close(respond(Law::ogden, {3200, 1100, -4}, h),
                 respond(Law::mooney_rivlin_polynomial, {3200, -2 * w, 6 * w, 0, 0, w}, h), 1e-13);
  }
}

TEST(Ogden, TheOrderOfTheTermsAndEmptyOnesHaveNoPart) {
  for (const Mat3& h : gradients_of_any_size()) {
    const Response<double> expected = respond(Law::ogden, {3200, 700, 1.3, 300, 5, 250, -4.7}, h);
    expect_close(respond(Law::ogden, {3200, 250, -4.7, 700, 1.3, 300, 5}, h), expected, 1e-14);
    expect_close(respond(Law::ogden, {3200, 0, 0, 1100, -9, 0, 0}, h),
                 respond(Law::ogden, {3200, 1100, -9}, h), 1e-14);
  }
}

// Two or all stretches are equal, or nearly so: nothing is divided by their difference.
TEST(Ogden, EqualStretchesHaveTheLimitOfUnequalOnes) {
  Random random(12);
  const Constants constants = {3200, 700, 1.3, 300, 5, 250, -4.7};
  const Material material{Law::ogden, constants, Formulation::displacement};
  for (const Vec3& base : {Vec3(1, 1, 1), Vec3(1.3, 1.3, 1.3), Vec3(1.4, 1.4, 0.7),
                           Vec3(0.8, 0.8, 1.6), Vec3(0.6, 1.2, 0.6)}) {
    for (double gap : {0.0, 1e-300, 1e-16, 1e-12, 1e-8, 1e-5, 1e-3}) {
      SCOPED_TRACE(gap);
      const Mat3 h = with_stretches(base + gap * Vec3(0, 1, -0.3), random);
      expect_derivatives(material, h, 5e-3, kDifference, 1250);
    }
  }
}

TEST(Ogden, IsFiniteAndGrowsHoweverFarOut) {
  for (double exponent : {-1000.0, -25.0, -1.0, 0.1, 3.0, 40.0, 1000.0}) {
    SCOPED_TRACE(exponent);
    expect_finite_and_growing(Law::ogden, {3200, 1100, exponent});
  }
}

TEST(Ogden, BeyondTheLargestExponentEnergyStressAndTangentStillBelongTogether) {
  const Material material{Law::ogden, {3200, 1100, 150}, Formulation::displacement};
  Random random(13);
  // Exponents of 208 and 416 beside −208 and −416; in the third case one pair is equal.
  for (const Vec3& stretches : {Vec3(4, 1, 0.25), Vec3(16, 1, 1.0 / 16), Vec3(5, 5, 0.04)}) {
    expect_derivatives(material, with_stretches(stretches, random), 1e-4, 1e-7);
  }
}

TEST(Ogden, ExponentialsKeepTheirDigits) {
  for (double x : {1e-300, 1e-16, 1e-8, 1e-3, 0.3, 0.999, 1.0, 1.001, 5.0, 100.0}) {
    for (double y : {x, -x}) {
      const long double exact =
          std::abs(y) < 1e-2 ? 0.5L + y / 6.0L + y * y / 24.0L * (1 + y / 5.0L * (1 + y / 6.0L))
                             : (std::expm1(static_cast<long double>(y)) - y) / y / y;
      EXPECT_NEAR(baseline::exp_remainder(y), static_cast<double>(exact),
                  2e-15 * static_cast<double>(exact))
          << y;
    }
  }
  EXPECT_EQ(baseline::exp_remainder(0), 0.5);
  EXPECT_EQ(baseline::mean_exp(0), 1);
  EXPECT_EQ(baseline::mean_exp_between(0.7, 0.7), std::exp(0.7));
  EXPECT_NEAR(baseline::mean_exp_between(1, 3), (std::exp(3) - std::exp(1)) / 2, 1e-14);
  EXPECT_EQ(baseline::mean_exp_between(1, 3), baseline::mean_exp_between(3, 1));
}

TEST(Log1pRemainder, KeepsItsDigits) {
  for (double sign : {-1.0, 1.0}) {
    for (double x : {1e-300, 1e-150, 1e-12, 1e-8}) {
      // The next term of x²/2 − x³/3 + x⁴/4 is below 1e-16 of the first.
      EXPECT_NEAR(baseline::log1p_remainder(sign * x), x * x * (0.5 - sign * x / 3), 1e-15 * x * x);
    }
    for (double x : {1e-3, 0.01, 0.0499999, 0.05, 0.0500001, 0.1, 0.9}) {
      // 64-bit mantissa: from 1e-3 on, the subtraction leaves 16 digits.
      const long double reference = sign * x - std::log1p(static_cast<long double>(sign * x));
      EXPECT_NEAR(baseline::log1p_remainder(sign * x), static_cast<double>(reference),
                  1e-14 * static_cast<double>(reference))
          << sign * x;
    }
  }
}

}  // namespace
}  // namespace palpate::test::test_laws
