// SPDX-License-Identifier: BSD-3-Clause
// A rigid tool that presses a body anywhere and glides on it.
//
// Without friction and coupling what is felt where the hand is, at x, is the force of the space of
// configurations there, f = −h(x). A coupling holds the tool at the place p where it is in balance
// with h (balance.h). Friction (friction.h) adds what the shear of the body under the tool holds
// against the hand,
//
//   f = −(h(p) + Q),   Q along the surface.
//
// It begins to press where the space has a cell, or a quarter of one beside, coming from where it
// is free. It goes on deeper than the space does, as the interpolation goes on (interpolator.h),
// where the force limit of the device rules; but where it has gone aside, by more than a cell and
// more than deeper, the space knows nothing of the body, and the force ends. So it does where a
// solve of the space has failed, and what is extrapolated there is zero: the tool has gone through
// the surface, and nothing says that it is free.
#pragma once

#include "haptic/touching/contact.h"
#include "haptic/touching/friction.h"
#include "haptic/touching/settings.h"
#include "interpolation/interpolator.h"

namespace palpate {

class Press {
 public:
  /// The tool is not in contact.
  /// @note Realtime-safe.
  void release() noexcept { *this = Press(); }

  /// Moves the hand.
  /// @param force Of the rigid tool by its place.
  /// @returns status: free; pressing; or inside, where it may touch, but the space has no force
  ///   for it. Of what it touches nothing, distance and anchor are left as they are.
  /// @note Realtime-safe.
  [[nodiscard]] Contact move(const Interpolator& force, const Vec3& hand,
                             const TouchSettings& settings) noexcept;

 private:
  /// What answers at the tool's place, which follows from that of the hand.
  [[nodiscard]] TouchResult answer(const Interpolator& force, double coupling) noexcept;
  [[nodiscard]] bool is_known(const Interpolator& force, const Vec3& push) const noexcept;

  bool is_pressing_ = false;
  Vec3 hand_ = Vec3::Zero();
  /// Of the tool, m.
  Vec3 place_ = Vec3::Zero();
  /// With a coupling: where the hand was when place_ was found, and ∂place_/∂hand.
  Vec3 held_ = Vec3::Zero();
  Mat3 followed_ = Mat3::Zero();
  Friction friction_;
};

}  // namespace palpate
