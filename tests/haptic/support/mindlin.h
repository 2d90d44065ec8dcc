// SPDX-License-Identifier: BSD-3-Clause
// Friction of the servo loop (haptic/touching/friction.h) beside Cattaneo's and Mindlin's sphere on
// an elastic half-space (Johnson, Contact Mechanics, 1985, §7.2), which is moved aside by δ while
// its depth stays:
//
//   Q(δ) = μ P (1 − (1 − δ/δ_s)^{3/2}) up to δ_s = 3 μ P / (2 k_t), then μ P,
//   k_t = 8 G a/(2 − ν).
//
// Here P, k_t and a are those of the closed form, while Friction is told P and k_n as finite
// elements of a contact without friction have them (hertz.h). Both are told μ.
#pragma once

#include "solvers/support/hertz.h"

namespace palpate::test {

struct FrictionResult {
  /// The largest |Q − Q(δ)| on the way from 0 to 1.5 δ_s, over μ P.
  double error = 0;
  /// ∂Q/∂δ at δ = 0 over k_t.
  double stiffness = 0;
  /// Q at the end, where all of the contact slips, over μ P.
  double slipping = 0;
};

/// @param contact As finite elements have it.
[[nodiscard]] FrictionResult move_aside(const HertzResult& contact, double poissons_ratio,
                                        double coefficient);

}  // namespace palpate::test
