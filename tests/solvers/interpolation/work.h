// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdlib>

#include "interpolation/interpolator.h"

namespace palpate::test {

/// Work of the force along a line parallel to an axis, J: three Gauss points on each step, which is
/// exact where the force along a step is a polynomial of degree five.
/// @param steps Negative: backwards. @param size The work of |force| is added to it, J.
inline double work_along(const Interpolator& interpolator, Vec3 from, int axis, int steps,
                         double step_length, double& size) {
  const double gauss[3] = {0.5 - std::sqrt(0.15), 0.5, 0.5 + std::sqrt(0.15)};
  const double weight[3] = {5.0 / 18, 8.0 / 18, 5.0 / 18};
  const double step = steps > 0 ? step_length : -step_length;
  double sum = 0;
  for (int i = 0; i < std::abs(steps); ++i) {
    for (int g = 0; g < 3; ++g) {
      const TouchResult r = interpolator.evaluate(from + gauss[g] * step * Vec3::Unit(axis));
      sum += weight[g] * step * r.force[axis];
      size += weight[g] * step_length * std::abs(r.force[axis]);
    }
    from[axis] += step;
  }
  return sum;
}

}  // namespace palpate::test
