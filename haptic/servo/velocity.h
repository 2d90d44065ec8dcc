// SPDX-License-Identifier: BSD-3-Clause
// The velocity of a position that is known in steps: over the longest time in which a straight line
// explains what was measured [JHC]. At rest it is exactly zero, and in fast motion as prompt as a
// difference.
//
// [JHC] Janabi-Sharifi, Hayward & Chen, Discrete-Time Adaptive Windowing for Velocity Estimation,
// IEEE Transactions on Control Systems Technology 8(6), 2000.
#pragma once

#include <array>

#include "base/types.h"

namespace palpate {

class VelocityEstimator {
 public:
  /// @param step Of the position, m: a line may miss what was measured by that much.
  explicit VelocityEstimator(double step) : step_(step) {}

  /// Takes the next position, m.
  /// @param interval Since the last one, s; where it is not positive the last velocity stays.
  /// @return Velocity [3], m/s.
  /// @note Realtime-safe.
  const Vec3& add(const Vec3& position, double interval) noexcept;

  /// Nothing is known.
  void reset() noexcept;

 private:
  /// Measured positions at the most.
  static constexpr int kWindow = 16;

  [[nodiscard]] double along(int axis) const noexcept;
  [[nodiscard]] int back(int ago) const noexcept { return (newest_ + kWindow - ago) % kWindow; }

  double step_;
  std::array<Vec3, kWindow> positions_{};
  /// Of each, since the estimator began, s.
  std::array<double, kWindow> times_{};
  int newest_ = 0;
  int num_ = 0;
  Vec3 velocity_ = Vec3::Zero();
};

}  // namespace palpate
