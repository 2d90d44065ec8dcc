// SPDX-License-Identifier: BSD-3-Clause
// Coulomb friction of a rigid tool that presses a soft body, with the way that it yields before it
// slips.
//
// A tool that is pressed with the force P and then moved aside by e without slipping as a whole
// shears the body, and slips first at the rim of the contact. Of a sphere on an elastic half-space
// Cattaneo and Mindlin found [J, ch. 7.2]
//
//   Q = μ P (1 − (1 − |e|/e_s)^{3/2}),   e_s = 3 μ P / (2 k_t),
//
// along e; at e_s all of it slips, and e grows no more. k_t, the stiffness with which Q begins, is
// that of a contact that does not slip at all: of a half-space and a rigid tool
// k_t / k_n = 2 (1 − ν)/(2 − ν) with the stiffness k_n against further pressing (Mindlin), 0.82 to
// 0.67 for ν = 0.3 to 0.5. Soft tissues have ν ≥ 0.4.
//
// It makes no energy. e grows by the way of the hand alone; what else changes it, or the law,
// lets what is stored fall: the part along the push is left out as the surface turns, slipping
// shortens e, and as P changes Q may fall, but does not rise by itself: where it would, e shrinks
// so that Q stays. k_t follows k_n only where that has changed by more than a share, so that the
// tremor of a hand does not undo the shear bit by bit.
//
// [J] Johnson, Contact Mechanics, Cambridge University Press 1985.
#pragma once

#include "base/types.h"

namespace palpate {

class Friction {
 public:
  /// k_t / k_n, at ν = 0.45.
  static constexpr double kShearRatio = 0.71;
  /// The share by which k_n may differ from what k_t was last taken from.
  static constexpr double kPlay = 0.05;

  /// The tool is free, or glides without friction.
  /// @note Realtime-safe.
  void release() noexcept { *this = Friction(); }

  /// The hand has moved, and the body answers.
  /// @param moved m; the first time it is of no account.
  /// @param coefficient μ, positive. @param push The force that holds the tool against the body's
  ///   [3], N, not zero. @param stiffness k_n, N/m; where it is not positive, as where a tool
  ///   slides off a ridge, k_t stays as it was. @param coupling The stiffness of the virtual
  ///   coupling, in series with k_t, N/m; 0: none.
  /// @note Realtime-safe.
  void move(const Vec3& moved, double coefficient, const Vec3& push, double stiffness,
            double coupling) noexcept;

  /// e [3], m: how far the hand has moved along the surface since the tool sticks.
  [[nodiscard]] const Vec3& stretch() const noexcept { return stretch_; }
  /// The force that holds the tool against it [3], N.
  [[nodiscard]] Vec3 force() const noexcept;
  /// ∂Q/∂e, N/m; 0 where the tool slips.
  [[nodiscard]] double stiffness() const noexcept;
  /// What the shear stores, J.
  [[nodiscard]] double energy() const noexcept;

 private:
  /// Q at |e| m, N.
  [[nodiscard]] double traction(double stretch) const noexcept;
  /// |e| at which Q is so large, m.
  [[nodiscard]] double stretch_of(double traction) const noexcept;
  /// e_s, m; 0 before there was a contact.
  [[nodiscard]] double longest() const noexcept { return shear_ > 0 ? 1.5 * most_ / shear_ : 0; }

  Vec3 stretch_ = Vec3::Zero();
  /// μ P, N, and k_t, N/m.
  double most_ = 0;
  double shear_ = 0;
  /// k_n that k_t was taken from, N/m.
  double pressed_ = 0;
};

}  // namespace palpate
