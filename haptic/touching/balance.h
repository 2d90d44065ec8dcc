// SPDX-License-Identifier: BSD-3-Clause
// The balance of a body and the virtual coupling by which the tool is held.
//
// The coupling is a spring of stiffness c between the hand at y and the tool at x. The body pushes
// the tool with h(x) = ∇Π(x), and x is where φ(x) = Π(x) + ½ c |y − x|² has its minimum. The hand
// feels f = −c (y − x), and so never a stiffness above c.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "interpolation/interpolator.h"

namespace palpate {

/// Finds x by Newton's method. A step is halved until φ falls or, near the minimum, where rounding
/// hides the change of φ, until the residual falls. It takes a few steps at most; the next ticks
/// make up for what is left.
/// @param evaluate x → TouchResult.
/// @param x A first guess of the tool's place; then the place that was found, m.
/// @returns Energy, force and stiffness of the body there.
/// @note Realtime-safe.
template <class Evaluate>
[[nodiscard]] TouchResult balance(const Evaluate& evaluate, const Vec3& y, double coupling,
                                  Vec3& x) noexcept {
  constexpr int kMostSteps = 4;
  constexpr int kMostHalvings = 4;
  // The balance is good enough when the residual is this share of the coupling's force: far below
  // the steps of force of a device, and far above what rounding leaves.
  constexpr double kBalanced = 1e-8;
  const auto potential = [&](const TouchResult& at, const Vec3& where) {
    return at.energy + 0.5 * coupling * (y - where).squaredNorm();
  };
  TouchResult here = evaluate(x);
  for (int step = 0; step < kMostSteps; ++step) {
    const Vec3 pull = coupling * (y - x);
    const Vec3 residual = pull - here.force;
    if (residual.squaredNorm() <= kBalanced * kBalanced * pull.squaredNorm()) break;
    Mat3 tangent = here.stiffness;
    tangent.diagonal().array() += coupling;
    const Eigen::LDLT<Mat3> factor(tangent);
    // Where the body gives way faster than the coupling holds, Newton's step leads to no minimum. A
    // step by the coupling's own stiffness leads down all the same.
    Vec3 direction = factor.isPositive() ? Vec3(factor.solve(residual)) : Vec3(residual / coupling);
    if (!direction.allFinite()) break;
    const double before = potential(here, x);
    bool lower = false;
    for (int halving = 0; halving <= kMostHalvings && !lower; ++halving, direction /= 2) {
      const TouchResult there = evaluate(x + direction);
      lower = potential(there, x + direction) < before ||
              (coupling * (y - x - direction) - there.force).squaredNorm() <
                  0.25 * residual.squaredNorm();
      if (!lower) continue;
      x += direction;
      here = there;
    }
    if (!lower) break;
  }
  return here;
}

/// ∂x/∂y of the balance; zero where the tangent is singular, so that no motion is predicted.
/// @note Realtime-safe.
[[nodiscard]] inline Mat3 followed(const Mat3& stiffness, double coupling) noexcept {
  Mat3 tangent = stiffness;
  tangent.diagonal().array() += coupling;
  const Mat3 follows = coupling * tangent.inverse();
  return follows.allFinite() ? follows : Mat3::Zero();
}

}  // namespace palpate
