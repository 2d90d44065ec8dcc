// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/support/mindlin.h"

#include <algorithm>
#include <cmath>

#include "haptic/touching/friction.h"
#include "solvers/support/half_space.h"

namespace palpate::test {
namespace {

constexpr int kSteps = 1500;
/// As far as the tool is moved, in δ_s.
constexpr double kFarthest = 1.5;

}  // namespace

FrictionResult move_aside(const HertzResult& contact, double poissons_ratio, double coefficient) {
  const HertzContact exact = hertz_contact(poissons_ratio);
  const double shear = disc_stiffness(poissons_ratio).along;
  const double most = coefficient * exact.force;
  const double longest = 1.5 * most / shear;

  const Vec3 push = -contact.force * exact.force * Vec3::UnitZ();
  const double stiffness = contact.stiffness * exact.stiffness;
  Friction friction;
  friction.move(Vec3::Zero(), coefficient, push, stiffness, 0);
  FrictionResult result;
  result.stiffness = friction.stiffness() / shear;
  for (int i = 1; i <= kSteps; ++i) {
    friction.move(kFarthest * longest / kSteps * Vec3::UnitX(), coefficient, push, stiffness, 0);
    const double left = std::max(1 - kFarthest * i / kSteps, 0.0);
    const double error = friction.force().x() / most - (1 - std::pow(left, 1.5));
    result.error = std::max(result.error, std::abs(error));
  }
  result.slipping = friction.force().x() / most;
  return result;
}

}  // namespace palpate::test
