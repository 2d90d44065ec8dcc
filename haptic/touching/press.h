// SPDX-License-Identifier: BSD-3-Clause
// A rigid tool that presses a body anywhere and glides on it.
//
// Without friction and coupling, the hand at x feels the force of the tool space there, f = −h(x).
// A coupling holds the tool at the place p where it is in balance with h (balance.h). Friction
// (friction.h) adds the force Q by which the sheared body under the tool resists the hand,
//
//   f = −(h(p) + Q),   Q along the surface.
//
// The tool begins to press when it comes from where it is free into a cell of the space, or within
// a quarter of a cell beside one. It goes on deeper than the space does, as the interpolation goes
// on (interpolator.h), and the force limit of the device bounds the force there. Where it has gone
// aside by more than a cell, and by more than it has gone deeper, the space knows nothing of the
// body, and the force ends. The force also ends where a solve of the space has failed and the
// extrapolation gives zero: the tool has gone through the surface, and nothing proves that it is
// free.
//
// Where the body has several equilibria it stays on the branch on which the tool came, as long as
// that goes on. A tool that becomes free begins anew.
#pragma once

#include "haptic/touching/contact.h"
#include "haptic/touching/friction.h"
#include "haptic/touching/settings.h"
#include "interpolation/tool_force.h"

namespace palpate {

class Press {
 public:
  /// Ends the contact.
  /// @note Realtime-safe.
  void release() noexcept { *this = Press(); }

  /// Moves the hand.
  /// @param force The force on the rigid tool, by its place.
  /// @note A space that was replaced may number its branches differently: call find_branch() first.
  /// @returns A contact whose status is free, pressing, or inside: there the tool may touch, but
  ///   the space has no force for it. While the tool does not press, the caller has to fill in
  ///   distance and anchor.
  /// @note Realtime-safe.
  [[nodiscard]] Contact move(const ToolForce& force, const Vec3& hand,
                             const TouchSettings& settings) noexcept;
  /// Finds the branch of another space that is nearest to the force that was felt last.
  /// @note Realtime-safe.
  void find_branch(const ToolForce& force) noexcept;

 private:
  /// Finds the tool's place from that of the hand, and gives the answer of the body there.
  [[nodiscard]] TouchResult answer(const ToolForce& force, double coupling) noexcept;
  /// Whether nothing touches the tool where it feels no force.
  [[nodiscard]] bool is_free(const ToolForce& force) const noexcept;
  [[nodiscard]] bool is_known(const ToolForce& force, const Vec3& push) const noexcept;
  /// What is felt where the tool may touch but the space has no force for it: none, until the tool
  /// was free. This is the one place that says what becomes of such a tool.
  [[nodiscard]] Contact miss(Support support) noexcept;

  bool is_pressing_ = false;
  /// The branch that the body is on.
  OnBranch branch_;
  Vec3 hand_ = Vec3::Zero();
  /// The tool's place, m.
  Vec3 place_ = Vec3::Zero();
  /// The force that holds it there, N.
  Vec3 holding_ = Vec3::Zero();
  /// With a coupling: where the hand was when place_ was found, and ∂place_/∂hand.
  Vec3 held_ = Vec3::Zero();
  Mat3 followed_ = Mat3::Zero();
  Friction friction_;
};

}  // namespace palpate
