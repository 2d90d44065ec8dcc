// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace palpate {

/// A step from 0 to 1 with three derivatives that are continuous, t⁴ (35 − 84 t + 70 t² − 20 t³).
template <class T>
struct SmoothStep {
  T value, slope, curvature;
};

/// @param t 0 to 1; a number or several.
template <class T>
[[nodiscard]] inline SmoothStep<T> smooth_step(T t) {
  const T r = 1.0 - t;
  const T t3 = t * t * t;
  return {t3 * t * (35.0 + t * (-84.0 + t * (70.0 - 20.0 * t))), 140.0 * t3 * r * r * r,
          420.0 * t * t * r * r * (1.0 - 2.0 * t)};
}

}  // namespace palpate
