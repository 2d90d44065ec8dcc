// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/transport/simulated_hand.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "base/error.h"
#include "base/quantity.h"

namespace palpate {
namespace {

/// The step is short beside every time constant of a hand (the shortest, m/b, is some 100 ms) and
/// of a body that a device can display.
constexpr Duration kStep = std::chrono::microseconds(20);

void check(const char* name, double value, bool positive) {
  if (std::isfinite(value) && (positive ? value > 0 : value >= 0)) return;
  throw InputError(std::string("The ") + name + " of the simulated hand is " + quantity(value) +
                   ". Give " + (positive ? "more than 0." : "0 or more."));
}

}  // namespace

SimulatedHand::SimulatedHand(std::shared_ptr<Motion> wish, const HandOptions& options)
    : wish_(std::move(wish)), options_(options) {
  check("device's mass", options.device_mass, true);
  check("mass", options.hand_mass, false);
  check("device's damping", options.device_damping, false);
  check("damping", options.hand_damping, false);
  check("stiffness", options.hand_stiffness, false);
}

// Integrates by semi-implicit Euler, which makes no energy at steps of this size. The place that
// the person wants moves evenly meanwhile.
Motion::Pose SimulatedHand::advance(Time time, const Vec3& force) noexcept {
  Pose pose = wish_->advance(time, force);
  if (!begun_) {
    begun_ = true;
    time_ = time;
    position_ = wished_ = pose.position;
  }
  const double whole = seconds(time - time_);
  const Vec3 wished_velocity = whole > 0 ? Vec3((pose.position - wished_) / whole) : Vec3::Zero();
  const double mass = options_.device_mass + options_.hand_mass;
  while (time_ < time) {
    const Duration step = std::min(kStep, Duration(time - time_));
    const double dt = seconds(step);
    wished_ += wished_velocity * dt;
    const Vec3 acceleration = (force - options_.device_damping * velocity_ +
                               options_.hand_stiffness * (wished_ - position_) +
                               options_.hand_damping * (wished_velocity - velocity_)) /
                              mass;
    velocity_ += acceleration * dt;
    position_ += velocity_ * dt;
    time_ += step;
  }
  wished_ = pose.position;
  pose.position = position_;
  return pose;
}

}  // namespace palpate
