// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/servo/velocity.h"

#include <algorithm>
#include <cmath>

namespace palpate {

void VelocityEstimator::reset() noexcept {
  num_ = 0;
  velocity_.setZero();
}

const Vec3& VelocityEstimator::add(const Vec3& position, double interval) noexcept {
  if (num_ > 0 && !(interval > 0)) return velocity_;
  const double time = num_ > 0 ? times_[newest_] + interval : 0;
  newest_ = (newest_ + 1) % kWindow;
  positions_[newest_] = position;
  times_[newest_] = time;
  num_ = std::min(num_ + 1, kWindow);
  for (int axis = 0; axis < 3; ++axis) velocity_[axis] = along(axis);
  return velocity_;
}

double VelocityEstimator::along(int axis) const noexcept {
  const double x = positions_[newest_][axis];
  const double time = times_[newest_];
  double velocity = 0;
  for (int ago = 1; ago < num_; ++ago) {
    const double slope = (x - positions_[back(ago)][axis]) / (time - times_[back(ago)]);
    for (int between = 1; between < ago; ++between) {
      const double line = x - slope * (time - times_[back(between)]);
      if (std::abs(line - positions_[back(between)][axis]) > step_) return velocity;
    }
    velocity = slope;
  }
  return velocity;
}

}  // namespace palpate
