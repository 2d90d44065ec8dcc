// SPDX-License-Identifier: BSD-3-Clause
// The tool as it moves: free, bonded to the body (hold.h), or pressing it (press.h).
//
// The tool touches a body only after it has come from outside. Where the body has a tool space of a
// rigid tool, the tool presses and glides, and holds an active node while it grasps. Otherwise the
// tool is bonded to the place where it comes in.
#pragma once

#include "haptic/touching/contact.h"
#include "haptic/touching/hold.h"
#include "haptic/touching/press.h"
#include "haptic/touching/settings.h"
#include "haptic/touching/touchable.h"

namespace palpate {

class Tool {
 public:
  /// Moves the tool to a place, m.
  /// @param body The body; nullptr: there is none. When the body is replaced by another one of the
  ///   same scene, the tool goes on touching. It lets go when the new body is of another scene or
  ///   lacks the nodes that are held.
  /// @param grasps A rigid tool that presses takes hold of the active node there, as a bonded tool
  ///   does, and lets go of it when this is false again.
  /// @note Realtime-safe.
  [[nodiscard]] Contact move(const Touchable* body, const Vec3& place,
                             const TouchSettings& settings, bool grasps = false) noexcept;

  /// Lets go, and touches again only after it was outside.
  /// @note Realtime-safe.
  void release() noexcept;

 private:
  void take_over(const Touchable* body) noexcept;
  [[nodiscard]] Contact move_bonded(const Vec3& place, const TouchSettings& settings) noexcept;
  [[nodiscard]] Contact move_rigid(const Vec3& place, const TouchSettings& settings,
                                   bool grasps) noexcept;
  [[nodiscard]] SurfaceTree::Nearest nearest(const Vec3& place) noexcept;
  [[nodiscard]] bool grasp(const Contact& pressing, const TouchSettings& settings,
                           const Vec3& place) noexcept;

  const Touchable* body_ = nullptr;
  /// Whether the tool was outside since it last let go.
  bool armed_ = false;
  /// Whether the tool has lost the node that it grasped, while it is still asked to grasp.
  bool has_lost_ = false;
  Hold hold_;
  Press press_;
  Index last_triangle_ = -1;
};

}  // namespace palpate
