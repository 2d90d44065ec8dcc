// SPDX-License-Identifier: BSD-3-Clause
// Coulomb friction of a rigid tool that presses a soft body, which yields sideways before the tool
// slips.
//
// A tool that is pressed with the force P and then moved aside by e shears the body, and slips
// first at the rim of the contact. For a sphere on an elastic half-space, Cattaneo and Mindlin
// found the force [J, ch. 7.2]
//
//   Q = μ P (1 − (1 − |e|/e_s)^{3/2}),   e_s = 3 μ P / (2 k_t),
//
// along e. At e_s the whole contact slips, and e grows no more. k_t, the stiffness with which Q
// begins, is that of a contact that does not slip at all. For a half-space and a rigid tool k_t /
// k_n = 2 (1 − ν)/(2 − ν) with the stiffness k_n against further pressing (Mindlin), which is 0.82
// to 0.67 for ν = 0.3 to 0.5. Soft tissues have ν ≥ 0.4.
//
// This model makes no energy. Only the motion of the hand lets e grow; every other change of e or
// of the law lowers the stored energy. As the surface turns, the part of e along the push is
// dropped. Slipping shortens e. As P changes, Q may fall but does not rise by itself: where it
// would, e shrinks so that Q stays. k_t follows k_n only where that has changed by more than kPlay,
// so that the tremor of a hand does not undo the shear bit by bit.
//
// [J] Johnson, Contact Mechanics, Cambridge University Press 1985.
#pragma once

#include "base/types.h"

namespace palpate {

class Friction {
 public:
  /// k_t / k_n, at ν = 0.45.
  static constexpr double kShearRatio = 0.71;
  /// The relative difference between k_n and the value that k_t was last taken from, up to which
  /// k_t stays as it is.
  static constexpr double kPlay = 0.05;

  /// Forgets the shear. Call this when the tool is free or glides without friction.
  /// @note Realtime-safe.
  void release() noexcept { *this = Friction(); }

  /// Moves the hand on.
  /// @param moved The motion of the hand [3], m; the first call ignores it.
  /// @param coefficient μ, positive. @param push The force h that presses the tool into the body
  ///   [3], N, not zero. @param stiffness k_n, N/m. Where it is not positive, as when a tool slides
  ///   off a ridge, k_t stays as it was. @param coupling The stiffness of the virtual coupling, in
  ///   series with k_t, N/m; 0: none.
  /// @note Realtime-safe.
  void move(const Vec3& moved, double coefficient, const Vec3& push, double stiffness,
            double coupling) noexcept;

  /// e [3], m: how far the hand has moved along the surface since the tool sticks.
  [[nodiscard]] const Vec3& stretch() const noexcept { return stretch_; }
  /// The force Q that holds the tool against the shear [3], N.
  [[nodiscard]] Vec3 force() const noexcept;
  /// ∂Q/∂|e|, N/m; 0 where the tool slips.
  [[nodiscard]] double stiffness() const noexcept;
  /// Energy that the shear stores, J.
  [[nodiscard]] double energy() const noexcept;

 private:
  /// Q at |e| m, N.
  [[nodiscard]] double traction(double stretch) const noexcept;
  /// |e| at which Q has a value, m.
  [[nodiscard]] double stretch_of(double traction) const noexcept;
  /// e_s, m; 0 before there was a contact.
  [[nodiscard]] double longest() const noexcept { return shear_ > 0 ? 1.5 * most_ / shear_ : 0; }

  Vec3 stretch_ = Vec3::Zero();
  /// μ P, N, and k_t, N/m.
  double most_ = 0;
  double shear_ = 0;
  /// The k_n that k_t was last taken from, N/m.
  double pressed_ = 0;
};

}  // namespace palpate
