// SPDX-License-Identifier: BSD-3-Clause
// The random numbers of one test point or one walk. They depend on its set, kind and number alone,
// and are the same with every standard library.
#pragma once

#include <cstdint>
#include <random>

#include "schedule/owner.h"
#include "state_space/test_point.h"

namespace palpate {

class TestRandom {
 public:
  TestRandom(const TestSet& set, TestKind kind, int number)
      : engine_(mix(mix(mix(mix(static_cast<std::uint64_t>(set.seed)) +
                            static_cast<std::uint64_t>(set.tool_space)) +
                        static_cast<std::uint64_t>(kind)) +
                    static_cast<std::uint64_t>(number))) {}

  /// A number in [0, 1).
  double unit() { return 0x1p-53 * static_cast<double>(engine_() >> 11); }

  /// A point in the cube with this half-width.
  Vec3 in_cube(double half_width) {
    Vec3 t;
    for (double& x : t) x = half_width * (2 * unit() - 1);
    return t;
  }
  /// A point in the ball with this radius.
  Vec3 in_ball(double radius) {
    Vec3 t;
    do t = in_cube(radius);
    while (t.norm() > radius);
    return t;
  }

  /// A unit vector, uniform over all directions.
  Vec3 direction() { return in_ball(1).normalized(); }

 private:
  std::mt19937_64 engine_;
};

}  // namespace palpate
