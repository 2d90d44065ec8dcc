// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "haptic/servo/energy_balance.h"

namespace palpate::test::test_passivity {
namespace {

constexpr double kStiffness = 1000;
constexpr double kInterval = 1e-3;

/// Work of a spring sampled as the hand goes in and out at a speed, m/s.
double dissipated_by_spring(double speed, int ticks_late) {
  EnergyBalance balance;
  balance.begin(0);
  double x[400] = {};
  for (int i = 1; i < 400; ++i) {
    x[i] = speed * kInterval * (i < 200 ? i : 400 - i);
    const auto force = [&](int at) { return at > 0 ? kStiffness * x[at] : 0; };
    balance.add(Vec3(0, 0, force(i - 1 - ticks_late)), Vec3(0, 0, x[i - 1] - x[i]),
                0.5 * kStiffness * x[i] * x[i]);
  }
  return balance.dissipated();
}

// In by n steps d, the spring's work is d² k n(n−1)/2 on the way in and d² k n(n+1)/2 on the way
// out: what is made is n d² k.
TEST(EnergyBalance, ASampledSpringMakesWhatTheFormulaSays) {
  const double d = 0.02 * kInterval;
  EXPECT_NEAR(dissipated_by_spring(0.02, 0), -199 * d * d * kStiffness, 3 * d * d * kStiffness);
  EXPECT_LT(dissipated_by_spring(0.02, 3), 6 * dissipated_by_spring(0.02, 0));
}

TEST(EnergyBalance, DampingTakesAwayWhatWasMade) {
  EnergyBalance balance;
  balance.begin(1);
  EXPECT_EQ(balance.damping(Vec3(0, 0, 0.1), kInterval, 10), 0);
  balance.add(Vec3(0, 0, 2), Vec3(0, 0, 1e-5), 1);
  EXPECT_NEAR(balance.dissipated(), -2e-5, 1e-15);
  const double b = balance.damping(Vec3(0, 0, 0.1), kInterval, 10);
  EXPECT_NEAR(b, 2e-5 / (0.01 * kInterval), 1e-9);
  EXPECT_EQ(balance.damping(Vec3(0, 0, 0.1), kInterval, 1), 1) << "no more than the device can";
  EXPECT_EQ(balance.damping(Vec3::Zero(), kInterval, 10), 0);
  balance.add(-b * Vec3(0, 0, 0.1), Vec3(0, 0, 0.1 * kInterval), 1);
  EXPECT_NEAR(balance.dissipated(), 0, 1e-15);
}

}  // namespace
}  // namespace palpate::test::test_passivity
