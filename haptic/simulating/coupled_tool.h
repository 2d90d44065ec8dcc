// SPDX-License-Identifier: BSD-3-Clause
// The servo loop's end of the virtual coupling (simulated_tool.h).
//
// Between two steps of the body, its tool goes on with the velocity of the last step, for the
// length of one step at most. The hand feels
//
//   f = −c (p − d(t)) − b (ṗ − ḋ).
//
// A hand takes hold wherever it is: p begins at d, so that the force begins at zero. It takes hold
// while it grasps within the tool's reach, and only after it was outside: farther away, or not
// grasping.
//
// The energy that the coupling stores, and the work that has gone through it into the body since
// the hand took hold, are together
//
//   E = ½ c |p − d|² + ∫ h · ḋ dt.
//
// Where the hand puts in more than E, the coupling dissipates the rest. Where it puts in less, the
// sampled coupling has made energy (energy_balance.h), whatever the body and its other tools do.
#pragma once

#include "haptic/simulating/simulated_tool.h"
#include "haptic/touching/contact.h"

namespace palpate {

class CoupledTool {
 public:
  /// Takes the newest answer of the body.
  /// @param tool The tool; one that is new is not held. nullptr: there is none.
  /// @return Whether the body was stepped within release_after; true without a tool.
  /// @note Realtime-safe.
  bool listen(SimulatedTool* tool, Time now) noexcept;

  /// Moves the hand to a place, and tells the body.
  /// @param place, velocity Those of the hand, m and m/s.
  /// @return A contact. Its status is `nothing` without a tool, `free` outside, `inside` within
  ///   reach where the hand has let go for another reason than opening, or `attached`. Then anchor
  ///   is the tool's place at rest, displacement is d, and energy is E; support is `extrapolated`
  ///   where the trust is above kLargestTrusted or the body stands still.
  /// @note Realtime-safe.
  [[nodiscard]] Contact move(const Vec3& place, const Vec3& velocity, bool grasps,
                             Time now) noexcept;

  /// Lets go. The hand takes hold again only after it was outside. @note Realtime-safe.
  void release() noexcept;

 private:
  [[nodiscard]] Contact answer(const Vec3& velocity, Time now) const noexcept;

  SimulatedTool* tool_ = nullptr;
  ToolAnswer answer_;
  bool is_alive_ = false;
  bool armed_ = false;
  bool holds_ = false;
  /// p, and the hand's place from the tool's place at rest less p, m.
  Vec3 hand_ = Vec3::Zero();
  Vec3 offset_ = Vec3::Zero();
  /// ToolAnswer::work when the hand took hold.
  double work_before_ = 0;
};

}  // namespace palpate
