// SPDX-License-Identifier: BSD-3-Clause
// The force where there is no cell, from configurations around: one energy, smooth, and none that
// pulls the tool in.
#include "interpolation/near_states.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "interpolation/tool_force.h"
#include "solvers/interpolation/contact_space.h"
#include "solvers/support/allocations.h"
#include "solvers/support/random.h"

namespace palpate::test::test_near_states {
namespace {

constexpr double kReach = 0.01;

/// Π = 3 + h·x + ½ x·k x + c/6 x₀³, whose force has a part along −z everywhere near.
struct Energy {
  double cubic = 0;
  Vec3 h{0.1, -0.2, -1};
  Mat3 k = (Mat3() << 40, 5, 3, 5, 60, -4, 3, -4, 80).finished();

  [[nodiscard]] ConfigurationSummary at(const Vec3& x) const {
    ConfigurationSummary c;
    c.outcome = Outcome::converged;
    c.t = x;
    c.energy = 3 + h.dot(x) + 0.5 * x.dot(k * x) + cubic / 6 * std::pow(x[0], 3);
    c.force = h + k * x + 0.5 * cubic * x[0] * x[0] * Vec3::UnitX();
    c.stiffness = k;
    c.stiffness(0, 0) += cubic * x[0];
    return c;
  }
};

std::vector<ConfigurationSummary> scattered(const Energy& energy, double within) {
  RandomPoints random(within);
  std::vector<ConfigurationSummary> all;
  for (int i = 0; i < 60; ++i) all.push_back(energy.at(random()));
  return all;
}

TEST(NearStates, AQuadraticEnergyIsExact) {
  const Energy energy;
  const NearStates near(scattered(energy, 0.012), kReach);
  RandomPoints random(0.012);
  for (int i = 0; i < 200; ++i) {
    const Vec3 x = random();
    ASSERT_TRUE(near.reaches(x));
    const TouchResult found = near.evaluate(x);
    const ConfigurationSummary exact = energy.at(x);
    EXPECT_EQ(found.support, Support::extrapolated);
    EXPECT_NEAR(found.energy, exact.energy, 1e-12);
    EXPECT_LT((found.force - exact.force).norm(), 1e-11);
    EXPECT_LT((found.stiffness - exact.stiffness).norm(), 1e-10);
  }
}

TEST(NearStates, TheForceIsTheGradientOfOneEnergyAndDoesNotJump) {
  Energy energy;
  energy.cubic = 2e4;
  const NearStates near(scattered(energy, 0.012), kReach);
  RandomPoints random(0.01);
  constexpr double kStep = 1e-6;
  for (int i = 0; i < 300; ++i) {
    const Vec3 x = random();
    const Vec3 force = near.evaluate(x).force;
    for (int k = 0; k < 3; ++k) {
      const Vec3 step = kStep * Vec3::Unit(k);
      const TouchResult after = near.evaluate(x + step);
      const TouchResult before = near.evaluate(x - step);
      EXPECT_NEAR((after.energy - before.energy) / (2 * kStep), force[k], 1e-6);
      EXPECT_LT((after.force - before.force).norm(), 2e3 * kStep);
    }
  }
}

TEST(NearStates, ThoseThatSayNothingOfAForceAreNotUsed) {
  const Energy energy;
  std::vector<ConfigurationSummary> all(5, energy.at(Vec3::Zero()));
  all[0].outcome = Outcome::not_converged;
  all[1].flags = flags::touches_nothing;
  all[2].flags = flags::inverted;
  all[3].energy = std::numeric_limits<double>::quiet_NaN();
  all[4].level = 1;
  const NearStates near(all, kReach);
  EXPECT_FALSE(near.reaches(Vec3::Zero()));
  EXPECT_EQ(near.evaluate(Vec3::Zero()).support, Support::none);
}

TEST(NearStates, BeyondTheirReachAndNowhereThereIsNone) {
  const Energy energy;
  const NearStates near({energy.at(Vec3::Zero())}, kReach);
  EXPECT_TRUE(near.reaches(Vec3(0.0099, 0, 0)));
  for (const Vec3& x : {Vec3(0.0101, 0, 0), Vec3(1e30, 0, 0),
                        Vec3(std::numeric_limits<double>::quiet_NaN(), 0, 0)}) {
    EXPECT_FALSE(near.reaches(x));
    EXPECT_EQ(near.evaluate(x).force, Vec3::Zero());
  }
}

TEST(NearStates, NoForcePullsTheToolIn) {
  Energy energy;
  energy.h = Vec3(0, 0, -1);
  energy.k = Vec3(0, 0, 200).asDiagonal();
  const NearStates near({energy.at(Vec3::Zero())}, kReach);
  // By the expansion the force is −1 + 200 z: it holds the tool in from z = 5 mm on.
  Vec3 before = near.evaluate(Vec3::Zero()).force;
  for (double z = 0; z < 0.0099; z += 1e-5) {
    const Vec3 force = near.evaluate(Vec3(0, 0, z)).force;
    EXPECT_LE(force[2], 0);
    EXPECT_LT((force - before).norm(), 0.01) << z;
    before = force;
  }
  EXPECT_EQ(before, Vec3::Zero());
}

/// A plain at z = 0 and the part of its space on one side.
TouchToolSpace half_space() {
  Grid grid;
  grid.half_width = 0.04;
  grid.resolution = 21;
  grid.sparse = true;
  TouchToolSpace space = contact_space(slab(0), grid, 0.008);
  auto& all = space.configurations;
  // Of the rest, single configurations are known.
  all.erase(std::remove_if(all.begin(), all.end(),
                           [](const ConfigurationSummary& c) {
                             const bool is_single = (c.check_point[0] + c.check_point[1]) % 2 == 0;
                             return c.check_point[0] > 0 && !is_single;
                           }),
            all.end());
  return space;
}

TEST(NearStates, TheForceOnAToolGoesOverIntoThemBesideItsCells) {
  const TouchToolSpace space = half_space();
  const ToolForce in_cells({&space}, Method::energy_hermite);
  InterpolationOptions options;
  options.reach_of_states = 1.25 * space.setup.grid.spacing();
  const ToolForce force({&space}, Method::energy_hermite, options);
  const double depth = 0.003;
  EXPECT_FALSE(force.expands(Vec3(-0.01, 0, -depth)));
  EXPECT_EQ(force.evaluate(Vec3(-0.01, 0, -depth)).force,
            in_cells.evaluate(Vec3(-0.01, 0, -depth)).force);
  const double size = force.evaluate(Vec3(-0.01, 0, -depth)).force.norm();
  ASSERT_GT(size, 0);
  Vec3 before = force.evaluate(Vec3(-0.01, 0, -depth)).force;
  int expanded = 0;
  const long allocated = num_allocations();
  for (double x = -0.01; x < 0.02; x += 1e-5) {
    const Vec3 place(x, 0.001, -depth);
    const Vec3 now = force.evaluate(place).force;
    EXPECT_LT((now - before).norm(), 0.02 * size) << x;
    // A plain gives the same force everywhere.
    EXPECT_LT((now - force.evaluate(Vec3(-0.01, 0, -depth)).force).norm(), 0.25 * size) << x;
    expanded += force.expands(place) ? 1 : 0;
    before = now;
  }
  EXPECT_EQ(num_allocations(), allocated);
  EXPECT_GT(expanded, 1000);
}

}  // namespace
}  // namespace palpate::test::test_near_states
