// SPDX-License-Identifier: BSD-3-Clause
// What the tool is bonded to.
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
// With a coupling the tool holds the nodes by a spring: t is where that is in balance with h, see
// balance.h.
#pragma once

#include <array>

#include "haptic/touching/contact.h"
#include "haptic/touching/touchable.h"

namespace palpate {

/// @note All functions are realtime-safe.
class Hold {
 public:
  /// Goes on with another body, or without.
  void take_over(const Touchable* body, bool is_same_scene) noexcept;

  /// Takes hold where the tool comes in.
  /// @param reach Of the nearest active node, m. @param blended The three nodes of the triangle,
  ///   where all are active.
  /// @returns false: no active node is near.
  [[nodiscard]] bool take(const SurfaceTree::Nearest& at, double reach, bool blended) noexcept;
  /// The tool has already pressed when it took hold: with the displacement at which the nodes
  /// answer as the body did, the force does not jump. Where there is none, it begins at zero.
  /// @param place Of the tool, m. @param holding The force that held it there [3], N.
  /// @param coupling As for move().
  void go_on_from(const Vec3& place, const Vec3& holding, double coupling) noexcept;
  void let_go() noexcept { num_held_ = 0; }
  [[nodiscard]] bool holds() const noexcept { return num_held_ > 0; }

  /// The contact when the tool is at a place, m.
  /// @param coupling Stiffness of the virtual coupling, N/m; 0: there is none.
  [[nodiscard]] Contact move(const Vec3& place, double coupling) noexcept;

  /// @param pulls_too The tool also pulls, and lets go only above a force, N; 0: never. Another
  ///   one lets go where it would pull, and slips where it has gone aside beyond what the space
  ///   holds.
  [[nodiscard]] bool slips(const Contact& contact, bool pulls_too,
                           double release_force) const noexcept;

 private:
  struct Held {
    Index mesh_point = -1;
    std::int32_t node = -1;
    double weight = 0;
    /// The branch that the body is on.
    int branch = 0;
  };

  /// Energy, force that holds, and stiffness at a displacement, with each node on its branch.
  [[nodiscard]] TouchResult evaluate(const Vec3& t) const noexcept;
  /// The branch that each node is on where it is moved to.
  void follow(const Vec3& t) noexcept;

  const Touchable* body_ = nullptr;
  std::array<Held, 3> held_;
  int num_held_ = 0;
  Vec3 anchor_ = Vec3::Zero();
  Vec3 normal_ = Vec3::Zero();
  Vec3 displacement_ = Vec3::Zero();
  /// With a coupling: the tool's displacement, and ∂(nodes' displacement)/∂(tool's).
  Vec3 offset_ = Vec3::Zero();
  Mat3 followed_ = Mat3::Zero();
};

}  // namespace palpate
