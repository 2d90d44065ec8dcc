// SPDX-License-Identifier: BSD-3-Clause
// The space of a rigid tool that presses a leaf at z = 0 from above or from below:
//
//   Π = K (kBegins − s z)³,   s = 1 from above, −1 from below,   as long as s z > −kEnds
//
// Where the leaf has been pushed to kEnds beyond its place at rest it slips off the tool.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "interaction/interaction_spec.h"
#include "state_space/touch_space.h"

namespace palpate::test {

struct TwoSides {
  static constexpr double kSpacing = 1e-3;
  /// The check-points go from −kReach to kReach along each axis.
  static constexpr std::int32_t kReach = 4;
  /// The height at which the contact begins, and that to which it goes on beyond the middle, in
  /// spacings; at the latter there is still a configuration.
  static constexpr std::int32_t kBegins = 3;
  static constexpr std::int32_t kEnds = 2;
  /// K, N/m².
  static constexpr double kFactor = 1000;

  /// The force from above (1) or below (−1), N.
  static double force(double z, int side) {
    const double depth = std::max(0.0, kBegins * kSpacing - side * z);
    return -side * 3 * kFactor * depth * depth;
  }

  /// The configuration from above (1) or below (−1).
  static ConfigurationSummary pressed(const CheckPoint& p, int side) {
    ConfigurationSummary c;
    c.check_point = c.parent = p;
    c.outcome = Outcome::converged;
    c.t = kSpacing * Vec3(p[0], p[1], p[2]);
    const double depth = kBegins * kSpacing - side * c.t.z();
    if (depth <= 0) {
      c.flags = flags::touches_nothing;
      return c;
    }
    c.energy = kFactor * depth * depth * depth;
    c.force.z() = force(c.t.z(), side);
    c.stiffness(2, 2) = 6 * kFactor * depth;
    return c;
  }

  static TouchToolSpace make() {
    TouchToolSpace space;
    space.setup.id = kContactToolSpace;
    RigidTool sphere;
    sphere.radius = kReach * kSpacing;
    space.setup.interaction = rigid_contact_spec(sphere);
    space.setup.grid.sparse = true;
    space.setup.grid.resolution = 2 * kReach + 1;
    space.setup.grid.half_width = kReach * kSpacing;
    const auto height_of = [](int side, const CheckPoint& p) { return side * p[2]; };
    // The level of a side at a check-point; −1: it has none there.
    const auto level_of = [&](int side, const CheckPoint& p) {
      if (height_of(side, p) < -kEnds) return -1;
      const bool is_flat = side > 0 ? p[2] >= 0 : p[2] < 0;
      return is_flat ? 0 : 1;
    };
    for (std::int32_t i = -kReach; i <= kReach; ++i) {
      for (std::int32_t j = -kReach; j <= kReach; ++j) {
        for (std::int32_t k = -kReach; k <= kReach; ++k) {
          const CheckPoint p{i, j, k};
          const int flat = k >= 0 ? 1 : -1;
          for (const int side : {flat, -flat}) {
            if (level_of(side, p) < 0) continue;
            ConfigurationSummary& c = space.configurations.emplace_back(pressed(p, side));
            c.level = level_of(side, p);
            // Transitions up and down were made where both sides are near.
            for (const int step : {-1, 1}) {
              const CheckPoint q{i, j, k + step};
              if (std::abs(k) > kEnds || std::abs(q[2]) > kReach) continue;
              const bool goes_on = level_of(side, q) >= 0;
              c.reached[neighbour_number(p, q)] = goes_on ? level_of(side, q) : 0;
            }
          }
        }
      }
    }
    const auto number = static_cast<Eigen::Index>(space.configurations.size());
    space.coefficients.setZero(0, number);
    space.coefficient_gradients.setZero(0, number);
    return space;
  }
};

}  // namespace palpate::test
