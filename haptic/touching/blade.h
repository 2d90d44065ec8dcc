// SPDX-License-Identifier: BSD-3-Clause
// A blade that a hand draws through a cut whose stages the space has (cut_sheet.h).
//
// The hand at x has the point q(x) of the sheet nearest to it, and the blade is at b, where the cut
// is open. The tissue before the edge is a spring between both, so that the hand feels
//
//   f = −∂E/∂x,   E = ½ k |q(x) − b|².
//
// Beyond the last front the body is whole: there q(x) goes on ahead with the hand.
//
// The blade follows the hand as far as the friction F_f lets it, and opens the cut as far as that
// lowers
//
//   E + Π(t, A) + G_c A + F_f |Δb|
//
// with the energy Π of the body (torn_energy.h). While the edge goes on steadily by ds, this is the
// force (G_c − G) dA/ds + F_f along its way: G = −∂Π/∂A of a body that is pulled open helps it. A
// step that would not lower the sum is not made, so that the blade makes no energy. k is given,
// since the space does not have the deformation of the tissue before the edge. The edge is as long
// as the front, since the stages are open along all of it. Across the sheet nothing is felt. Where
// the sheet is bent, q(x) may jump as x passes by on the hollow side. The force does not: what q(x)
// moves by more than ∂q/∂x says is taken off from then on.
#pragma once

#include "haptic/touching/contact.h"
#include "haptic/touching/cut_sheet.h"
#include "haptic/touching/hold.h"
#include "haptic/touching/settings.h"

namespace palpate {

/// @note All functions are realtime-safe.
class Blade {
 public:
  /// Goes into the cut where it is open, or where it begins.
  /// @param body It has a cut. @param hold What holds the body, and what is torn.
  /// @param reach The largest distance of the hand from the sheet, m.
  /// @returns false: no such part of the sheet is near.
  [[nodiscard]] bool enter(const Touchable& body, const Vec3& hand, double reach,
                           Hold& hold) noexcept;
  void leave() noexcept { is_in_ = false; }
  [[nodiscard]] bool is_in() const noexcept { return is_in_; }

  /// Moves the hand. The blade leaves where the hand has gone farther from the sheet than its
  /// reach.
  [[nodiscard]] Contact move(const Touchable& body, const Vec3& hand, const TouchSettings& settings,
                             Hold& hold) noexcept;

 private:
  /// What decides how far the blade goes.
  struct Resistance {
    double stiffness = 0;
    double friction = 0;
    double toughness = 0;
  };
  /// q(x), with ∂q/∂x as CutSheet::Nearest::follows.
  [[nodiscard]] static CutSheet::Nearest follow(const Touchable& body, const Vec3& hand) noexcept;
  /// The hand comes to a place. @returns false: it is too far from the sheet.
  [[nodiscard]] bool pull(const Touchable& body, const Vec3& hand) noexcept;
  /// Slides through what is open.
  void slide(const CutSheet& sheet, const Resistance& against, TearAccount& account) noexcept;
  /// Opens the cut. @param most By so much at the most, m².
  void cut(const CutSheet& sheet, const Resistance& against, double most, Hold& hold) noexcept;
  /// From the blade to where the hand pulls it.
  [[nodiscard]] Vec3 stretch() const noexcept { return on_sheet_.point - offset_ - place_; }
  [[nodiscard]] Vec3 force(double stiffness) const noexcept;
  /// Where the blade would go if nothing but friction held it.
  [[nodiscard]] Vec3 goal(const Resistance& against) const noexcept;

  bool is_in_ = false;
  double reach_ = 0;
  /// b, m.
  Vec3 place_ = Vec3::Zero();
  /// q(x) less where the hand pulls the blade to, so that the force begins at zero and goes on
  /// where q(x) jumps, m.
  Vec3 offset_ = Vec3::Zero();
  /// x and q(x).
  Vec3 hand_ = Vec3::Zero();
  CutSheet::Nearest on_sheet_;
};

}  // namespace palpate
