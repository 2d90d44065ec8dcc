// SPDX-License-Identifier: BSD-3-Clause
// What one point of contact sees of another one, j from i (soft_contact.h):
//
//   m = w_j k s,   k = ⟨1 − |r|²/ρ²⟩⁴,   s = s(−n_i · n_j),   g = n_j · r,   r = x_i − x_j
//
// and the derivatives of  by_s m + by_p m g  by place and normal of the two. k and s are the same
// from j.
#pragma once

#include "soft_contact/contact_points.h"

namespace palpate {

/// −n_i · n_j from which on two points face each other fully.
inline constexpr double kFullyFacing = 0.5;

/// A step from 0 to 1 with three derivatives that are continuous, t⁴ (35 − 84 t + 70 t² − 20 t³).
struct SmoothStep {
  double value, slope, curvature;
};

[[nodiscard]] inline SmoothStep smooth_step(double t) {
  if (t <= 0) return {0, 0, 0};
  if (t >= 1) return {1, 0, 0};
  const double r = 1 - t;
  const double t3 = t * t * t;
  return {t3 * t * (35 + t * (-84 + t * (70 - 20 * t))), 140 * t3 * r * r * r,
          420 * t * t * r * r * (1 - 2 * t)};
}

/// s, by −n_i · n_j.
[[nodiscard]] inline SmoothStep facing_step(double facing) {
  SmoothStep step = smooth_step(facing / kFullyFacing);
  step.slope /= kFullyFacing;
  step.curvature /= kFullyFacing * kFullyFacing;
  return step;
}

/// Place and normal of a point, and its area at rest.
struct SeenPoint {
  Vec3 place;
  Vec3 normal;
  double area;
};

/// What the weights of two points have in common. The signs of r are those of i.
struct CommonTerms {
  Vec3 r;
  double kernel;
  /// ∂k/∂r = by_r r, and ∂²k/∂r² = by_r I + by_rr r rᵀ.
  double by_r, by_rr;
  SmoothStep facing;
};

/// @param t 1 − |r|²/ρ², positive.
/// @param facing −n_i · n_j, positive.
[[nodiscard]] inline CommonTerms common_terms(const SeenPoint& i, const SeenPoint& j, double t,
                                              double facing, double reach) {
  const double inverse = 1 / (reach * reach);
  const double t2 = t * t;
  return {i.place - j.place, t2 * t2, -8 * t2 * t * inverse, 48 * t2 * inverse * inverse,
          facing_step(facing)};
}

/// The factors of Dm and of D(m g).
struct PairFactors {
  double by_s, by_p;
};

/// The derivative by place and normal of i and j.
struct PairGradient {
  Vec6 i, j;
};

/// by_s Dm + by_p D(m g), as j is seen from i.
/// @param r x_i − x_j: that of the common terms, or its opposite.
[[nodiscard]] inline PairGradient gradient_of(const CommonTerms& pair, const Vec3& r,
                                              const SeenPoint& i, const SeenPoint& j,
                                              const PairFactors& factors) {
  const double all = j.area * (factors.by_s + factors.by_p * j.normal.dot(r));
  const double of_g = j.area * factors.by_p * pair.kernel * pair.facing.value;
  const double turned = -all * pair.kernel * pair.facing.slope;
  PairGradient d;
  d.i.head<3>() = (all * pair.facing.value * pair.by_r) * r + of_g * j.normal;
  d.i.tail<3>() = turned * j.normal;
  d.j.head<3>() = -d.i.head<3>();
  d.j.tail<3>() = turned * i.normal + of_g * r;
  return d;
}

/// The second derivative by place and normal of i and j.
struct PairCurvature {
  Mat6 ii, ij, jj;
};

/// by_s D²m + by_p D²(m g), as j is seen from i.
/// @param r As above.
[[nodiscard]] inline PairCurvature curvature_of(const CommonTerms& pair, const Vec3& r,
                                                const SeenPoint& i, const SeenPoint& j,
                                                const PairFactors& factors) {
  const double of_kernel = j.area * pair.kernel;
  const double of_facing = j.area * pair.facing.value;
  const double p = factors.by_p;
  const double all = factors.by_s + p * j.normal.dot(r);
  const double by_facing = -of_kernel * pair.facing.slope;
  const Vec3 m_r = (of_facing * pair.by_r) * r;
  const Vec3 across = (-all * j.area * pair.facing.slope * pair.by_r) * r;
  const double turned = all * of_kernel * pair.facing.curvature;
  const Mat3 of_m = p * m_r * j.normal.transpose();
  Mat3 rr = (all * of_facing * pair.by_rr) * r * r.transpose() + of_m + of_m.transpose();
  rr.diagonal().array() += all * of_facing * pair.by_r;
  const Mat3 ri = (across + (p * by_facing) * j.normal) * j.normal.transpose();
  Mat3 rj = (across + (p * by_facing) * j.normal) * i.normal.transpose() + p * m_r * r.transpose();
  rj.diagonal().array() += p * of_kernel * pair.facing.value;
  const Mat3 turn = (p * by_facing) * i.normal * r.transpose();
  PairCurvature d;
  d.ii.topLeftCorner<3, 3>() = rr;
  d.ii.topRightCorner<3, 3>() = ri;
  d.ii.bottomLeftCorner<3, 3>() = ri.transpose();
  d.ii.bottomRightCorner<3, 3>() = turned * j.normal * j.normal.transpose();
  d.ij.topLeftCorner<3, 3>() = -rr;
  d.ij.topRightCorner<3, 3>() = rj;
  d.ij.bottomLeftCorner<3, 3>() = -ri.transpose();
  d.ij.bottomRightCorner<3, 3>() = j.normal * (turned * i.normal + (p * by_facing) * r).transpose();
  d.ij.bottomRightCorner<3, 3>().diagonal().array() += all * by_facing;
  d.jj.topLeftCorner<3, 3>() = rr;
  d.jj.topRightCorner<3, 3>() = -rj;
  d.jj.bottomLeftCorner<3, 3>() = -rj.transpose();
  d.jj.bottomRightCorner<3, 3>() =
      turned * i.normal * i.normal.transpose() + turn + turn.transpose();
  return d;
}

}  // namespace palpate
