// SPDX-License-Identifier: BSD-3-Clause
// The energy of a body that tears, by the area of its cut.
#include "interpolation/torn_energy.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "solvers/support/finite_difference.h"
#include "solvers/support/random.h"

namespace palpate::test::test_torn_energy {
namespace {

/// Two stiffnesses that fall as the cut opens, the first one as that of a double cantilever, and a
/// part that does not depend on the cut: Π = ½ t·K t, and a little of the fourth order.
class Lobe {
 public:
  [[nodiscard]] static Mat3 stiffness(double area) {
    const double length = 1 + area / kWidth;
    return Vec3(9 / std::pow(length, 3), 2 + 1 / length, 4 + std::exp(-length)).asDiagonal();
  }
  static constexpr double kWidth = 0.9;

  [[nodiscard]] static TouchResult at(double area, const Vec3& t) {
    const Mat3 k = stiffness(area);
    TouchResult result = TouchResult::empty_sum();
    const double fourth = 0.3 * t.squaredNorm();
    result.energy = 0.5 * t.dot(k * t) + 0.25 * fourth * t.squaredNorm();
    result.force = k * t + fourth * t;
    result.stiffness = k + fourth * Mat3::Identity() + 0.6 * t * t.transpose();
    return result;
  }
};

const std::vector<double> kAreas{0, 0.1, 0.22, 0.3, 0.4, 0.55, 0.6};

/// The stages of the lobe at t.
auto stages(const Vec3& t) {
  return [t](int stage) { return Lobe::at(kAreas[static_cast<std::size_t>(stage)], t); };
}

/// Elastic energy and what tore.
double whole_energy(const TornEnergy& energy, double area, double toughness, const Vec3& t) {
  return energy.evaluate(area, stages(t)).touch.energy + toughness * area;
}

TEST(TornEnergy, HasTheStagesAndIsCloseToTheTruthBetween) {
  const TornEnergy energy(kAreas);
  const Vec3 t(0.4, 0.1, -0.2);
  for (const double area : kAreas) {
    const TouchResult found = energy.evaluate(area, stages(t)).touch;
    const TouchResult right = Lobe::at(area, t);
    EXPECT_NEAR(found.energy, right.energy, 1e-15);
    EXPECT_LT((found.force - right.force).norm(), 1e-14);
    EXPECT_LT((found.stiffness - right.stiffness).norm(), 1e-13);
  }
  for (double area = 0; area < kAreas.back(); area += 0.013) {
    const TouchResult found = energy.evaluate(area, stages(t)).touch;
    const TouchResult right = Lobe::at(area, t);
    // Before the first stage it goes by the whole step.
    const double error = area < kAreas[1] ? 0.013 : 0.005;
    EXPECT_NEAR(found.energy, right.energy, error * right.energy);
    EXPECT_LT((found.force - right.force).norm(), error * right.force.norm());
  }
}

TEST(TornEnergy, ForceStiffnessAndReleaseRateAreItsDerivatives) {
  Random random(4);
  for (const int num : {2, 3, 4, 7}) {
    const TornEnergy energy({kAreas.begin(), kAreas.begin() + num});
    for (int i = 0; i < 40; ++i) {
      const double area = random.uniform(0.01, 0.99) * energy.whole_area();
      const Vec3 t = random.vector(3, 0.5);
      const Vec3 way = random.vector(3, 1);
      const TornResult here = energy.evaluate(area, stages(t));
      const auto by_t = [&](double h) { return energy.evaluate(area, stages(t + h * way)).touch; };
      const double slope = derivative([&](double h) { return by_t(h).energy; }, 1e-2);
      EXPECT_NEAR(here.touch.force.dot(way), slope, 1e-7) << num << " stages, " << area;
      const Vec3 turn = derivative([&](double h) { return by_t(h).force; }, 1e-2);
      EXPECT_LT((here.touch.stiffness * way - turn).norm(), 1e-6);
      const double h = 0.2 * std::min({area, energy.whole_area() - area, 1e-3});
      const auto by_area = [&](double step) {
        return energy.evaluate(area + step, stages(t)).touch.energy;
      };
      // Not across a stage, where the second derivative jumps.
      if (energy.stage_below(area - h) != energy.stage_below(area + h)) continue;
      EXPECT_NEAR(here.release_rate, -derivative(by_area, h), 1e-7);
    }
  }
}

TEST(TornEnergy, TheReleaseRateIsContinuousAcrossStages) {
  const TornEnergy energy(kAreas);
  const Vec3 t(0.3, 0.4, 0.1);
  for (std::size_t j = 1; j + 1 < kAreas.size(); ++j) {
    const double before = energy.evaluate(kAreas[j] * (1 - 1e-12), stages(t)).release_rate;
    const double after = energy.evaluate(kAreas[j], stages(t)).release_rate;
    EXPECT_GT(after, 0);
    EXPECT_NEAR(before, after, 1e-8 * after);
  }
}

TEST(TornEnergy, ATearStopsWhereTheReleaseRateIsTheToughness) {
  const TornEnergy energy(kAreas);
  constexpr double kToughness = 1;
  double area = 0;
  int num_in_balance = 0;
  for (double way = 0; way < 0.6; way += 0.01) {
    const Vec3 t(way, 0, 0);
    const double before = area;
    area = energy.tear(area, kToughness, energy.whole_area(), stages(t));
    ASSERT_GE(area, before);
    // This one falls with the area, so that the tear is stable: it stands where G = G_c.
    const double rate = energy.evaluate(area, stages(t)).release_rate;
    if (area > kAreas[1] && area < energy.whole_area()) {
      EXPECT_NEAR(rate, kToughness, 2e-9);
      ++num_in_balance;
    }
    EXPECT_NEAR(energy.tear(area, kToughness, energy.whole_area(), stages(t)), area, 1e-11)
        << "it rests";
  }
  EXPECT_GT(num_in_balance, 10);
}

TEST(TornEnergy, BeginsWhereAStepToTheNextStagePaysForItself) {
  const TornEnergy energy(kAreas);
  constexpr double kToughness = 1;
  // A body whose release rate is 0 at the border: stages of equal energy at first.
  const auto at = [&](double pull) {
    return [pull](int stage) {
      TouchResult result = TouchResult::empty_sum();
      const double area = kAreas[static_cast<std::size_t>(stage)];
      result.energy = pull * (1 - area * area);
      return result;
    };
  };
  // Π_0 − Π_1 = pull · A_1².
  const double onset = kToughness / kAreas[1];
  EXPECT_EQ(energy.tear(0, kToughness, 1, at(0.999 * onset)), 0);
  // From there on it releases more and more, and tears to the end.
  EXPECT_EQ(energy.tear(0, kToughness, 1, at(1.001 * onset)), energy.whole_area());
  EXPECT_EQ(energy.tear(0, kToughness, 0.17, at(1.001 * onset)), 0.17) << "as far as is allowed";
}

TEST(TornEnergy, GoesOnFromRoundingBesideAStage) {
  const TornEnergy energy(kAreas);
  constexpr double kToughness = 1;
  const Vec3 t(0.55, 0, 0);
  const double right = energy.tear(kAreas[2], kToughness, 1, stages(t));
  ASSERT_GT(right, 1.1 * kAreas[2]);
  for (const double beside : {1 - 1e-15, 1 + 1e-15}) {
    EXPECT_NEAR(energy.tear(beside * kAreas[2], kToughness, 1, stages(t)), right, 1e-12);
  }
}

TEST(TornEnergy, MakesNoEnergyOnRandomPaths) {
  const TornEnergy energy(kAreas);
  Random random(11);
  for (int path = 0; path < 1000; ++path) {
    const double toughness = random.uniform(0.2, 3);
    Vec3 t = Vec3::Zero();
    double area = 0;
    double work = 0;
    double torn_work = 0;
    // There and back, with loops.
    for (int leg = 0; leg < 6; ++leg) {
      const Vec3 end = leg == 5 ? Vec3(Vec3::Zero()) : Vec3(random.vector(3, 0.9));
      constexpr int kSteps = 40;
      for (int i = 1; i <= kSteps; ++i) {
        const Vec3 next = t + (end - t) / (kSteps - i + 1);
        // The work along a straight step, exactly: the energies at this area.
        work += energy.evaluate(area, stages(next)).touch.energy -
                energy.evaluate(area, stages(t)).touch.energy;
        t = next;
        const double before = area;
        const double energy_before = whole_energy(energy, before, toughness, t);
        area = energy.tear(area, toughness, energy.whole_area(), stages(t));
        ASSERT_GE(area, before);
        ASSERT_LE(whole_energy(energy, area, toughness, t), energy_before + 1e-12);
        torn_work += toughness * (area - before);
        const double left = work - energy.evaluate(area, stages(t)).touch.energy - torn_work;
        ASSERT_GE(left, -1e-12) << "path " << path;
      }
    }
  }
}

TEST(TornEnergy, AStableTearIsBalanced) {
  const TornEnergy energy(kAreas);
  constexpr double kToughness = 1;
  double area = kAreas[1];
  double work = Lobe::at(area, Vec3(0.2, 0, 0)).energy;
  const double begin = work;
  Vec3 t(0.2, 0, 0);
  constexpr double kTick = 0.00005;
  for (; area < 0.5; t.x() += kTick) {
    const double before = energy.evaluate(area, stages(t)).touch.energy;
    work += energy.evaluate(area, stages(t + Vec3(kTick, 0, 0))).touch.energy - before;
    area = energy.tear(area, kToughness, energy.whole_area(), stages(t + Vec3(kTick, 0, 0)));
  }
  const double excess =
      work - energy.evaluate(area, stages(t)).touch.energy - kToughness * (area - kAreas[1]);
  EXPECT_GT(work - begin, 0.1);
  EXPECT_NEAR(excess, 0, 0.002 * (work - begin));
}

}  // namespace
}  // namespace palpate::test::test_torn_energy
