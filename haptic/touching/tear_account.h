// SPDX-License-Identifier: BSD-3-Clause
// What is open of a cut, and what has become of the hand's work.
#pragma once

#include "haptic/touching/contact.h"

namespace palpate {

/// The whole cut opens in so many ticks at the least, so that a hand feels a snap in several.
inline constexpr double kTicksOfTear = 50;

/// @note All functions are realtime-safe.
class TearAccount {
 public:
  /// The area that is open, m². It never becomes less.
  [[nodiscard]] double area() const noexcept { return area_; }

  /// @param toughness What it takes to open an area, J/m².
  void open(double area, double toughness) noexcept {
    torn_work_ += toughness * (area - area_);
    area_ = area;
  }
  void rub(double work) noexcept { friction_work_ += work; }

  /// The hand begins to feel a force at a place, which is zero there.
  void begin(const Vec3& place) noexcept {
    last_place_ = place;
    last_force_.setZero();
  }
  /// The hand has come to a place where it feels a force.
  void follow(const Vec3& place, const Vec3& force) noexcept {
    hand_work_ -= 0.5 * (last_force_ + force).dot(place - last_place_);
    last_place_ = place;
    last_force_ = force;
  }
  /// The force changes while the hand stays where it is.
  void change(const Vec3& force) noexcept { last_force_ = force; }

  void tell(Contact& contact) const noexcept {
    contact.torn_area = area_;
    contact.torn_work = torn_work_;
    contact.friction_work = friction_work_;
    contact.hand_work = hand_work_;
  }

 private:
  double area_ = 0;
  double torn_work_ = 0;
  double friction_work_ = 0;
  double hand_work_ = 0;
  /// The place and the force in the last tick, while the tool touches.
  Vec3 last_place_ = Vec3::Zero();
  Vec3 last_force_ = Vec3::Zero();
};

}  // namespace palpate
