// SPDX-License-Identifier: BSD-3-Clause
// The velocity of a position that is measured in steps. It is taken over the longest time in which
// a straight line fits the measurements [JHC]. At rest it is exactly zero, and in fast motion it is
// as prompt as a difference.
//
// [JHC] Janabi-Sharifi, Hayward & Chen, Discrete-Time Adaptive Windowing for Velocity Estimation,
// IEEE Transactions on Control Systems Technology 8(6), 2000.
#pragma once

#include <array>

#include "base/types.h"

namespace palpate {

class VelocityEstimator {
 public:
  /// @param step The step of the position, m. The line may miss a measurement by that much.
  explicit VelocityEstimator(double step) : step_(step) {}

  /// Adds the next position, m.
  /// @param interval The time since the last position, s; where it is not positive the velocity
  ///   stays as it was.
  /// @return Velocity [3], m/s.
  /// @note Realtime-safe.
  const Vec3& add(const Vec3& position, double interval) noexcept;

  /// Forgets all positions.
  void reset() noexcept;

 private:
  /// The largest number of positions that are kept.
  static constexpr int kWindow = 16;

  [[nodiscard]] double along(int axis) const noexcept;
  [[nodiscard]] int back(int ago) const noexcept { return (newest_ + kWindow - ago) % kWindow; }

  double step_;
  std::array<Vec3, kWindow> positions_{};
  /// The time of each position since the estimator began, s.
  std::array<double, kWindow> times_{};
  int newest_ = 0;
  int num_ = 0;
  Vec3 velocity_ = Vec3::Zero();
};

}  // namespace palpate
