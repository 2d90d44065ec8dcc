// SPDX-License-Identifier: BSD-3-Clause
// Where a hand may be soon. Its velocity v may change, so that after a time τ it is within
//
//   |x − (p + v τ)| ≤ ½ a τ²,   a = (|v| + v₀) / T
//
// with the time T over which a hand keeps its velocity, and a speed v₀ that a hand at rest may
// take up.
#pragma once

#include <Eigen/Geometry>

#include "base/types.h"

namespace palpate {

/// The hand, as the tool's coordinates.
struct HandMotion {
  /// m
  Vec3 place = Vec3::Zero();
  /// m/s
  Vec3 velocity = Vec3::Zero();
};

struct PredictionOptions {
  /// How far the prediction looks ahead, s.
  double horizon = 0.4;
  /// T, s. Palpating hands turn around two or three times a second.
  double keeps_velocity = 0.35;
  /// v₀, m/s.
  double from_rest = 0.02;
};

class HandPrediction {
 public:
  explicit HandPrediction(const HandMotion& hand, const PredictionOptions& options = {});

  [[nodiscard]] const HandMotion& hand() const { return hand_; }
  /// The least time after which the hand may be in a box, s; infinite: it is beyond the horizon.
  [[nodiscard]] double time_until(const Eigen::AlignedBox3d& box) const;
  /// The box in which the hand may be within the horizon, m.
  [[nodiscard]] Eigen::AlignedBox3d box() const;

 private:
  /// How far the hand is from being in the box after a time, m; 0 or less: it may be in it.
  [[nodiscard]] double gap(const Eigen::AlignedBox3d& box, double time) const;

  HandMotion hand_;
  PredictionOptions options_;
  double acceleration_;
};

}  // namespace palpate
