// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/servo/force_limiter.h"

#include "haptic/servo/tick.h"

namespace palpate {
namespace {

/// Shortens v to the largest length, and tells whether it was longer. The length is computed so
/// that the square of no large finite number overflows.
bool cut(Vec3& v, double largest) {
  const double length = v.stableNorm();
  if (!(length > largest)) return false;
  v *= largest / length;
  return true;
}

}  // namespace

Vec3 limit_force(const Vec3& wanted, const Vec3& last, double largest, double step,
                 std::uint32_t& limited) noexcept {
  if (!wanted.allFinite() || !(largest >= 0) || !(step >= 0)) {
    limited |= limits::not_finite;
    return Vec3::Zero();
  }
  Vec3 force = wanted;
  if (cut(force, largest)) limited |= limits::magnitude;
  Vec3 change = force - last;
  if (cut(change, step)) limited |= limits::slew;
  force = last + change;
  // The last force may be above a limit that was lowered since, and the sum is rounded.
  cut(force, largest);
  if (force.allFinite()) return force;
  limited |= limits::not_finite;
  return Vec3::Zero();
}

}  // namespace palpate
