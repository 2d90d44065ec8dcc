// SPDX-License-Identifier: BSD-3-Clause
// A hand that palpates at random, tick by tick: it glides over the surface, its velocity is
// forgotten within 0.35 s, and it presses 1 to 7 mm deep.
#pragma once

#include <cmath>
#include <random>

#include "following/hand_prediction.h"
#include "interaction/tool_clearance.h"

namespace palpate {

class PalpatingHand {
 public:
  PalpatingHand(const ToolClearance& clearance, const Vec3& middle, double extent, double speed,
                unsigned seed)
      : clearance_(clearance), middle_(middle), extent_(extent), speed_(speed), random_(seed) {
    place_ = at_depth(middle, kDepth);
  }

  [[nodiscard]] HandMotion next() {
    std::normal_distribution<double> normal;
    const double forgets = std::exp(-kTick / kKeepsVelocity);
    const double stirs = std::sqrt(1 - forgets * forgets);
    for (int k = 0; k < 4; ++k) state_[k] = forgets * state_[k] + stirs * normal(random_);
    const ToolClearance::Approach approach = clearance_.approach(place_);
    Vec3 way = state_.head<3>();
    way -= way.dot(approach.out) * approach.out;
    // It comes back from the border of where it palpates.
    const Vec3 off = approach.touched - middle_;
    if (off.norm() > extent_ && way.dot(off) > 0) {
      way -= 2 * way.dot(off) / off.squaredNorm() * off;
      state_.head<3>() = way;
    }
    // Of a vector with two components of unit variance, the root mean square is √2.
    const Vec3 aside = place_ + speed_ / std::sqrt(2.0) * kTick * way;
    const double depth = kDepth + kDepthChange * std::tanh(state_[3]);
    const Vec3 next = at_depth(aside, depth);
    // What jumps at a ridge is no motion of a hand.
    const double far = (next - place_).norm() / (3 * speed_ * kTick);
    const Vec3 moved = far > 1 ? Vec3(place_ + (next - place_) / far) : next;
    const Vec3 velocity = (moved - place_) / kTick;
    velocity_ += kTick / kSmoothing * (velocity - velocity_);
    place_ = moved;
    return {place_, velocity_};
  }

  static constexpr double kTick = 1e-3;

 private:
  static constexpr double kKeepsVelocity = 0.35;
  /// The mean depth, and how far it goes to both sides, m.
  static constexpr double kDepth = 4e-3;
  static constexpr double kDepthChange = 3e-3;
  /// The servo tells a velocity of about this age, s.
  static constexpr double kSmoothing = 0.02;

  [[nodiscard]] Vec3 at_depth(const Vec3& near, double depth) const {
    const ToolClearance::Approach approach = clearance_.approach(near);
    return clearance_.pressed(approach.touched, approach.out, depth);
  }

  const ToolClearance& clearance_;
  Vec3 middle_;
  double extent_;
  double speed_;
  std::mt19937 random_;
  /// Of the velocity, and of the depth.
  Eigen::Vector4d state_ = Eigen::Vector4d::Zero();
  Vec3 place_;
  Vec3 velocity_ = Vec3::Zero();
};

}  // namespace palpate
