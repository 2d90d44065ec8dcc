// SPDX-License-Identifier: BSD-3-Clause
// The tool on its way, free or attached to the body.
//
// Attached at the point a of the surface at rest, the tool at p moves the active nodes there by one
// displacement t, and feels
//
//   f = −h(t),   h = Σ w_n h_n(t) = ∇Π,   Π = Σ w_n Π_n(t),   t = p − a
//
// with the weights w of a in its triangle, or that of the nearest active node alone. The weights
// stay as they are while the tool is attached: if they followed the tool, the force would do work
// around a closed path. The force is zero where the tool comes in, t = 0.
//
// With a coupling of stiffness c the tool holds the nodes by a spring: t is where
// φ(t) = Π(t) + ½ c |p − a − t|² has its minimum, f = −c (p − a − t), and no stiffness above c is
// felt.
#pragma once

#include <array>

#include "haptic/touching/contact.h"
#include "haptic/touching/settings.h"
#include "haptic/touching/touchable.h"

namespace palpate {

class Tool {
 public:
  /// Takes the tool to a place, m.
  /// @param body The body; nullptr: there is none. The tool stays attached when the body is
  ///   replaced by another one of the same scene. It lets go when that is of another scene or lacks
  ///   the nodes that are held.
  /// @note Realtime-safe.
  [[nodiscard]] Contact move(const Touchable* body, const Vec3& place,
                             const TouchSettings& settings) noexcept;

  /// Lets go, and touches again only after it was outside.
  /// @note Realtime-safe.
  void release() noexcept;

 private:
  struct Held {
    Index mesh_point = -1;
    std::int32_t node = -1;
    double weight = 0;
    /// The branch that the body is on.
    int branch = 0;
  };

  void take_over(const Touchable* body) noexcept;
  [[nodiscard]] bool attach(const SurfaceTree::Nearest& at, const TouchSettings& settings) noexcept;
  /// Energy, force that holds, and stiffness at a displacement, with each node on its branch.
  [[nodiscard]] TouchResult evaluate(const Vec3& t) const noexcept;
  /// The contact when the tool is `offset` away from the anchor: the displacement of the nodes, and
  /// what is felt there.
  [[nodiscard]] Contact touch(const Vec3& offset, double coupling) noexcept;
  [[nodiscard]] TouchResult balance(const Vec3& offset, double coupling, Vec3& t) const noexcept;
  [[nodiscard]] bool lets_go(const Contact& contact, const TouchSettings& settings) const noexcept;

  const Touchable* body_ = nullptr;
  /// The tool was outside since it last let go.
  bool armed_ = false;
  bool attached_ = false;
  std::array<Held, 3> held_;
  int num_held_ = 0;
  Vec3 anchor_ = Vec3::Zero();
  Vec3 normal_ = Vec3::Zero();
  Vec3 displacement_ = Vec3::Zero();
  /// With a coupling: the tool's displacement, and ∂(nodes' displacement)/∂(tool's).
  Vec3 offset_ = Vec3::Zero();
  Mat3 followed_ = Mat3::Zero();
  Index last_triangle_ = -1;
};

}  // namespace palpate
