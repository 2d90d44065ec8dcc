// SPDX-License-Identifier: BSD-3-Clause
// How far the tool may be moved without touching the body. The clearance c changes by no more than
// the distance: |c(q) − c(p)| ≤ |q − p|.
#pragma once

#include "base/types.h"
#include "state_space/touch_space.h"

namespace palpate {

/// Tells for a series of places whether the tool touches nothing there. It evaluates the clearance
/// only where the distance from the last evaluation does not decide.
class ClearanceProbe {
 public:
  /// @param clearance A function that is not empty.
  /// @param first The place of the first evaluation.
  ClearanceProbe(const Clearance& clearance, const Vec3& first)
      : clearance_(clearance), place_(first), value_(clearance(first)) {}

  [[nodiscard]] double value() const { return value_; }

  [[nodiscard]] bool is_free(const Vec3& q) {
    const double way = (q - place_).norm();
    if (value_ - way > 0) return true;
    if (value_ + way <= 0) return false;
    place_ = q;
    value_ = clearance_(q);
    return value_ > 0;
  }

 private:
  const Clearance& clearance_;
  /// Place and value of the last evaluation.
  Vec3 place_;
  double value_;
};

/// The same clearance, which remembers its answers: the grid of a space that grows asks for the
/// same places with each chunk. Several threads may ask at the same time.
[[nodiscard]] Clearance remembering(Clearance clearance);

}  // namespace palpate
