// SPDX-License-Identifier: BSD-3-Clause
// The bond between the tool and the active nodes that it holds.
//
// Attached at the point a of the surface at rest, the tool at p moves the active nodes there by one
// displacement t, and feels
//
//   f = −h(t),   h = Σ w_n h_n(t) = ∇Π,   Π = Σ w_n Π_n(t),   t = p − a
//
// with the weights w of a in its triangle, or with weight 1 for the nearest active node alone. The
// weights stay as they are while the tool is attached: if they followed the tool, the force would
// do work around a closed path. The force is zero where the tool comes in, at t = 0.
//
// A body with a cut whose stages are known has Π(t, A) in place of Π(t) (torn_energy.h), with the
// area A that is torn. What is torn stays so when the tool lets go. A tear of the whole cut takes a
// twentieth of a second at the least, so that a hand feels a snap in several ticks.
//
// With a coupling the tool holds the nodes by a spring, and t is where the spring is in balance
// with h (balance.h).
#pragma once

#include <array>

#include "haptic/touching/contact.h"
#include "haptic/touching/tear_account.h"
#include "haptic/touching/touchable.h"

namespace palpate {

/// @note All functions are realtime-safe.
class Hold {
 public:
  /// Goes on with another body; nullptr: with none.
  void take_over(const Touchable* body, bool is_same_scene) noexcept;

  /// Goes on with the same organ, which was changed in the hand: where it has an active node at the
  /// place of each that was held, the tool goes on holding it, at the same displacement.
  void take_over_changed(const Touchable& body, const Hold& before) noexcept;

  /// Takes hold where the tool comes in.
  /// @param reach The largest distance of the nearest active node, m.
  /// @param blended The tool holds the three nodes of the triangle, where all of them are active.
  /// @returns false: no active node is near.
  [[nodiscard]] bool take(const SurfaceTree::Nearest& at, double reach, bool blended) noexcept;
  /// Call this after take() where the tool was already pressing. It finds the displacement at which
  /// the nodes hold the tool with the same force, so that the force does not jump. Where there is
  /// none, the force begins at zero.
  /// @param place The tool's place, m. @param holding The force that held the tool there [3], N.
  /// @param coupling As for move().
  void go_on_from(const Vec3& place, const Vec3& holding, double coupling) noexcept;
  /// What is torn stays torn.
  void let_go() noexcept { num_held_ = 0; }
  [[nodiscard]] bool holds() const noexcept { return num_held_ > 0; }

  /// The contact when the tool is at a place, m.
  /// @param coupling Stiffness of the virtual coupling, N/m; 0: there is none.
  /// @param toughness Of a cut that tears, J/m²; 0: it stays as it is.
  [[nodiscard]] Contact move(const Vec3& place, double coupling, double toughness) noexcept;

  /// The contact while what is held, if anything is, stays where it is. Its force is zero: nothing
  /// is felt of it. `toughness` is as of move().
  [[nodiscard]] Contact stay(double toughness) noexcept;
  /// Energy of the body as it is held, J, and G, J/m², where an area of the cut is open.
  [[nodiscard]] TornResult energy_at(double area) const noexcept;

  /// What is torn. It stays when the tool lets go.
  [[nodiscard]] const TearAccount& account() const noexcept { return account_; }
  [[nodiscard]] TearAccount& account() noexcept { return account_; }

  /// @param pulls_too Whether the tool also pulls. Such a tool lets go only above `release_force`,
  ///   N; 0: never. Another tool lets go where it would pull, and slips where it has gone aside
  ///   beyond the tool space.
  [[nodiscard]] bool slips(const Contact& contact, bool pulls_too,
                           double release_force) const noexcept;

 private:
  struct Held {
    Index mesh_point = -1;
    BodyId body = kFirstBody;
    std::int32_t node = -1;
    double weight = 0;
    /// The branch that the body is on.
    int branch = 0;
  };

  /// An active node, on its first branch.
  [[nodiscard]] Held held_node(std::int32_t number, double weight) const noexcept;
  /// Energy, force that holds, and stiffness at a displacement, with each node on its branch.
  [[nodiscard]] TouchResult evaluate(const Vec3& t) const noexcept;
  /// The same at a stage of the cut.
  [[nodiscard]] TouchResult at_stage(int stage, const Vec3& t) const noexcept;
  /// Tears the cut at a displacement. @returns Whether it opens.
  [[nodiscard]] bool tear(double toughness, const Vec3& t) noexcept;
  /// Tells what is held, and where.
  void tell(const TouchResult& at, Contact& contact) const noexcept;
  /// Finds the branch that each node is on when the nodes move from displacement_ to t.
  void follow(const Vec3& t) noexcept;

  const Touchable* body_ = nullptr;
  std::array<Held, 3> held_;
  int num_held_ = 0;
  Vec3 anchor_ = Vec3::Zero();
  Vec3 normal_ = Vec3::Zero();
  Vec3 displacement_ = Vec3::Zero();
  TearAccount account_;
  /// With a coupling: the displacement of the tool, m, and the derivative of displacement_ with
  /// respect to it.
  Vec3 offset_ = Vec3::Zero();
  Mat3 followed_ = Mat3::Zero();
};

}  // namespace palpate
