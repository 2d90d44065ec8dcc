// SPDX-License-Identifier: BSD-3-Clause
// A body with two branches, in closed form: an inner variable w that rests in a well of
//
//   V(w) = ¼ w⁴ − ½ a w² − b w,   a = a₀ + a₁ x,   b = b₀ + z,
//
// of which there are two where 27 b² < 4 a³, and Π = ½ c |t|² + V. Moved slowly, w stays in its
// well until that is gone, and then falls into the other one. With a₁ = 0 a loop in z has
// hysteresis; with a₁ > 0 the branches join round a cusp at a = b = 0.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "state_space/configuration.h"

namespace palpate::test {

struct Bistable {
  double a0 = 1;
  double a1 = 0;
  double b0 = 0.6;
  double c = 4;

  [[nodiscard]] double a(const Vec3& t) const { return a0 + a1 * t.x(); }
  [[nodiscard]] double b(const Vec3& t) const { return b0 + t.z(); }

  /// Bottoms of the wells, ascending.
  [[nodiscard]] std::vector<double> wells(const Vec3& t) const {
    const double of_a = a(t);
    const double of_b = b(t);
    if (27 * of_b * of_b < 4 * of_a * of_a * of_a) {
      const double r = 2 * std::sqrt(of_a / 3);
      const double angle = std::acos(std::clamp(4 * of_b / (r * r * r), -1.0, 1.0)) / 3;
      return {r * std::cos(angle + 2 * M_PI / 3), r * std::cos(angle)};
    }
    const double root = std::sqrt(of_b * of_b / 4 - of_a * of_a * of_a / 27);
    return {std::cbrt(of_b / 2 + root) + std::cbrt(of_b / 2 - root)};
  }

  /// Moved straight in small steps.
  [[nodiscard]] double move(const Vec3& from, double w, const Vec3& to) const {
    constexpr int kSteps = 64;
    for (int i = 1; i <= kSteps; ++i) {
      const Vec3 t = from + (static_cast<double>(i) / kSteps) * (to - from);
      const std::vector<double> all = wells(t);
      // In the same well as before where there are two.
      const double middle = all.size() == 2 ? -(all[0] + all[1]) : 0;
      w = all.size() == 1 ? all[0] : (w < middle ? all[0] : all[1]);
    }
    return w;
  }

  [[nodiscard]] ConfigurationSummary at(const Vec3& t, double w) const {
    ConfigurationSummary found;
    found.t = t;
    found.outcome = Outcome::converged;
    const double bend = 3 * w * w - a(t);
    const Vec3 of_w(-a1 * w, 0, -1);  // ∂²V/∂w∂t
    found.energy = 0.5 * c * t.squaredNorm() + w * w * (w * w / 4 - a(t) / 2) - b(t) * w;
    found.force = c * t + Vec3(-a1 * w * w / 2, 0, -w);
    found.stiffness = c * Mat3::Identity() - of_w * of_w.transpose() / bend;
    found.signature = Vec3(w, 0, 0);
    return found;
  }
};

}  // namespace palpate::test
