// SPDX-License-Identifier: BSD-3-Clause
// How far the tool may be moved without touching the body, and where it therefore touches nothing.
// The clearance c changes by no more than the way: |c(q) − c(p)| ≤ |q − p|.
#pragma once

#include "base/types.h"
#include "state_space/touch_space.h"

namespace palpate {

/// Tells at one place after another whether the tool touches nothing there. Where the way from the
/// last evaluation decides, there is no other.
class ClearanceProbe {
 public:
  /// @param clearance Not empty. @param first Where it is evaluated to begin with.
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
  /// Of the last evaluation.
  Vec3 place_;
  double value_;
};

}  // namespace palpate
