// SPDX-License-Identifier: BSD-3-Clause
// The servo loop's end of the virtual coupling (simulated_tool.h).
//
// Between two steps of the body its tool goes on with the velocity of the last one, for one step at
// the most, and the hand feels
//
//   f = −c (p − d(t)) − b (ṗ − ḋ).
//
// A hand takes hold where it is: p begins at d, so that the force begins at zero. It takes hold
// within the tool's reach while it grasps, having been outside before: farther away, or not
// grasping.
//
// What the coupling stores, and what has gone through it into the body since the hand took hold, is
//
//   E = ½ c |p − d|² + ∫ h · ḋ dt.
//
// What the hand puts in beyond it, the coupling dissipates; if less, the sampled coupling has made
// energy (energy_balance.h), whatever the body and its other tools do.
#pragma once

#include "haptic/simulating/simulated_tool.h"
#include "haptic/touching/contact.h"

namespace palpate {

class CoupledTool {
 public:
  /// Takes the newest answer of the body.
  /// @param tool Another one than before is not held; nullptr: there is none.
  /// @return Whether the body goes on: it was stepped not long ago. @note Realtime-safe.
  bool listen(SimulatedTool* tool, Time now) noexcept;

  /// Takes the hand to a place, and tells the body.
  /// @param place, velocity Of the hand, m and m/s.
  /// @return status: nothing, where there is no tool; free, outside; inside, where the hand is
  /// within
  ///   reach but has let go for another reason; or attached. Then anchor is the tool's place at
  ///   rest, displacement d, energy E, and support is extrapolated where the trust is above
  ///   kLargestTrusted or the body stands still.
  /// @note Realtime-safe.
  [[nodiscard]] Contact move(const Vec3& place, const Vec3& velocity, bool grasps,
                             Time now) noexcept;

  /// Lets go, and takes hold again only after it was outside. @note Realtime-safe.
  void release() noexcept;

 private:
  [[nodiscard]] Contact answer(const Vec3& velocity, Time now) const noexcept;

  SimulatedTool* tool_ = nullptr;
  ToolAnswer answer_;
  bool is_alive_ = false;
  bool armed_ = false;
  bool holds_ = false;
  /// p, and what is to be taken off the hand's place for it.
  Vec3 hand_ = Vec3::Zero();
  Vec3 offset_ = Vec3::Zero();
  /// ToolAnswer::work when the hand took hold.
  double work_before_ = 0;
};

}  // namespace palpate
