// SPDX-License-Identifier: BSD-3-Clause
#include "interpolation/torn_energy.h"

#include <cmath>

namespace palpate {
namespace {

constexpr double kBalanced = 1e-9;

}  // namespace

/// A number with its first and second derivative by t.
struct TornEnergy::Jet {
  double value = 0;
  Vec3 gradient = Vec3::Zero();
  Mat3 hessian = Mat3::Zero();

  [[nodiscard]] friend Jet operator+(const Jet& a, const Jet& b) noexcept {
    return {a.value + b.value, a.gradient + b.gradient, a.hessian + b.hessian};
  }
  [[nodiscard]] friend Jet operator*(double factor, const Jet& a) noexcept {
    return {factor * a.value, factor * a.gradient, factor * a.hessian};
  }
};

/// c_0 + c_1 s + c_2 s² + c_3 s³ over an interval of the width w, A = A_j + s w.
struct TornEnergy::Cubic {
  std::array<Jet, 4> c;
  double width = 0;

  [[nodiscard]] Jet at(double s) const noexcept {
    return c[0] + s * (c[1] + s * (c[2] + s * c[3]));
  }
  /// G.
  [[nodiscard]] double release_rate(double s) const noexcept {
    return -(c[1].value + s * (2 * c[2].value + s * 3 * c[3].value)) / width;
  }
};

int TornEnergy::stage_below(double area) const noexcept {
  const auto above = std::upper_bound(areas_.begin(), areas_.end(), area);
  return std::clamp(static_cast<int>(above - areas_.begin()) - 1, 0, num_stages() - 2);
}

double TornEnergy::share_above(double area) const noexcept {
  const int below = stage_below(area);
  return std::clamp((area - areas_[static_cast<std::size_t>(below)]) / width(below), 0.0, 1.0);
}

TornEnergy::Jet TornEnergy::secant(const Around& around, int below) const noexcept {
  const auto jet = [&](int stage) -> Jet {
    const TouchResult& at = around.at[static_cast<std::size_t>(stage - around.first)];
    return {at.energy, at.force, at.stiffness};
  };
  return (1 / width(below)) * (jet(below + 1) + -1 * jet(below));
}

TornEnergy::Jet TornEnergy::slope(const Around& around, int stage) const noexcept {
  const int last = num_stages() - 1;
  // In truth G is 0 where there is no cut, and grows with it. By the secant it is what decides
  // whether a tear begins.
  if (stage == 0 || last == 1) return secant(around, 0);
  if (stage == last) {
    // The parabola through three stages, where it falls, and not more than three times as steeply
    // as the nearest secant.
    const Jet nearest = secant(around, last - 1);
    const double w = width(last - 1);
    const double v = width(last - 2);
    const Jet slope = ((2 * w + v) / (w + v)) * nearest + (-w / (w + v)) * secant(around, last - 2);
    if (!(slope.value * nearest.value > 0)) return {};
    return std::abs(slope.value) > 3 * std::abs(nearest.value) ? 3 * nearest : slope;
  }
  const Jet a = secant(around, stage - 1);
  const Jet b = secant(around, stage);
  if (!(a.value * b.value > 0)) return {};
  // The weighted harmonic mean W/(p/a + q/b).
  const double p = width(stage - 1) + 2 * width(stage);
  const double q = 2 * width(stage - 1) + width(stage);
  const double whole = p + q;
  const double sum = p / a.value + q / b.value;
  const double by_a = p / (a.value * a.value);
  const double by_b = q / (b.value * b.value);
  const double first = whole / (sum * sum);
  const double second = 2 * first / sum;
  const auto outer = [](const Vec3& x, const Vec3& y) -> Mat3 { return x * y.transpose(); };
  const Mat3 mixed = outer(a.gradient, b.gradient);
  Jet slope;
  slope.value = whole / sum;
  slope.gradient = first * (by_a * a.gradient + by_b * b.gradient);
  slope.hessian =
      first * (by_a * a.hessian + by_b * b.hessian) +
      (second * by_a * by_a - 2 * first * by_a / a.value) * outer(a.gradient, a.gradient) +
      (second * by_b * by_b - 2 * first * by_b / b.value) * outer(b.gradient, b.gradient) +
      second * by_a * by_b * (mixed + mixed.transpose());
  return slope;
}

TornEnergy::Cubic TornEnergy::cubic(const Around& around) const noexcept {
  const int below = around.below;
  const double w = width(below);
  const TouchResult& at = around.at[static_cast<std::size_t>(below - around.first)];
  const Jet rise = w * secant(around, below);
  const Jet here = w * slope(around, below);
  const Jet there = w * slope(around, below + 1);
  return {{Jet{at.energy, at.force, at.stiffness}, here, 3 * rise + -2 * here + -1 * there,
           -2 * rise + here + there},
          w};
}

TornResult TornEnergy::interpolate(const Around& around, double area) const noexcept {
  const Cubic energy = cubic(around);
  const double s = share_above(area);
  const Jet at = energy.at(s);
  TornResult result;
  result.touch = TouchResult::empty_sum();
  const auto below = static_cast<std::size_t>(around.below - around.first);
  for (const auto& [weight, of] :
       {std::pair(1 - s, &around.at[below]), std::pair(s, &around.at[below + 1])}) {
    if (weight > 0) result.touch.add(weight, *of);
  }
  result.touch.energy = at.value;
  result.touch.force = at.gradient;
  result.touch.stiffness = at.hessian;
  result.release_rate = energy.release_rate(s);
  return result;
}

double TornEnergy::tear_within(const Around& around, double area, double toughness) const noexcept {
  const Cubic energy = cubic(around);
  const auto below = static_cast<std::size_t>(around.below);
  const double s = share_above(area);
  // Where it came to rest at G = G_c, rounding must not let it go on.
  if (!(energy.release_rate(s) > (1 + kBalanced) * toughness)) {
    // It rests here, unless the whole step to the next stage pays for itself.
    const double released = energy.at(s).value - energy.at(1).value;
    return released >= toughness * (areas_[below + 1] - area) ? areas_[below + 1] : area;
  }
  // The first s' > s with G = G_c: c_1 + G_c w + 2 c_2 s' + 3 c_3 s'² = 0.
  const double a = 3 * energy.c[3].value;
  const double b = energy.c[2].value;
  const double c = energy.c[1].value + toughness * energy.width;
  const double root = b * b - a * c;
  double first = 1;
  if (root >= 0) {
    // Both roots without cancellation.
    const double q = -(b + std::copysign(std::sqrt(root), b));
    for (const double at : {q / a, c / q}) {
      if (std::isfinite(at) && at > s && at < first) first = at;
    }
  }
  return first < 1 ? areas_[below] + first * energy.width : areas_[below + 1];
}

}  // namespace palpate
