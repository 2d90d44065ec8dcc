// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/touching/friction.h"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

/// The least k_n of a contact that begins, N/m.
constexpr double kLeastStiffness = 1e-3;

}  // namespace

void Friction::move(const Vec3& moved, double coefficient, const Vec3& push, double stiffness,
                    double coupling) noexcept {
  const bool begins = shear_ == 0;
  const double size = push.norm();
  const Vec3 normal = push / size;
  if (!begins) stretch_ += moved;
  stretch_ -= normal * normal.dot(stretch_);
  const double length = stretch_.norm();
  // This is the force by the law as it was, after the motion of the hand.
  const double given = traction(length);
  if (begins || stiffness > 0) {
    const double pressed = std::max(stiffness, kLeastStiffness);
    pressed_ = begins ? pressed
                      : std::min(std::max(pressed_, pressed / (1 + kPlay)), pressed / (1 - kPlay));
  }
  shear_ = kShearRatio * pressed_;
  if (coupling > 0) shear_ = shear_ * coupling / (shear_ + coupling);
  most_ = coefficient * size;
  const double own = std::min(length, longest());
  const double kept = traction(own) > given ? std::min(own, stretch_of(given)) : own;
  if (length > 0) stretch_ *= kept / length;
}

double Friction::traction(double stretch) const noexcept {
  const double longest = this->longest();
  if (longest <= 0) return 0;
  const double left = 1 - std::min(stretch / longest, 1.0);
  return most_ * (1 - left * std::sqrt(left));
}

double Friction::stretch_of(double traction) const noexcept {
  const double left = std::cbrt(1 - std::min(traction / most_, 1.0));
  return longest() * (1 - left * left);
}

Vec3 Friction::force() const noexcept {
  const double length = stretch_.norm();
  return length > 0 ? Vec3(stretch_ * (traction(length) / length)) : Vec3::Zero();
}

double Friction::stiffness() const noexcept {
  const double longest = this->longest();
  if (longest <= 0) return 0;
  return shear_ * std::sqrt(1 - std::min(stretch_.norm() / longest, 1.0));
}

double Friction::energy() const noexcept {
  const double longest = this->longest();
  if (longest <= 0) return 0;
  const double s = std::min(stretch_.norm() / longest, 1.0);
  const double left = 1 - s;
  return most_ * longest * (s - 0.4 * (1 - left * left * std::sqrt(left)));
}

}  // namespace palpate
